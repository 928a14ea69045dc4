// Measures of hexahedra and of whole meshes: volume, scaled Jacobian, edge lengths.
#pragma once

#include <array>
#include <cstdint>

#include "kerf/mesh.hpp"

namespace kerf {

using HexCorners = std::array<Vec3, 8>;

/// Volume of a trilinear hexahedron, exact also for warped faces [m3]; equals the volume of the mean
/// gradient of Flanagan & Belytschko (1981). Negative where the element is inside out.
double hex_volume(const HexCorners& x);

/// Least over the corners of det(edges) / (product of their lengths): 1 for a brick, 0 or less for an
/// element that is folded at a corner; 0 where an edge has no length.
double min_scaled_jacobian(const HexCorners& x);

/// Length of the shortest of the twelve edges [m].
double shortest_edge(const HexCorners& x);
/// Length of the longest of the twelve edges [m].
double longest_edge(const HexCorners& x);

/// Corner positions of an element of a generator.
HexCorners corners_of(const MeshGenerator& mesh, std::int64_t element);

/// What `kerf check` prints about a mesh. Element numbers are those of the generator, -1 where it is empty;
/// of equally bad elements the one with the least number is named.
struct MeshReport {
  std::int64_t n_elements = 0, n_nodes = 0;
  double smallest_edge = 0.0, largest_edge = 0.0;  // [m]
  double min_scaled_jacobian = 0.0;
  double min_volume = 0.0, total_volume = 0.0;  // [m3]
  std::int64_t smallest_edge_element = -1, worst_jacobian_element = -1, smallest_volume_element = -1;
  std::int64_t n_unusable = 0;  // elements with a volume or a scaled Jacobian that is not positive
};

/// Looks at every element. Pre: mesh.prepare() found nothing wrong.
MeshReport assess(const MeshGenerator& mesh);

}  // namespace kerf
