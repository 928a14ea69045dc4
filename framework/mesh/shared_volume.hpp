// The volume that two cells share: one is cut by the faces of the other.
#pragma once

#include <array>

#include "kerf/shape.hpp"

namespace kerf {

/// A cell and where its corners are.
struct Cell {
  const Shape* shape = &hexahedron;
  CellCorners x;  // [m]
};

/// What two cells have in common; a volume of zero where they have nothing.
struct SharedVolume {
  double volume = 0.0;  // [m3]
  Vec3 low, high;  // corners of the box round it [m]; without meaning where there is no volume
};

/// The planes on which a cell's faces lie. A warped face lies on none: its plane goes through the mean of its
/// corners, and `warp` tells how far the corners are from it.
struct FacePlanes {
  explicit FacePlanes(const Cell& cell);

  std::array<Vec3, Shape::most_faces> normal;  // of length one, outward; zero where a face has no area
  std::array<double, Shape::most_faces> offset{};  // of the plane: dot(normal, x) = offset [m]
  std::array<double, Shape::most_faces> warp{};  // [m]
  double greatest_warp = 0.0;  // [m]
};

/// What two convex cells have in common where they overlap by more than `tolerance` [m]; the volume is then less than
/// the true one by what the tolerance takes away. Cells that share a face, an edge or a corner have nothing in common.
/// Faces of `b` that are warped are moved inwards by their warp.
SharedVolume shared_volume(const Cell& a, const FacePlanes& planes_of_a, const Cell& b, const FacePlanes& planes_of_b,
                           double tolerance);

}  // namespace kerf
