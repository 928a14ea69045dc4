// Reads the options of `kerf partition`: numbers of parts, frames and methods.
#include "app/partition_options.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <charconv>
#include <set>

#include "core/diagnostics.hpp"
#include "input/binder.hpp"
#include "input/yaml_reader.hpp"
#include "partition/frame.hpp"

namespace kerf {

namespace {

std::vector<std::string> pieces_of(const std::string& text) {
  std::vector<std::string> pieces;
  for (std::size_t at = 0; at <= text.size();) {
    const std::size_t end = std::min(text.find(',', at), text.size());
    pieces.push_back(text.substr(at, end - at));
    at = end + 1;
  }
  return pieces;
}

bool is_number(const std::string& text, std::int64_t& value) {
  const auto [end, status] = std::from_chars(text.data(), text.data() + text.size(), value);
  return status == std::errc() && end == text.data() + text.size();
}

/// NAME={type: ...}, or names with commas between, or all.
void add_methods(const std::string& text, const Registry& registry, std::vector<PartitionMethod>& methods) {
  if (const std::size_t brace = text.find("={"); brace != std::string::npos) {
    methods.push_back({text.substr(0, brace), "", text.substr(brace + 1)});
    return;
  }
  for (const std::string& name : pieces_of(text)) {
    if (name == "all") {
      for (const std::string& type : registry.names("partitioner"))
        // They need to be told more: where elements are, and what a file says.
        if (type != "none" && type != "file") methods.push_back({type, type, "{type: " + type + "}"});
    } else {
      methods.push_back({name, name, "{type: " + name + "}"});
    }
  }
}

/// What an input would say under `balance`.
struct MethodInput {
  std::unique_ptr<Partitioner> partitioner;
  static void describe(Schema<MethodInput>& s) {
    s.plugin(&MethodInput::partitioner, "partitioner", "partitioner", "how elements are distributed");
  }
};

}  // namespace

std::vector<int> parts_asked(const std::string& text, std::int64_t n_elements) {
  std::set<int> numbers;
  for (const std::string& piece : pieces_of(text)) {
    std::int64_t n = 0;
    if (!is_number(piece, n) || n < 1 || n > n_elements)
      throw InputError(
          {fmt::format("--parts {}: error: \"{}\" is no number of parts; expected whole numbers from 1 to "
                       "{}, the elements of the model, with commas between",
                       text, piece, n_elements)});
    numbers.insert(static_cast<int>(n));
  }
  return {numbers.begin(), numbers.end()};
}

std::vector<std::int64_t> frames_asked(const PartitionOptions& options) {
  if (options.results.empty()) {
    if (options.frames.empty()) return {};
    throw InputError(
        {fmt::format("--frame {}: error: frames of which results? name their folder with --results", options.frames)});
  }
  const std::int64_t n = frames_of(options.results);
  std::set<std::int64_t> frames;
  for (const std::string& piece : pieces_of(options.frames.empty() ? "last" : options.frames)) {
    std::int64_t frame = n - 1;
    if (piece != "last" && (!is_number(piece, frame) || frame < 0 || frame >= n))
      throw InputError(
          {fmt::format("--frame {}: error: \"{}\" is no frame; expected whole numbers from 0 to {}, or "
                       "last, with commas between",
                       options.frames, piece, n - 1)});
    frames.insert(frame);
  }
  return {frames.begin(), frames.end()};
}

std::unique_ptr<Partitioner> make_partitioner(const PartitionMethod& method, const Registry& registry) {
  Diagnostics diagnostics;
  OriginMap origins;
  MethodInput made;
  const std::string place = "--method " + method.name;
  const auto tree = read_yaml(place, "partitioner: " + method.block, diagnostics);
  if (tree)
    Binder(registry, diagnostics, origins)
        .bind_block(Schema<MethodInput>::described<MethodInput>(), *tree, &made, "",
                    {std::make_shared<const std::string>(place), 0, 0});
  diagnostics.throw_if_errors();
  return std::move(made.partitioner);
}

std::vector<PartitionMethod> methods_asked(const PartitionOptions& options, const Registry& registry) {
  std::vector<PartitionMethod> methods;
  if (options.methods.empty()) add_methods("all", registry, methods);
  for (const std::string& text : options.methods) add_methods(text, registry, methods);
  std::set<std::string> names;
  std::vector<std::string> errors;
  for (PartitionMethod& m : methods) {
    const bool plain = !m.name.empty() && m.name.find_first_not_of(
                                              "abcdefghijklmnopqrstuvwxyzABCDEFGHIJKLMNOPQRSTUVWXYZ"
                                              "0123456789_") == std::string::npos;
    if (!plain)
      errors.push_back(
          fmt::format("--method {}: error: \"{}\" is no name of a method; expected all, the name of a "
                      "partitioner, or NAME={{type: ...}} with letters, digits and _ in NAME",
                      m.name, m.name));
    else if (!names.insert(m.name).second)
      errors.push_back(fmt::format("--method {0}: error: the method {0} is named twice", m.name));
    else
      try {
        m.type = make_partitioner(m, registry)->type;
        const std::vector<std::string> taken = registry.names("partitioner");
        if (m.name == "all" || (m.name != m.type && std::find(taken.begin(), taken.end(), m.name) != taken.end()))
          errors.push_back(
              fmt::format("--method {0}: error: {0} is the name of {1}, and the method is of the type {2}; expected a "
                          "name of its own",
                          m.name, m.name == "all" ? "all methods together" : "another partitioner", m.type));
      } catch (const InputError& e) {
        errors.insert(errors.end(), e.lines().begin(), e.lines().end());
      }
  }
  if (!errors.empty()) throw InputError(errors);
  return methods;
}

}  // namespace kerf
