// `kerf mesh`: what is in the file of a mesh, and the mesh in Kerf's own form.
#include <fmt/format.h>

#include <cstdio>
#include <stdexcept>

#include "app/commands.hpp"
#include "core/diagnostics.hpp"
#include "mesh/mesh_digest.hpp"
#include "mesh/mesh_file.hpp"
#include "output/file.hpp"

namespace kerf {
namespace {

/// `called` is what an input calls it; empty where an input does not name this kind.
std::string line_of(const char* kind, const std::string& name, std::size_t n, const std::string& called = {}) {
  return fmt::format("{:<12} {:<24} {:>12}{}\n", kind, "\"" + name + "\"", n,
                     called.empty() || called == name ? "" : "  as \"" + called + "\"");
}

std::string contents_of(const FileMesh& mesh) {
  std::string text = fmt::format("format       {}\nnodes        {}\nelements     {}\ndigest       {}\n\n", mesh.format,
                                 mesh.points.size(), mesh.cells.size(), digest_text(mesh));
  const MeshSets sets(mesh);
  for (const MeshBlock& b : mesh.blocks) text += line_of("block", b.name, b.cells.size(), mesh.call(b));
  for (const MeshBlock& s : mesh.cell_sets) text += line_of("element set", s.name, s.cells.size());
  for (const MeshNodeSet& s : mesh.node_sets)
    text += line_of("node set", s.name, s.nodes.size(), sets.call(node_set_word, s.name));
  for (const MeshFaceSet& s : mesh.face_sets)
    text += line_of("face set", s.name, s.faces.size(), sets.call(face_set_word, s.name));
  for (const auto& [kind, n] : mesh.left_out) text += line_of("left out", kind, static_cast<std::size_t>(n));
  return text;
}

}  // namespace

int mesh_command(const std::string& file, const std::string& into) {
  if (!into.empty() && !into.ends_with(".h5")) {
    fmt::print(stderr, "error: the mesh cannot be written to \"{}\"; expected a name that ends in .h5\n", into);
    return exit_input_error;
  }
  Diagnostics diagnostics;
  const FileMesh mesh = read_mesh_file(file, diagnostics);
  print_warnings(diagnostics.warnings());
  diagnostics.throw_if_errors();
  print_now(contents_of(mesh));
  if (into.empty()) return exit_done;
  try {
    write_mesh(mesh, into);
  } catch (const std::runtime_error& e) {
    fmt::print(stderr, "error: {}\n", e.what());
    return exit_other;
  }
  print_now(fmt::format("\nthe mesh is in {}\n", into));
  return exit_done;
}

}  // namespace kerf
