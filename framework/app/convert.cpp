// `kerf convert`: a keyword deck, or the mesh of another program, as an input of Kerf's own with its mesh.
#include <fmt/format.h>

#include <cstdio>
#include <filesystem>
#include <stdexcept>

#include "app/commands.hpp"
#include "app/load_input.hpp"
#include "core/diagnostics.hpp"
#include "lowering/lower_deck.hpp"
#include "lowering/lower_mesh.hpp"
#include "mesh/mesh_file.hpp"
#include "output/file.hpp"

namespace kerf {
namespace {

constexpr const char* case_name = "case.yaml";
constexpr const char* mesh_name = "mesh.h5";

std::string folder_of(const RunOptions& options) {
  if (!options.output.empty()) return options.output;
  return std::filesystem::path(options.input).replace_extension("").string() + ".kerf";
}

void write_case(const RunOptions& options, const Node& document, const FileMesh& mesh, const std::string& remark) {
  const std::string folder = folder_of(options);
  make_folder(folder);
  const std::string mesh_path = (std::filesystem::path(folder) / mesh_name).string();
  write_mesh(mesh, mesh_path);
  const std::string case_path = (std::filesystem::path(folder) / case_name).string();
  replace_file(case_path, remark + yaml_text(document));
  fmt::print("{}\n{}\n", case_path, mesh_path);
}

int convert_deck(const RunOptions& options) {
  Diagnostics diagnostics;
  lowering::LoweringOptions how{options.units, options.case_number, options.without_unsupported, options.strict};
  how.mesh_name = mesh_name;
  how.mesh_is_enough = true;
  lowering::LoweredDeck deck = lowering::lower_deck(options.input, how, diagnostics);
  print_warnings(diagnostics.warnings());
  diagnostics.throw_if_errors();
  for (const std::string& text : options.overrides) apply_override(deck.document, text, diagnostics);
  diagnostics.throw_if_errors();
  const std::string remark =
      fmt::format("# Made by `kerf convert` of {}, whose units are {}.\n{}", options.input, deck.report.units,
                  deck.document.find("time") ? "" : "# The deck is a mesh only: add time, materials and what moves.\n");
  write_case(options, deck.document, *deck.mesh, remark);
  return exit_done;
}

int convert_mesh(const RunOptions& options, const std::string& bytes) {
  Diagnostics diagnostics;
  const std::string unit = lowering::length_of(options.units, diagnostics);
  const FileMesh mesh = read_mesh({bytes, options.input}, diagnostics);
  print_warnings(diagnostics.warnings());
  diagnostics.throw_if_errors();
  Node document = lowering::document_of_mesh(mesh, mesh_name, unit);
  write_case(
      options, document, mesh,
      fmt::format("# Made by `kerf convert` of {}: a mesh only. Add time, materials and what moves.\n", options.input));
  return exit_done;
}

}  // namespace

int convert_command(const RunOptions& options) {
  try {
    const std::string bytes = read_input_file(options.input);
    return lowering::is_deck(options.input, bytes) ? convert_deck(options) : convert_mesh(options, bytes);
  } catch (const InputError& e) {
    for (const std::string& line : e.lines()) fmt::print(stderr, "{}\n", line);
    return exit_input_error;
  } catch (const std::runtime_error& e) {
    fmt::print(stderr, "error: {}\n", e.what());
    return exit_other;
  }
}

}  // namespace kerf
