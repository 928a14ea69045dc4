// Measures of cells and of whole meshes: scaled Jacobian, edge lengths, volume.
#pragma once

#include <cstdint>

#include "kerf/mesh.hpp"

namespace kerf {

/// Least over the corners where three edges meet of det(edges) / (product of their lengths): 1 for a brick, 0 or less
/// for an element that is folded at a corner; 0 where an edge has no length.
double min_scaled_jacobian(const Shape& shape, const CellCorners& x);

/// Length of the shortest edge [m].
double shortest_edge(const Shape& shape, const CellCorners& x);
/// Length of the longest edge [m].
double longest_edge(const Shape& shape, const CellCorners& x);

/// An element of a generator: its shape, that of its distinct nodes where it is collapsed, and where these lie.
struct PlacedCell {
  const Shape* shape = nullptr;
  CellCorners x;  // [m]
};
PlacedCell placed_cell(const MeshGenerator& mesh, std::int64_t element);

/// What is known of a mesh before an element computes it; volumes are those of plane or bilinear faces.
struct MeshReport {
  std::int64_t n_elements = 0, n_nodes = 0;
  double smallest_edge = 0.0, largest_edge = 0.0;  // [m]
  double min_scaled_jacobian = 0.0;
  double total_volume = 0.0;  // [m3]
  std::int64_t n_unusable = 0;  // elements with a volume or a scaled Jacobian that is not positive
};

/// Looks at every element. Pre: mesh.prepare() found nothing wrong.
MeshReport assess(const MeshGenerator& mesh);

}  // namespace kerf
