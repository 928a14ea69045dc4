// Sample meshes for the tests of readers: files of the repository, and a small mesh written in every format of Gmsh.
#pragma once

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <fstream>
#include <sstream>
#include <string>
#include <vector>

#include "kerf/shape.hpp"
#include "mesh/mesh_file.hpp"

namespace kerf::test {

inline std::string sample_path(const std::string& name) {
  return std::string(KERF_SOURCE_DIR) + "/tests/data/meshes/" + name;
}

inline std::string bytes_of(const std::string& path) {
  std::ifstream in(path, std::ios::binary);
  std::ostringstream text;
  text << in.rdbuf();
  return text.str();
}

/// Reads a text with the reader that the ending of `name` tells.
inline FileMesh read_mesh_text(const std::string& name, const std::string& bytes, Diagnostics& diagnostics) {
  const MeshFileText file{bytes, name};
  if (name.ends_with(".msh")) return read_gmsh(file, diagnostics);
  if (name.ends_with(".inp")) return read_abaqus(file, diagnostics);
  return read_exodus(file, diagnostics);
}

/// A mesh that has to be without mistakes.
inline FileMesh read_sound(const std::string& name, const std::string& bytes) {
  Diagnostics diagnostics;
  FileMesh mesh = read_mesh_text(name, bytes, diagnostics);
  check_mesh(mesh, name, diagnostics);
  for (const std::string& error : diagnostics.errors()) ADD_FAILURE() << error;
  return mesh;
}

inline std::string errors_of(const std::string& name, const std::string& bytes) {
  Diagnostics diagnostics;
  const FileMesh mesh = read_mesh_text(name, bytes, diagnostics);
  if (!diagnostics.has_errors()) check_mesh(mesh, name, diagnostics);
  std::string text;
  for (const std::string& error : diagnostics.errors()) text += error + "\n";
  return text;
}

inline Vec3 point_of(const FileMesh& mesh, std::int32_t node) {
  const auto& x = mesh.points.at(static_cast<std::size_t>(node));
  return {x[0], x[1], x[2]};
}

inline double cell_volume(const FileMesh& mesh, std::int32_t cell) {
  CellCorners x;
  for (std::size_t k = 0; k < 8; ++k) x[k] = point_of(mesh, mesh.cells.at(static_cast<std::size_t>(cell))[k]);
  return volume_by_faces(hexahedron, x);
}

inline double volume_of(const FileMesh& mesh, const std::vector<std::int32_t>& cells) {
  double volume = 0.0;
  for (const std::int32_t cell : cells) volume += cell_volume(mesh, cell);
  return volume;
}

/// What plane faces enclose where all of them look outward.
inline double enclosed_by(const FileMesh& mesh, const MeshFaceSet& faces) {
  double six = 0.0;
  for (const auto& f : faces.faces) {
    const Vec3 a = point_of(mesh, f[0]), b = point_of(mesh, f[1]), c = point_of(mesh, f[2]), d = point_of(mesh, f[3]);
    six += dot(a, cross(b, c)) + dot(a, cross(c, d));
  }
  return six / 6.0;
}

inline const MeshNodeSet& node_set(const FileMesh& mesh, const std::string& name) {
  for (const MeshNodeSet& set : mesh.node_sets)
    if (set.name == name) return set;
  throw std::out_of_range("no node set " + name);
}

inline const MeshFaceSet& face_set(const FileMesh& mesh, const std::string& name) {
  for (const MeshFaceSet& set : mesh.face_sets)
    if (set.name == name) return set;
  throw std::out_of_range("no face set " + name);
}

/// Formats of Gmsh.
struct GmshFormat {
  int version = 41;
  bool binary = false, swapped = false, parametric = false;
};

/// A brick, a wedge, a pyramid and a tetrahedron that share faces, a quadrangle and a triangle, a line and a point,
/// with numbers far apart, in several blocks. "body" is all but the tetrahedron, which is "tip".
std::string small_gmsh_mesh(const GmshFormat& format);

}  // namespace kerf::test
