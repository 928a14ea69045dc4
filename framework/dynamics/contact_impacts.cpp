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
/// lesser of the two masses that meet [mass quanta]. An edge has the mean of its nodes' masses.
std::int64_t share_of(const ContactView& view, const ContactTouch& t, double quantum) {
  const std::int32_t* n = corners_of(view, t);
  double own = view.mass[t.node], across = 0.0;
  if (t.second >= 0) own += t.second_weight * (view.mass[t.second] - own);
  for (int k = 0; k < 4; ++k) across += t.weights[k] * view.mass[n[k]];
  return std::max(std::llrint(std::min(own, across) / quantum), 1LL);
}
std::int64_t share_of_corner(std::int64_t share, double weight) {
  return std::llrint(static_cast<double>(share) * weight);
}

/// The mass that moves in a touch: 1 / (1/m_s + sum of w_k^2 / m_k), of the shares of mass that the touch has [kg];
/// with an edge, 1/m_s is the sum of w^2/m of its two nodes. Infinite where boundary conditions hold all nodes.
double effective_mass(const ContactView& view, const ContactTouch& t, const MassSplit& split, Vec3 along) {
  const std::int32_t* n = corners_of(view, t);
  const auto share = static_cast<double>(share_of(view, t, split.quantum));
  const auto part = [&](int node) {
    return static_cast<double>(split.shares[node]) / (share * view.mass[node]) * view.mobility(node, along);
  };
  double inverse = part(t.node);
  if (t.second >= 0) inverse = (1.0 - t.second_weight) * inverse + t.second_weight * part(t.second);
  for (int k = 0; k < 4; ++k) inverse += t.weights[k] * part(n[k]);
  return 1.0 / inverse;
}

/// Velocity of the node, or of the point of the edge, relative to the point that it touches [m/s].
Vec3 relative_velocity(const ContactView& view, const ContactTouch& t, const double* velocity) {
  const auto v = [velocity](std::int32_t node) {
    const double* row = velocity + 4 * static_cast<std::int64_t>(node);
    return Vec3{row[0], row[1], row[2]};
  };
  const std::int32_t* n = corners_of(view, t);
  Vec3 sum = v(t.node);
  if (t.second >= 0) sum = sum * (1.0 - t.second_weight) + v(t.second) * t.second_weight;
  for (int k = 0; k < 4; ++k) sum = sum - v(n[k]) * t.weights[k];
  return sum;
}

/// The closing speed that an impact leaves [m/s]: what leads just to the surface. Of a depth that is there already some
/// is taken back, with a rebound of at most `restitution`: since a pair never parts faster than it closed, the impact
/// makes no energy.
double wanted_speed(const ContactTouch& t, const ContactResponse& r, double closing, double mass, double dt) {
  const double before = t.depth - closing * dt;  // depth at the start of the step, if positive
  if (!(before > 0.0)) return -before / dt;
  const double rate = min_of(t.stiffness * dt / mass, r.stability / dt);
  return -min_of(rate * before, r.restitution * max_of(closing, 0.0));
}

}  // namespace

void ContactForces::add_to(std::int64_t* sums, const ContactTouch& touch, const std::int32_t* facet_nodes, Vec3 force) {
  for (int d = 0; d < 3; ++d) {
    std::int64_t sum = 0;
    for (int k = 0; k < 4; ++k) {
      const double share = force[d] * touch.weights[k] * scale_.per_quantum;
      if (!(std::fabs(share) < ForceScale::limit)) {
        overflow_node_ = touch.node;
        return;
      }
      const auto quanta = static_cast<std::int64_t>(std::llrint(share));
      sums[4 * facet_nodes[k] + d] -= quanta;
      sum += quanta;
    }
    if (touch.second >= 0) {
      const auto quanta = static_cast<std::int64_t>(std::llrint(static_cast<double>(sum) * touch.second_weight));
      sums[4 * touch.second + d] += quanta;
      sum -= quanta;
    }
    sums[4 * touch.node + d] += sum;
  }
}

void add_shares(const ContactView& view, const ContactTouches& touches, const MassSplit& split) {
  for (const ContactTouch& t : touches.touches()) {
    const std::int64_t share = share_of(view, t, split.quantum);
    const std::int64_t of_second = t.second >= 0 ? share_of_corner(share, t.second_weight) : 0;
    split.shares[t.node] += share - of_second;
    if (t.second >= 0) split.shares[t.second] += of_second;
    for (int k = 0; k < 4; ++k) split.shares[corners_of(view, t)[k]] += share_of_corner(share, t.weights[k]);
  }
}

Impacts::Impacts(const ContactView& view, const ContactTouches& touches, const ContactResponse& response,
                 const MassSplit& split)
    : view_(view), response_(response), split_(split) {
  impacts_.reserve(touches.touches().size());
  for (const ContactTouch& t : touches.touches()) {
    const double closing = -dot(relative_velocity(view, t, view.velocity), t.direction);
    const double mass = effective_mass(view, t, split, t.direction);
    if (!std::isfinite(mass)) continue;  // nothing moves
    impacts_.push_back({.touch = &t, .mass = mass, .wanted = wanted_speed(t, response, closing, mass, view.dt)});
  }
}

/// Coulomb friction of a touch: what would stop the sliding, as far as the push allows [N s].
Vec3 Impacts::friction(const Impact& impact, const ContactTouch& touch, Vec3 sliding) const {
  const double speed = norm(sliding);
  Vec3 grip = impact.grip;
  if (speed > 0.0) grip = grip - sliding * effective_mass(view_, touch, split_, sliding * (1.0 / speed));
  const double most = response_.friction * impact.push, size = norm(grip);
  return size > most ? grip * (most / size) : grip;
}

void Impacts::add_round(const double* velocity, ContactForces& forces) {
  for (Impact& i : impacts_) {
    const ContactTouch& t = *i.touch;
    const Vec3 v = relative_velocity(view_, t, velocity);
    const double closing = -dot(v, t.direction), before = i.push;
    i.push = max_of(i.push + i.mass * (closing - i.wanted), 0.0);
    const double per_impulse = 1.0 / view_.kick_dt;
    forces.add(t, corners_of(view_, t), t.direction * ((i.push - before) * per_impulse));
    if (!(response_.friction > 0.0)) continue;
    const Vec3 grip = friction(i, t, v + t.direction * closing);
    forces.add_friction(t, corners_of(view_, t), (grip - i.grip) * per_impulse);
    i.grip = grip;
  }
}

}  // namespace kerf
