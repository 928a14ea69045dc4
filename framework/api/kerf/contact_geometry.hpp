// Geometry that contact algorithms share: the corners of a facet, its area, thickness and normal; how fast a touch
// moves and closes.
#pragma once

#include <cmath>
#include <cstdint>

#include "kerf/contact.hpp"
#include "kerf/math.hpp"

namespace kerf {

/// How many corners a facet has: a triangle repeats its last one.
inline int n_corners(const std::int32_t* facet_nodes) { return facet_nodes[2] == facet_nodes[3] ? 3 : 4; }

/// The corner positions of a facet and what its penalty needs.
struct FacetGeometry {
  Vec3 x[4];
  Vec3 centre;
  double area = 0.0;  // [m2]
  double thickness = 0.0;  // V/A [m]
  Vec3 normal;  // mean outward unit normal
  double size = 0.0;  // longest edge [m]

  FacetGeometry(const ContactView& view, int facet) {
    const std::int32_t* n = view.facet_nodes + 4 * static_cast<std::int64_t>(facet);
    for (int k = 0; k < 4; ++k) x[k] = view.x(n[k]);
    centre = (x[0] + x[1] + x[2] + x[3]) * 0.25;
    const Vec3 twice = cross(x[2] - x[0], x[3] - x[1]);
    const double length = norm(twice);
    area = 0.5 * length;
    normal = length > 0.0 ? twice * (1.0 / length) : Vec3{};
    thickness = area > 0.0 ? view.facet_volume[facet] / area : 0.0;
    for (int k = 0; k < 4; ++k) size = max_of(size, norm(x[(k + 1) % 4] - x[k]));
  }
};

/// Velocity of the node, or of the point of the edge, relative to the point that it touches, given the velocities of
/// the view's nodes, four numbers each [m/s].
inline Vec3 relative_velocity(const ContactView& view, const ContactTouch& t, const double* velocity) {
  const auto velocity_of = [velocity](std::int32_t node) {
    const double* row = velocity + 4 * static_cast<std::int64_t>(node);
    return Vec3{row[0], row[1], row[2]};
  };
  const std::int32_t* n = view.facet_nodes + 4 * static_cast<std::int64_t>(t.facet);
  Vec3 v = velocity_of(t.node);
  if (t.second >= 0) v = v * (1.0 - t.second_weight) + velocity_of(t.second) * t.second_weight;
  for (int k = 0; k < 4; ++k) v = v - velocity_of(n[k]) * t.weights[k];
  return v;
}
/// The same with the predicted velocities.
inline Vec3 relative_velocity(const ContactView& view, const ContactTouch& t) {
  return relative_velocity(view, t, view.velocity);
}

/// Speed at which the node or the edge of a touch goes deeper [m/s].
inline double closing_speed(const ContactView& view, const ContactTouch& t) {
  return -dot(relative_velocity(view, t), t.direction);
}

}  // namespace kerf
