// Each step of loading is taken by all ranks before the next, and what fails on one of them is told by all.
#include "app/load_plugins.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <filesystem>
#include <optional>
#include <sstream>

#include "input/named_plugins.hpp"
#include "lowering/lower_deck.hpp"
#include "parallel/communicator.hpp"
#include "plugin/loader.hpp"

namespace kerf {
namespace {

/// What a rank says about a file; empty where nothing is wrong.
template <class Work>
std::string attempt(const Work& work) {
  try {
    work();
  } catch (const std::exception& e) {
    return *e.what() != '\0' ? e.what() : "has failed without a word";
  }
  return {};
}

/// A file that is named twice, or by two ways, is loaded once.
class Loaded {
 public:
  bool add(const std::string& path) {
    std::error_code ignored;
    const std::string file = std::filesystem::weakly_canonical(path, ignored).string();
    if (std::find(files_.begin(), files_.end(), file) != files_.end()) return false;
    files_.push_back(file);
    return true;
  }

 private:
  std::vector<std::string> files_;
};

std::string line_of(const WantedPlugin& plugin, const std::string& path, const std::string& failure) {
  if (plugin.origin.empty()) return fmt::format("{}: error: {}", path, failure);
  return fmt::format("{}: error: `plugins`: {}: {}", plugin.origin, path, failure);
}

/// What has failed on the lowest rank where something has; the rank is named unless all say the same. Collective.
std::string agreed(MPI_Comm comm, const std::string& failure) {
  const std::string first = first_text(comm, failure);
  if (first.empty()) return {};
  const int size = size_of(comm), rank = rank_of(comm);
  const auto lowest = -greatest(comm, -std::int64_t{failure.empty() ? size : rank});
  return sum_of(comm, std::int64_t{failure == first}) == size ? first : fmt::format("on rank {}: {}", lowest, first);
}

void note(const std::string& path, const LibraryFile& file, Registry& registry) {
  registry.note_file(std::filesystem::path(path).filename().string(), file.checksum());
}

std::string described(const LibraryFile& file, int rank) {
  return fmt::format("{} bytes with the checksum {:016x} on rank {}", file.size(), file.checksum(), rank);
}

/// Whether all ranks have read the same bytes as rank 0. Collective.
std::string difference_between_ranks(MPI_Comm comm, const LibraryFile& file) {
  const std::string of_root = broadcast(comm, described(file, 0));
  const bool same = described(file, 0) == of_root;
  return first_text(comm, same
                              ? ""
                              : fmt::format("is not the same file on all ranks: {}, {}; let all ranks see the same one",
                                            of_root, described(file, rank_of(comm))));
}

/// What is wrong with a plugin, the same on all ranks. Collective.
std::string load(MPI_Comm comm, const std::string& path, Registry& registry) {
  std::optional<LibraryFile> file;
  std::string failure = agreed(comm, attempt([&] { file = read_plugin(path); }));
  if (failure.empty()) failure = difference_between_ranks(comm, *file);
  if (failure.empty()) failure = agreed(comm, attempt([&] { require_fitting(path, *file); }));
  if (failure.empty()) failure = agreed(comm, attempt([&] { open_plugin(path, *file, registry); }));
  if (failure.empty()) note(path, *file, registry);
  return failure;
}

}  // namespace

std::vector<WantedPlugin> wanted_plugins(const RunOptions& options, const std::string& input_bytes) {
  std::vector<WantedPlugin> wanted;
  for (const std::string& name : options.plugins) wanted.push_back({name, name, ""});
  if (lowering::is_deck(options.input, input_bytes)) return wanted;
  for (const NamedPlugin& plugin : named_plugins(options.input, input_bytes, options.overrides))
    wanted.push_back({plugin.name, plugin.path, plugin.origin.text()});
  return wanted;
}

void load_plugins(const std::vector<WantedPlugin>& wanted, Registry& registry) {
  std::vector<std::string> errors;
  Loaded loaded;
  for (const WantedPlugin& plugin : wanted) {
    PluginPlace place = find_plugin(plugin.name, plugin.path, plugin_folders());
    if (place.failure.empty() && !loaded.add(place.path)) continue;
    if (place.failure.empty())
      place.failure = attempt([&] {
        LibraryFile file = read_plugin(place.path);
        require_fitting(place.path, file);
        open_plugin(place.path, file, registry);
        note(place.path, file, registry);
      });
    if (!place.failure.empty()) errors.push_back(line_of(plugin, place.path, place.failure));
  }
  if (!errors.empty()) throw InputError(errors);
}

void load_plugins(MPI_Comm comm, const std::vector<WantedPlugin>& wanted, Registry& registry) {
  std::vector<std::string> errors;
  Loaded loaded;  // of rank 0: other machines may have other links between files
  for (const WantedPlugin& plugin : wanted) {
    PluginPlace place;
    bool is_new = true;
    if (rank_of(comm) == 0) {
      place = find_plugin(plugin.name, plugin.path, plugin_folders());
      is_new = !place.failure.empty() || loaded.add(place.path);
    }
    place.path = broadcast(comm, place.path);
    place.failure = broadcast(comm, place.failure);
    if (broadcast(comm, is_new ? "new" : "old") == "old") continue;
    if (place.failure.empty()) place.failure = load(comm, place.path, registry);
    if (!place.failure.empty()) errors.push_back(line_of(plugin, place.path, place.failure));
  }
  if (!errors.empty()) throw InputError(errors);
}

}  // namespace kerf
