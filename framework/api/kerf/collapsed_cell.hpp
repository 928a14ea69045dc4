// Wedges, pyramids and tetrahedra as hexahedra with corners that coincide: in which order, and what they look like
// without the corners that repeat.
#pragma once

#include <algorithm>
#include <array>
#include <cstdint>

#include "kerf/shape.hpp"

namespace kerf {

/// What the eight corners of a hexahedron make. Corners that coincide stand in one order of each kind:
///   wedge        0 1 2 3 4 5 5 4   a quadrilateral and the edge over it; 0 3 4 and 1 2 5 are the triangles
///   pyramid      0 1 2 3 4 4 4 4   a quadrilateral and the tip over it
///   tetrahedron  0 1 1 2 3 3 3 3   a triangle and the tip over it
/// In these orders a face that is a triangle repeats its last corner, as Shape wants it. Other faces are collapsed to a
/// line or to a point, and are no faces: see is_collapsed_face().
enum class CellKind : std::uint8_t { hexahedron, wedge, pyramid, tetrahedron, unknown };

/// Whether a face of a cell is none, because its corners are collapsed to a line or to a point.
template <class Id>
constexpr bool is_collapsed_face(const std::array<Id, 4>& face) {
  return face[0] == face[1] || face[1] == face[2];
}

template <class Id>
constexpr CellKind kind_of_cell(const std::array<Id, 8>& n) {
  std::array<Id, 8> sorted = n;
  std::sort(sorted.begin(), sorted.end());
  const auto n_distinct = std::unique(sorted.begin(), sorted.end()) - sorted.begin();
  const bool has_tip = n[4] == n[5] && n[4] == n[6] && n[4] == n[7];
  if (n_distinct == 8) return CellKind::hexahedron;
  if (n_distinct == 6 && n[4] == n[7] && n[5] == n[6]) return CellKind::wedge;
  if (n_distinct == 5 && has_tip) return CellKind::pyramid;
  if (n_distinct == 4 && has_tip && n[1] == n[2]) return CellKind::tetrahedron;
  return CellKind::unknown;
}

namespace collapsed {

using CornerOrder = std::array<std::uint8_t, 8>;

/// The 24 orders of a hexahedron's corners that are rotations of it, from two quarter turns.
constexpr std::array<CornerOrder, 24> all_rotations() {
  constexpr CornerOrder about_z = {1, 2, 3, 0, 5, 6, 7, 4}, about_x = {3, 2, 6, 7, 0, 1, 5, 4};
  std::array<CornerOrder, 24> found{};
  found[0] = {0, 1, 2, 3, 4, 5, 6, 7};
  std::size_t n = 1;
  for (std::size_t k = 0; k < n; ++k)
    for (const CornerOrder& turn : {about_z, about_x}) {
      CornerOrder next{};
      for (std::size_t c = 0; c < 8; ++c) next[c] = found[k][turn[c]];
      bool known = false;
      for (std::size_t i = 0; i < n; ++i) known = known || found[i] == next;
      if (!known) found[n++] = next;
    }
  return found;
}
inline constexpr std::array<CornerOrder, 24> rotations = all_rotations();

// Nodes in VTK's order; the normal of a wedge's first triangle points outward.
inline constexpr Shape wedge = completed({
    .name = "wedge",
    .n_nodes = 6,
    .n_faces = 5,
    .n_edges = 9,
    .face = {{0, 1, 2, 2}, {3, 5, 4, 4}, {0, 2, 5, 3}, {0, 3, 4, 1}, {1, 4, 5, 2}},
    .edge = {{0, 1}, {1, 2}, {2, 0}, {3, 4}, {4, 5}, {5, 3}, {0, 3}, {1, 4}, {2, 5}},
    .reference = {0, 3, 1, 4, 7, 5},
    .vtk_type = 13,
});
inline constexpr Shape pyramid = completed({
    .name = "pyramid",
    .n_nodes = 5,
    .n_faces = 5,
    .n_edges = 8,
    .face = {{0, 3, 2, 1}, {0, 1, 4, 4}, {1, 2, 4, 4}, {2, 3, 4, 4}, {3, 0, 4, 4}},
    .edge = {{0, 1}, {1, 2}, {2, 3}, {3, 0}, {0, 4}, {1, 4}, {2, 4}, {3, 4}},
    .reference = {0, 1, 2, 3, 4},
    .vtk_type = 14,
});
inline constexpr Shape tetrahedron = completed({
    .name = "tetrahedron",
    .n_nodes = 4,
    .n_faces = 4,
    .n_edges = 6,
    .face = {{0, 2, 1, 1}, {0, 1, 3, 3}, {1, 2, 3, 3}, {2, 0, 3, 3}},
    .edge = {{0, 1}, {1, 2}, {2, 0}, {0, 3}, {1, 3}, {2, 3}},
    .reference = {0, 1, 3, 4},
    .vtk_type = 10,
});

}  // namespace collapsed

/// The corners of a wedge, a pyramid or a tetrahedron in the order of its kind, however the hexahedron is turned. The
/// corners of any other cell as they are. A tetrahedron may also come as 0 1 2 3 3 3 3 3.
template <class Id>
constexpr std::array<Id, 8> in_order_of_kind(const std::array<Id, 8>& nodes) {
  if (kind_of_cell(nodes) != CellKind::unknown) return nodes;
  for (const collapsed::CornerOrder& order : collapsed::rotations) {
    std::array<Id, 8> turned{};
    for (std::size_t k = 0; k < 8; ++k) turned[k] = nodes[order[k]];
    if (kind_of_cell(turned) != CellKind::unknown) return turned;
    const Id tip = turned[3];
    if (std::all_of(turned.begin() + 4, turned.end(), [tip](Id n) { return n == tip; })) {
      turned = {turned[0], turned[1], turned[1], turned[2], tip, tip, tip, tip};
      if (kind_of_cell(turned) != CellKind::unknown) return turned;
    }
  }
  return nodes;
}

/// A cell without the corners that repeat: its shape, and where each node of this shape stands among the corners.
struct DistinctCell {
  const Shape* shape = &hexahedron;
  std::array<std::uint8_t, Shape::most_nodes> corner = {0, 1, 2, 3, 4, 5, 6, 7};

  constexpr DistinctCell() = default;
  /// Of a cell of any shape; only hexahedra can be collapsed. One of unknown kind stays as it is.
  template <class Id>
  constexpr DistinctCell(const Shape& all, const std::array<Id, Shape::most_nodes>& nodes) : shape(&all) {
    if (all.vtk_type != hexahedron.vtk_type) return;
    switch (kind_of_cell(nodes)) {
      case CellKind::wedge:
        shape = &collapsed::wedge;
        corner = {3, 0, 4, 2, 1, 5, 0, 0};
        break;
      case CellKind::pyramid:
        shape = &collapsed::pyramid;
        break;
      case CellKind::tetrahedron:
        shape = &collapsed::tetrahedron;
        corner = {0, 1, 3, 4, 0, 0, 0, 0};
        break;
      case CellKind::hexahedron:
      case CellKind::unknown:
        break;
    }
  }

  /// What belongs to the distinct nodes, of something that belongs to all corners.
  template <class T>
  constexpr std::array<T, Shape::most_nodes> of(const std::array<T, Shape::most_nodes>& all) const {
    std::array<T, Shape::most_nodes> distinct{};
    for (std::size_t k = 0; k < static_cast<std::size_t>(shape->n_nodes); ++k) distinct[k] = all[corner[k]];
    return distinct;
  }
};

}  // namespace kerf

KERF_SIZES(collapsed_cell, KERF_SIZE(DistinctCell))
