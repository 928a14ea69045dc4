// Mesh generators: volumes, numbering and faces of the mesh of a sample.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <set>
#include <vector>

#include "conformance/checks.hpp"
#include "drive/cell_part.hpp"
#include "kerf/collapsed_cell.hpp"
#include "kerf/mesh.hpp"

namespace kerf {

namespace {

/// The first fault of a mesh; empty where there is none.
std::string fault_of(const MeshGenerator& mesh) {
  const Shape& shape = mesh.shape();
  const std::int64_t n_nodes = mesh.n_nodes(), n_elements = mesh.n_elements();
  if (n_nodes <= 0 || n_elements <= 0) return fmt::format("it has {} nodes and {} elements", n_nodes, n_elements);
  std::vector<char> used(static_cast<std::size_t>(n_nodes), 0);
  for (std::int64_t e = 0; e < n_elements; ++e) {
    const ElementNodeIds ids = mesh.element(e);
    CellMesh cell;
    cell.shape = &shape;
    std::array<std::int32_t, 8> corners{};
    std::set<std::int64_t> distinct;
    for (int k = 0; k < shape.n_nodes; ++k) {
      const std::int64_t n = ids[static_cast<std::size_t>(k)];
      if (n < 0 || n >= n_nodes) return fmt::format("element {} has node {} of {}", e, n, n_nodes);
      used[static_cast<std::size_t>(n)] = 1;
      distinct.insert(n);
      corners[static_cast<std::size_t>(k)] = k;
      cell.x.push_back(mesh.node(n));
    }
    if (static_cast<int>(distinct.size()) != DistinctCell(shape, ids).shape->n_nodes)
      return fmt::format(
          "element {} has a node twice, and is no wedge, pyramid or tetrahedron in the order of CellKind", e);
    const double volume = volume_by_divergence(cell, corners);
    if (!(volume > 0.0) || !std::isfinite(volume))
      return fmt::format(
          "element {} has the volume {:.4g} m3 within its faces; list its nodes in the order of the shape "
          "{}",
          e, volume, shape.name);
  }
  const auto unused = std::find(used.begin(), used.end(), 0);
  if (unused != used.end()) return fmt::format("node {} is in no element", unused - used.begin());
  return "";
}

/// Faces of elements that no other element has: the surface.
std::set<std::array<std::int64_t, 4>> surface_of(const MeshGenerator& mesh) {
  std::set<std::array<std::int64_t, 4>> surface;
  const Shape& shape = mesh.shape();
  for (std::int64_t e = 0; e < mesh.n_elements(); ++e) {
    const ElementNodeIds ids = mesh.element(e);
    for (int f = 0; f < shape.n_faces; ++f) {
      std::array<std::int64_t, 4> corners;
      for (std::size_t c = 0; c < 4; ++c) corners[c] = ids[static_cast<std::size_t>(shape.face[f][c])];
      if (is_collapsed_face(corners)) continue;
      const auto key = face_key(corners);
      if (!surface.erase(key)) surface.insert(key);
    }
  }
  return surface;
}

/// Whether every named face has facets, all of them on the surface, and no node that is on none of them.
std::string face_fault(const MeshGenerator& mesh) {
  const auto surface = surface_of(mesh);
  const std::vector<std::string> names = mesh.face_names();
  for (std::size_t f = 0; f < names.size(); ++f) {
    const int face = static_cast<int>(f);
    std::set<std::int64_t> of_facets;
    std::size_t facets = 0;
    for (const auto& key : surface) {
      if (!std::all_of(key.begin(), key.end(), [&](std::int64_t n) { return mesh.on_face(n, face); })) continue;
      ++facets;
      of_facets.insert(key.begin(), key.end());
    }
    std::int64_t nodes = 0;
    for (std::int64_t n = 0; n < mesh.n_nodes(); ++n) nodes += mesh.on_face(n, face);
    if (nodes > 0 && facets == 0) return fmt::format("no facet of the surface lies on its face \"{}\"", names[f]);
    if (nodes != static_cast<std::int64_t>(of_facets.size()))
      return fmt::format(
          "its face \"{}\" has {} nodes, but its facets on the surface have {}; on_face() has to be true "
          "for the nodes of the face and no others",
          names[f], nodes, of_facets.size());
  }
  return "";
}

bool same(const MeshGenerator& a, const MeshGenerator& b) {
  if (a.n_nodes() != b.n_nodes() || a.n_elements() != b.n_elements()) return false;
  for (std::int64_t i = a.n_nodes(); i-- > 0;) {
    const Vec3 x = a.node(i), y = b.node(i);
    if (x.x != y.x || x.y != y.y || x.z != y.z) return false;
  }
  for (std::int64_t e = 0; e < a.n_elements(); ++e)
    for (int k = 0; k < a.shape().n_nodes; ++k)
      if (a.element(e)[static_cast<std::size_t>(k)] != b.element(e)[static_cast<std::size_t>(k)]) return false;
  return true;
}

}  // namespace

void check_mesh(const Registry& registry, const TypeSample& sample, Verdicts& out) {
  const char* check = "mesh";
  if (!out.wants(check)) return;
  try {
    const auto one = make_sample(registry, sample, sample.parameters),
               two = make_sample(registry, sample, sample.parameters);
    auto& mesh = dynamic_cast<MeshGenerator&>(*one);
    auto& again = dynamic_cast<MeshGenerator&>(*two);
    for (MeshGenerator* m : {&mesh, &again})
      if (const auto faults = m->prepare(); !faults.empty()) {
        out.fail(check, fmt::format("prepare() refuses the sample: {}", faults.front()));
        return;
      }
    std::string fault = fault_of(mesh);
    if (fault.empty()) fault = face_fault(mesh);
    // Last node first the second time: what is computed must not depend on what was asked before.
    if (fault.empty() && !same(mesh, again))
      fault = "two meshes of the same parameters differ, or depend on the order in which nodes are asked for";
    if (fault.empty())
      out.pass(check, fmt::format("{} nodes, {} elements: volumes, numbers and {} faces are sound", mesh.n_nodes(),
                                  mesh.n_elements(), mesh.face_names().size()));
    else
      out.fail(check, fault);
  } catch (const std::exception& e) {
    out.fail(check, sentence_of(e));
  }
}

}  // namespace kerf
