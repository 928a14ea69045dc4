// Geometry that contact algorithms share: closest points on facets, penalty stiffness, Coulomb friction.
#pragma once

#include <cmath>
#include <cstdint>

#include "kerf/contact.hpp"
#include "kerf/math.hpp"

namespace kerf {

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

/// Relative velocity of a node and the point of a facet with the given weights [m/s].
inline Vec3 relative_velocity(const ContactView& view, int node, const std::int32_t* n, const double (&weights)[4]) {
  Vec3 v = view.v(node);
  for (int k = 0; k < 4; ++k) v = v - view.v(n[k]) * weights[k];
  return v;
}

/// Mass that a force between a node and a point of a facet moves: 1 / (1/m_s + sum w_k^2 / m_k) [kg].
inline double effective_mass(const ContactView& view, int node, const std::int32_t* n, const double (&weights)[4]) {
  double inverse = 1.0 / view.mass[node];
  for (int k = 0; k < 4; ++k) inverse += weights[k] * weights[k] / view.mass[n[k]];
  return 1.0 / inverse;
}

/// How a penetrating node is pushed back.
struct PenaltyLaw {
  double stiffness = 0.0;  // [N/m]
  double damping = 0.0;  // of the normal motion, as a fraction of critical [-]
  double friction = 0.0;  // Coulomb coefficient [-]
};

/// Penalty force on a node at `depth` > 0 below a facet with outward `direction`: spring and dashpot along it, never
/// pulling, and Coulomb friction against the sliding velocity. Friction never exceeds what would stop the sliding in
/// two steps, which keeps it from pushing back.
inline Vec3 penalty_force(const PenaltyLaw& law, double depth, Vec3 direction, Vec3 velocity, double effective_mass,
                          double dt) {
  const double opening = dot(velocity, direction);
  const double dashpot = 2.0 * law.damping * std::sqrt(law.stiffness * effective_mass);
  const double push = max_of(law.stiffness * depth - dashpot * opening, 0.0);
  Vec3 force = direction * push;
  if (law.friction > 0.0 && dt > 0.0) {
    const Vec3 sliding = velocity - direction * opening;
    const double speed = norm(sliding);
    if (speed > 0.0) {
      const double grip = min_of(law.friction * push, 0.5 * effective_mass * speed / dt);
      force = force - sliding * (grip / speed);
    }
  }
  return force;
}

}  // namespace kerf
