// Shapes of elements: which of an element's nodes make its faces and edges, and what follows from them alone.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <utility>

#include "kerf/math.hpp"

namespace kerf {

/// Only solids can be computed today; the others are errors of the input.
enum class Dimension { solid, plane, axisymmetric };

/// Corners of a cube of edge one, in the order of a hexahedron's nodes.
inline constexpr int unit_cube[8][3] = {{0, 0, 0}, {1, 0, 0}, {1, 1, 0}, {0, 1, 0},
                                        {0, 0, 1}, {1, 0, 1}, {1, 1, 1}, {0, 1, 1}};

/// What surface, contact, measures and output know of a kind of element. Nodes are numbered from 0. A face lists its
/// corners counter-clockwise as seen from outside; a triangle repeats its last corner, so that all faces have four.
struct Shape {
  static constexpr int most_nodes = 8, most_faces = 6, most_edges = 12;
  /// The id of a facet is this times the id of its element, plus the number of the face.
  static constexpr int code_of_faces = 8;

  const char* name = "";
  int n_nodes = 0, n_faces = 0, n_edges = 0;
  int face[most_faces][4] = {};
  /// For each corner of a face, the node that an edge leads to from there, away from the face; -1 where there is none.
  int behind[most_faces][4] = {};
  int opposite_face[most_faces] = {};  // -1 where no face lies opposite
  int edge[most_edges][2] = {};
  /// The reference element: the corner of the unit cube where each node lies. Lanes that hold no element are computed
  /// with a large reference element.
  int reference[most_nodes] = {};
  /// Shares of an element's mass that its nodes get; they add up to one. Equal where none is given.
  double mass_share[most_nodes] = {};
  /// For each node where three edges meet, the nodes that they lead to, so that the edges make a right-handed system;
  /// -1 at other nodes.
  int neighbour[most_nodes][3] = {};
  Dimension dimension = Dimension::solid;
  int vtk_type = 0;  // number of the cell type in VTK's files
};

/// Positions of an element's nodes [m]; entries beyond the shape's number of nodes mean nothing.
using CellCorners = std::array<Vec3, Shape::most_nodes>;

/// Nodes of one element, by global id or local number; entries beyond the shape's number of nodes mean nothing.
using ElementNodeIds = std::array<std::int64_t, Shape::most_nodes>;

/// Nodes of a face in ascending order, the same from either side: a triangle repeats its greatest node, whichever
/// corner its shape repeats. So does a face that is collapsed to a triangle or to a line.
template <class Id>
constexpr std::array<Id, 4> face_key(std::array<Id, 4> n) {
  const auto order = [&n](std::size_t i, std::size_t j) {
    if (n[j] < n[i]) std::swap(n[i], n[j]);
  };
  order(0, 1);
  order(2, 3);
  order(0, 2);
  order(1, 3);
  order(1, 2);
  std::size_t n_distinct = 1;
  for (std::size_t k = 1; k < 4; ++k)
    if (n[k] != n[n_distinct - 1]) n[n_distinct++] = n[k];
  for (std::size_t k = n_distinct; k < 4; ++k) n[k] = n[n_distinct - 1];
  return n;
}

/// The face of a shape whose corners are the given ones in any order, or -1.
constexpr int face_with(const Shape& shape, const int (&corners)[4]) {
  for (int f = 0; f < shape.n_faces; ++f) {
    bool all = true;
    for (const int corner : shape.face[f]) {
      bool found = false;
      for (const int c : corners) found = found || c == corner;
      all = all && found;
    }
    if (all) return f;
  }
  return -1;
}

/// The nodes that edges lead to from a node, ordered by the reference element.
constexpr void find_neighbours(Shape& s, int node) {
  int(&found)[3] = s.neighbour[node];
  int n = 0;
  for (int e = 0; e < s.n_edges; ++e)
    for (int end = 0; end < 2; ++end)
      if (s.edge[e][end] == node) {
        if (n < 3) found[n] = s.edge[e][1 - end];
        ++n;
      }
  if (n != 3) {
    found[0] = found[1] = found[2] = -1;
    return;
  }
  int to[3][3] = {};
  for (int k = 0; k < 3; ++k)
    for (int d = 0; d < 3; ++d) to[k][d] = unit_cube[s.reference[found[k]]][d] - unit_cube[s.reference[node]][d];
  int triple = 0;
  for (int d = 0; d < 3; ++d) {
    const int e = (d + 1) % 3, f = (d + 2) % 3;
    triple += to[0][d] * (to[1][e] * to[2][f] - to[1][f] * to[2][e]);
  }
  if (triple < 0) std::swap(found[1], found[2]);
}

/// Fills in what follows from faces, edges and the reference element: the nodes behind each face, the face opposite,
/// and the neighbours of each node; and equal shares of the mass where there are none.
constexpr Shape completed(Shape s) {
  double mass = 0.0;
  for (int n = 0; n < s.n_nodes; ++n) mass += s.mass_share[n];
  for (int n = 0; n < s.n_nodes && mass == 0.0; ++n) s.mass_share[n] = 1.0 / s.n_nodes;
  for (int n = 0; n < s.n_nodes; ++n) find_neighbours(s, n);
  for (int f = 0; f < s.n_faces; ++f) {
    const auto is_corner = [&](int node) {
      for (const int c : s.face[f])
        if (c == node) return true;
      return false;
    };
    bool all = true;
    for (int k = 0; k < 4; ++k) {
      s.behind[f][k] = -1;
      for (int e = 0; e < s.n_edges; ++e)
        for (int end = 0; end < 2; ++end)
          if (s.edge[e][end] == s.face[f][k] && !is_corner(s.edge[e][1 - end])) s.behind[f][k] = s.edge[e][1 - end];
      all = all && s.behind[f][k] >= 0;
    }
    s.opposite_face[f] = all ? face_with(s, s.behind[f]) : -1;
  }
  return s;
}

inline constexpr Shape hexahedron = completed({
    .name = "hexahedron",
    .n_nodes = 8,
    .n_faces = 6,
    .n_edges = 12,
    .face = {{0, 3, 2, 1}, {4, 5, 6, 7}, {0, 1, 5, 4}, {1, 2, 6, 5}, {2, 3, 7, 6}, {3, 0, 4, 7}},
    .edge = {{0, 1}, {1, 2}, {2, 3}, {3, 0}, {4, 5}, {5, 6}, {6, 7}, {7, 4}, {0, 4}, {1, 5}, {2, 6}, {3, 7}},
    .reference = {0, 1, 2, 3, 4, 5, 6, 7},
    .vtk_type = 12,
});

/// Volume of a cell with plane or bilinear faces, by the divergence theorem [m3]; negative where it is inside out. Each
/// face is the mean of its two divisions into triangles, which has the flux of the bilinear face.
inline double volume_by_faces(const Shape& shape, const CellCorners& x) {
  double sum = 0.0;
  for (int f = 0; f < shape.n_faces; ++f) {
    const auto at = [&](int k) { return x[static_cast<std::size_t>(shape.face[f][k])] - x[0]; };
    const Vec3 a = at(0), b = at(1), c = at(2), d = at(3);
    sum += dot(a, cross(b, c)) + dot(a, cross(c, d)) + dot(b, cross(c, d)) + dot(b, cross(d, a));
  }
  return sum / 12.0;
}

/// The reference element with edges of length `edge` [m].
inline CellCorners reference_cell(const Shape& shape, double edge) {
  CellCorners x;
  for (std::size_t k = 0; k < static_cast<std::size_t>(shape.n_nodes); ++k)
    for (int d = 0; d < 3; ++d) x[k][d] = edge * unit_cube[shape.reference[k]][d];
  return x;
}

}  // namespace kerf

KERF_SIZES(shape, KERF_SIZE(Shape))
