// The volume that two hexahedra share: one is cut by the faces of the other.
#pragma once

#include <array>

#include "mesh/quality.hpp"

namespace kerf {

/// What two cells have in common; a volume of zero where they have nothing.
struct SharedVolume {
  double volume = 0.0;  // [m3]
  Vec3 low, high;  // corners of the box round it [m]; without meaning where there is no volume
};

/// The six planes on which a cell's faces lie. A warped face lies on none: its plane goes through the mean of its
/// corners, and `warp` tells how far the corners are from it.
struct FacePlanes {
  explicit FacePlanes(const HexCorners& x);

  std::array<Vec3, 6> normal;  // of length one, outward; zero where a face has no area
  std::array<double, 6> offset{};  // of the plane: dot(normal, x) = offset [m]
  std::array<double, 6> warp{};  // [m]
  double greatest_warp = 0.0;  // [m]
};

/// What two convex cells have in common where they overlap by more than `tolerance` [m]; the volume is then less than
/// the true one by what the tolerance takes away. Cells that share a face, an edge or a corner have nothing in common.
/// Faces of `b` that are warped are moved inwards by their warp.
SharedVolume shared_volume(const HexCorners& a, const FacePlanes& planes_of_a, const HexCorners& b,
                           const FacePlanes& planes_of_b, double tolerance);

}  // namespace kerf
