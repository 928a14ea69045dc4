// `kerf convert`: a keyword deck, or the mesh of another program, as an input of Kerf's own with its mesh.
#include <fmt/format.h>

#include <algorithm>
#include <cstdio>
#include <filesystem>
#include <fstream>
#include <set>

#include "app/commands.hpp"
#include "app/load_input.hpp"
#include "core/diagnostics.hpp"
#include "lowering/lower_deck.hpp"
#include "lowering/lower_mesh.hpp"
#include "mesh/mesh_file.hpp"

namespace kerf {
namespace {

constexpr const char* case_name = "case.yaml";
constexpr const char* mesh_name = "mesh.h5";

std::string folder_of(const RunOptions& options) {
  if (!options.output.empty()) return options.output;
  return std::filesystem::path(options.input).replace_extension("").string() + ".kerf";
}

void write_text(const std::string& path, const std::string& text) {
  std::ofstream file(path, std::ios::binary);
  file << text;
  file.close();
  if (!file) throw InputError({path + ": error: the file cannot be written"});
}

void write_case(const RunOptions& options, const Node& document, const FileMesh& mesh, const std::string& remark) {
  const std::string folder = folder_of(options);
  std::error_code failure;
  std::filesystem::create_directories(folder, failure);
  if (failure) throw InputError({fmt::format("{}: error: the folder cannot be made: {}", folder, failure.message())});
  const std::string mesh_path = (std::filesystem::path(folder) / mesh_name).string();
  write_mesh(mesh, mesh_path);
  const std::string case_path = (std::filesystem::path(folder) / case_name).string();
  write_text(case_path, remark + yaml_text(document));
  fmt::print("{}\n{}\n", case_path, mesh_path);
}

/// The file that all parts take their meshes from.
void name_mesh(Node& document) {
  Entry* parts = document.find("parts");
  if (!parts) return;
  for (Entry& part : parts->value.entries) part.value.find("mesh")->value.find("file")->value.text = mesh_name;
}

int convert_deck(const RunOptions& options) {
  Diagnostics diagnostics;
  lowering::LoweringOptions how{options.units, options.case_number, options.without_unsupported, options.strict};
  how.mesh_is_enough = true;
  lowering::LoweredDeck deck = lowering::lower_deck(options.input, how, diagnostics);
  for (const std::string& warning : diagnostics.warnings()) fmt::print(stderr, "{}\n", warning);
  diagnostics.throw_if_errors();
  for (const std::string& text : options.overrides) apply_override(deck.document, text, diagnostics);
  diagnostics.throw_if_errors();
  name_mesh(deck.document);
  const std::string remark =
      fmt::format("# Made by `kerf convert` of {}, whose units are {}.\n{}", options.input, deck.report.units,
                  deck.document.find("time") ? "" : "# The deck is a mesh only: add time, materials and what moves.\n");
  write_case(options, deck.document, *deck.mesh, remark);
  return exit_done;
}

int convert_mesh(const RunOptions& options) {
  Diagnostics diagnostics;
  const std::string unit = lowering::length_of(options.units, diagnostics);
  const FileMesh mesh = read_mesh_file(options.input, diagnostics);
  for (const std::string& warning : diagnostics.warnings()) fmt::print(stderr, "{}\n", warning);
  diagnostics.throw_if_errors();
  Node document = lowering::document_of_mesh(mesh, mesh_name, unit);
  write_case(
      options, document, mesh,
      fmt::format("# Made by `kerf convert` of {}: a mesh only. Add time, materials and what moves.\n", options.input));
  return exit_done;
}

}  // namespace

int convert_command(const RunOptions& options, Registry& registry) {
  try {
    const std::string bytes = read_with_plugins(options, registry);
    return lowering::is_deck(options.input, bytes) ? convert_deck(options) : convert_mesh(options);
  } catch (const InputError& e) {
    for (const std::string& line : e.lines()) fmt::print(stderr, "{}\n", line);
    return exit_input_error;
  }
}

}  // namespace kerf
