// Shapes of elements: which of an element's nodes make its faces and edges. The only place that numbers corners.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <utility>

namespace kerf {

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
  int vtk_type = 0;  // number of the cell type in VTK's files
};

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

/// Fills in what follows from faces and edges: the nodes behind each face, and the face opposite.
constexpr Shape completed(Shape s) {
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
    .vtk_type = 12,
});

}  // namespace kerf
