// From a file name to a checked input on every rank.
#include "app/load_input.hpp"

#include <fmt/format.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <optional>
#include <sstream>

#include "app/load_plugins.hpp"
#include "core/activity.hpp"
#include "core/diagnostics.hpp"
#include "input/library.hpp"
#include "input/read_model.hpp"
#include "kerf/measure.hpp"
#include "lowering/lowered_bytes.hpp"
#include "parallel/communicator.hpp"

namespace kerf {

namespace {

std::string read_file(const std::string& path, std::string& failure) {
  if (std::filesystem::is_directory(path)) {
    failure = fmt::format("{}: error: this is a folder; name the input file in it", path);
    return {};
  }
  std::ifstream stream(path, std::ios::binary);
  if (!stream) {
    failure = fmt::format("{}: error: the input file cannot be read: {}", path, std::strerror(errno));
    return {};
  }
  std::ostringstream text;
  text << stream.rdbuf();
  return text.str();
}

double memory_of_machine() {
  return static_cast<double>(sysconf(_SC_PHYS_PAGES)) * static_cast<double>(sysconf(_SC_PAGESIZE));
}

double count_elements(const ModelInput& input) {
  double n = 0.0;  // a real number: it may be beyond 64 bits
  for (const auto& part : input.parts) n += static_cast<double>(part->mesh->n_elements());
  return n;
}

void check_enough_elements(const ModelInput& input, const std::string& name, int ranks) {
  const double n = count_elements(input);
  if (n < ranks)
    throw InputError({fmt::format("{}: error: {} ranks are more than the {} element{} of the model; use fewer ranks",
                                  name, ranks, n, n == 1.0 ? "" : "s")});
}

/// Throws where there are more elements than can be held: a cell size without its unit would otherwise fill the memory
/// of the machine. Collective.
void check_memory(MPI_Comm comm, const ModelInput& input, const std::string& name) {
  // An element with its nodes takes about 600 bytes at least, and local numbers have 31 bits.
  constexpr double bytes_per_element = 600.0, most_per_rank = 2.0e8;
  MPI_Comm machine = MPI_COMM_NULL;
  MPI_Comm_split_type(comm, MPI_COMM_TYPE_SHARED, 0, MPI_INFO_NULL, &machine);
  const double n = count_elements(input), share = n / size_of(comm);
  const double needed = share * size_of(machine) * bytes_per_element;
  MPI_Comm_free(&machine);
  const bool too_large = greatest(comm, needed > memory_of_machine() ? 1.0 : 0.0) > 0.0;
  if (share <= most_per_rank && !too_large) return;
  const auto larger = [](const auto& a, const auto& b) { return a->mesh->n_elements() < b->mesh->n_elements(); };
  const auto& largest = *std::max_element(input.parts.begin(), input.parts.end(), larger);
  throw InputError({fmt::format(
      "{}: error: the model has {:.3g} elements, most of them in part {}; they need about "
      "{:.3g} GB in all, which {} rank{} on this machine cannot hold; use larger cells (is a "
      "unit missing?) or more machines",
      name, n, largest->name, n * bytes_per_element * 1e-9, size_of(comm), size_of(comm) == 1 ? "" : "s")});
}

std::vector<std::string> lines_of(const std::string& text) {
  std::istringstream list(text);
  std::vector<std::string> lines;
  for (std::string line; std::getline(list, line);) lines.push_back(line);
  return lines;
}

/// The input as rank 0 has read it: text of YAML, or a deck that has become a document.
struct Source {
  std::string bytes;
  std::optional<lowering::LoweredDeck> deck;
  std::vector<std::string> warnings;  // about the deck
};

std::unique_ptr<ModelInput> parse(Source source, const RunOptions& options, const Registry& registry,
                                  const FileReader& read, const std::vector<std::string>& library) {
  const activity::Task task("reading the input", {activity::default_limit, "a fixed limit", exit_input_error});
  Diagnostics diagnostics;
  OriginMap origins;
  std::unique_ptr<ModelInput> input;
  if (source.deck) {
    MeshCache meshes;
    const std::string folder = std::filesystem::path(options.input).parent_path().string();
    meshes.add(path_from("", folder, source.deck->mesh_name), source.deck->mesh);
    input = read_model_document(options.input, std::move(source.deck->document), std::move(meshes), options.overrides,
                                registry, diagnostics, origins, read, library);
    input->source_report = lowering::report_text(source.deck->report);
    input->deck = lowering::note_of(source.deck->report);
  } else {
    input =
        read_model_input(options.input, source.bytes, options.overrides, registry, diagnostics, origins, read, library);
  }
  validate(*input, origins, diagnostics);
  diagnostics.throw_if_errors();
  input->warnings = source.warnings;
  input->warnings.insert(input->warnings.end(), diagnostics.warnings().begin(), diagnostics.warnings().end());
  return input;
}

/// What the file is. Throws InputError with all mistakes of a deck. Local.
Source source_of(const std::string& bytes, const RunOptions& options) {
  if (!lowering::is_deck(options.input, bytes)) {
    if (options.has_deck_options())
      throw InputError({options.input + ": error: --units, --case, --without-unsupported and --strict are for keyword "
                                        "decks; expected a deck, or none of these options"});
    return {bytes, {}, {}};
  }
  const activity::Task task("reading the deck", {activity::default_limit, "a fixed limit", exit_input_error});
  Diagnostics diagnostics;
  lowering::LoweredDeck deck = lowering::lower_deck(
      options.input, {options.units, options.case_number, options.without_unsupported, options.strict}, diagnostics);
  if (diagnostics.has_errors()) {  // what was left out may be the reason
    std::vector<std::string> lines = diagnostics.warnings();
    lines.insert(lines.end(), diagnostics.errors().begin(), diagnostics.errors().end());
    throw InputError(lines);
  }
  return {{}, std::move(deck), diagnostics.warnings()};
}

/// What rank 0 has made of the file, on all ranks. Throws InputError on all of them. Collective.
Source source_of_root(MPI_Comm comm, const std::string& bytes, const RunOptions& options) {
  Source source;
  std::string errors, lowered;
  if (rank_of(comm) == 0) {
    try {
      source = source_of(bytes, options);
      if (source.deck) lowered = lowering::packed(*source.deck);
    } catch (const InputError& e) {
      for (const std::string& line : e.lines()) errors += line + "\n";
    }
  }
  errors = broadcast(comm, errors);
  if (!errors.empty()) throw InputError(lines_of(errors));
  lowered = broadcast(comm, lowered);
  if (rank_of(comm) == 0) return source;
  if (lowered.empty()) return {bytes, {}, {}};
  return {{}, lowering::unpacked(lowered), {}};
}

/// The library folders as rank 0 knows them: other machines may have another environment. Collective.
std::vector<std::string> library_of_root(MPI_Comm comm) {
  std::string lines;
  for (const std::string& folder : library_folders()) lines += folder + "\n";
  return lines_of(broadcast(comm, lines));
}

}  // namespace

std::string read_input_file(const std::string& path) {
  std::string failure, bytes = read_file(path, failure);
  if (!failure.empty()) throw InputError({failure});
  return bytes;
}

std::string read_with_plugins(const RunOptions& options, Registry& registry) {
  const std::string bytes = read_input_file(options.input);
  load_plugins(wanted_plugins(options, bytes), registry);
  return bytes;
}

void check_before_launch(const RunOptions& options, Registry& registry) {
  const std::string bytes = read_with_plugins(options, registry);
  check_enough_elements(*parse(source_of(bytes, options), options, registry, read_text_file, library_folders()),
                        options.input, options.ranks);
  // A rank takes about 20 MB before it holds anything. Under a batch system they may go to several machines.
  constexpr double bytes_per_rank = 2.0e7;
  for (const char* name : {"SLURM_JOB_ID", "PBS_JOBID", "LSB_JOBID", "OMPI_MCA_orte_default_hostfile"})
    if (std::getenv(name)) return;
  if (options.ranks * bytes_per_rank > memory_of_machine())
    throw InputError(
        {fmt::format("--ranks {}: error: so many ranks take about {:.0f} GB by themselves, and this machine has "
                     "{:.0f} GB; use fewer ranks",
                     options.ranks, options.ranks * bytes_per_rank * 1e-9, memory_of_machine() * 1e-9)});
}

std::unique_ptr<ModelInput> load_input(MPI_Comm comm, const RunOptions& options, Registry& registry) {
  std::string failure, bytes;
  if (rank_of(comm) == 0) bytes = read_file(options.input, failure);
  failure = broadcast(comm, failure);
  if (!failure.empty()) throw InputError({failure});
  // Rank 0 alone reads a deck: the others get what it becomes.
  const bool is_deck = rank_of(comm) == 0 && lowering::is_deck(options.input, bytes);
  const std::string text = broadcast(comm, is_deck ? std::string() : bytes);
  load_plugins(comm, wanted_plugins(options, text), registry);
  const auto read_on_root = [comm](const std::string& path, std::string& trouble) {
    std::string text;
    if (rank_of(comm) == 0) text = read_text_file(path, trouble);
    trouble = broadcast(comm, trouble);
    return broadcast(comm, text);
  };
  auto input = parse(source_of_root(comm, is_deck ? std::move(bytes) : text, options), options, registry, read_on_root,
                     library_of_root(comm));
  check_enough_elements(*input, options.input, size_of(comm));
  check_memory(comm, *input, options.input);
  return input;
}

}  // namespace kerf
