// The impact of one touch, and the split of masses between touches.
#include "dynamics/contact_impacts.hpp"

#include <algorithm>
#include <cmath>

namespace kerf {

namespace {

const std::int32_t* corners_of(const ContactView& view, const ContactTouch& t) {
  return view.facet_nodes + 4 * static_cast<std::int64_t>(t.facet);
}

/// What a touch asks of the mass of its node, and in proportion to their weights of the masses of the corners: the
/// lesser of the two masses that meet [mass quanta].
std::int64_t share_of(const ContactView& view, const ContactTouch& t, double quantum) {
  const std::int32_t* n = corners_of(view, t);
  double across = 0.0;
  for (int k = 0; k < 4; ++k) across += t.weights[k] * view.mass[n[k]];
  return std::max(std::llrint(std::min(view.mass[t.node], across) / quantum), 1LL);
}
std::int64_t share_of_corner(std::int64_t share, double weight) {
  return std::llrint(static_cast<double>(share) * weight);
}

/// The mass that moves in a touch: 1 / (1/m_s + sum of w_k^2 / m_k), of the shares of mass that the touch has [kg].
/// Infinite where boundary conditions hold all nodes.
double effective_mass(const ContactView& view, const ContactTouch& t, const MassSplit& split, Vec3 along) {
  const std::int32_t* n = corners_of(view, t);
  const auto share = static_cast<double>(share_of(view, t, split.quantum));
  const auto part = [&](int node) {
    return static_cast<double>(split.shares[node]) / (share * view.mass[node]) * view.mobility(node, along);
  };
  double inverse = part(t.node);
  for (int k = 0; k < 4; ++k) inverse += t.weights[k] * part(n[k]);
  return 1.0 / inverse;
}

/// Velocity of the node relative to the point that it touches [m/s].
Vec3 relative_velocity(const ContactView& view, const ContactTouch& t) {
  const std::int32_t* n = corners_of(view, t);
  Vec3 v = view.v(t.node);
  for (int k = 0; k < 4; ++k) v = v - view.v(n[k]) * t.weights[k];
  return v;
}

/// The change of the closing speed that an impact makes [m/s]. It takes away what would lead below the surface, and
/// takes back some of a depth that is there already, with a rebound of at most `restitution`: since a pair never parts
/// faster than it closed, the impact makes no energy.
double change_of_speed(const ContactTouch& t, const ContactResponse& r, double closing, double mass, double dt) {
  const double before = t.depth - closing * dt;  // depth at the start of the step, if positive
  if (!(before > 0.0)) return t.depth / dt;
  const double rate = min_of(t.stiffness * dt / mass, r.stability / dt);
  return closing + min_of(rate * before, r.restitution * closing);
}

}  // namespace

void ContactForces::add(int node, const std::int32_t* facet_nodes, const double (&weights)[4], Vec3 force) {
  for (int d = 0; d < 3; ++d) {
    std::int64_t sum = 0;
    for (int k = 0; k < 4; ++k) {
      const double share = force[d] * weights[k] * scale_.per_quantum;
      if (!(std::fabs(share) < ForceScale::limit)) {
        overflow_node_ = node;
        return;
      }
      const auto quanta = static_cast<std::int64_t>(std::llrint(share));
      force_[4 * facet_nodes[k] + d] -= quanta;
      sum += quanta;
    }
    force_[4 * node + d] += sum;
  }
}

void add_shares(const ContactView& view, const ContactTouches& touches, const MassSplit& split) {
  for (const ContactTouch& t : touches.touches()) {
    const std::int64_t share = share_of(view, t, split.quantum);
    split.shares[t.node] += share;
    for (int k = 0; k < 4; ++k) split.shares[corners_of(view, t)[k]] += share_of_corner(share, t.weights[k]);
  }
}

void add_impacts(const ContactView& view, const ContactTouches& touches, const ContactResponse& response,
                 const MassSplit& split, ContactForces& forces) {
  for (const ContactTouch& t : touches.touches()) {
    const Vec3 v = relative_velocity(view, t);
    const double closing = -dot(v, t.direction);
    if (!(closing > 0.0)) continue;
    const double mass = effective_mass(view, t, split, t.direction);
    if (!std::isfinite(mass)) continue;
    const double push = mass * change_of_speed(t, response, closing, mass, view.dt);
    Vec3 impulse = t.direction * push;
    const Vec3 sliding = v + t.direction * closing;
    const double speed = norm(sliding);
    if (response.friction > 0.0 && speed > 0.0) {
      const Vec3 way = sliding * (1.0 / speed);
      impulse = impulse - way * min_of(response.friction * push, effective_mass(view, t, split, way) * speed);
    }
    forces.add(t.node, corners_of(view, t), t.weights, impulse * (1.0 / view.kick_dt));
  }
}

}  // namespace kerf
