// The impact of one touch, and the split of masses between touches.
#include "contact/impacts.hpp"

#include <algorithm>
#include <cmath>

#include "kerf/contact_geometry.hpp"

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
    return split.shares(node) / (share * view.mass[node]) * view.mobility(node, along);
  };
  double inverse = part(t.node);
  if (t.second >= 0) inverse = (1.0 - t.second_weight) * inverse + t.second_weight * part(t.second);
  for (int k = 0; k < 4; ++k) inverse += t.weights[k] * part(n[k]);
  return 1.0 / inverse;
}

/// Whether the facet carries the node in some rounds: where the law says so, but not where boundary conditions hold any
/// of them, nor edges.
bool is_carried(const ContactView& view, const ContactTouch& t) {
  constexpr double all = 1.0 - 1e-9;  // of a mobility
  const std::int32_t* n = corners_of(view, t);
  bool move = t.carried && t.second < 0 && view.mobility(t.node, t.direction) > all;
  for (int k = 0; k < 4; ++k) move = move && view.mobility(n[k], t.direction) > all;
  return move;
}

/// Whether an impact moves what it should. Where boundary conditions hold all nodes along nearly all of the direction,
/// the mass is infinite or far beyond that of the nodes, and the nodes would race off along the axes that are left.
/// Then there is no impact, though its shares stay counted.
bool moves(const ContactView& view, const ContactTouch& t, double mass) {
  constexpr double most = 10.0;  // a free facet against a held node has up to 4: 1 / sum of w_k^2 / m_k
  const std::int32_t* n = corners_of(view, t);
  double greatest = view.mass[t.node];
  if (t.second >= 0) greatest = max_of(greatest, view.mass[t.second]);
  for (int k = 0; k < 4; ++k) greatest = max_of(greatest, view.mass[n[k]]);
  return mass <= most * greatest;
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
        note_overflow(touch.node);
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

double MassSplit::roles(int node) const {
  const std::int64_t* row = rows + width * static_cast<std::int64_t>(node);
  return static_cast<double>(std::max(row[1] + (row[2] > 0 ? 1 : 0), std::int64_t{1}));
}

void add_shares(const ContactView& view, const ContactTouches& touches, const MassSplit& split) {
  const auto row = [&split](int node) { return split.rows + MassSplit::width * static_cast<std::int64_t>(node); };
  for (const ContactTouch& t : touches.touches()) {
    const std::int64_t share = share_of(view, t, split.quantum);
    const std::int32_t* n = corners_of(view, t);
    const std::int64_t of_second = t.second >= 0 ? share_of_corner(share, t.second_weight) : 0;
    row(t.node)[0] += share - of_second;
    if (t.second >= 0) row(t.second)[0] += of_second;
    for (int k = 0; k < 4; ++k) row(n[k])[0] += share_of_corner(share, t.weights[k]);
    if (!is_carried(view, t)) continue;
    row(t.node)[1] += 1;
    for (int k = 0; k < 4; ++k)
      if (t.weights[k] > 0.0) row(n[k])[2] += 1;
  }
}

Impacts::Impacts(const ContactView& view, const ContactTouches& touches, const ContactResponse& response,
                 const MassSplit& split, const std::vector<std::int32_t>& active)
    : view_(view), response_(response), split_(split), active_(active) {
  impacts_.reserve(touches.touches().size());
  for (const ContactTouch& t : touches.touches()) {
    const double closing = -dot(relative_velocity(view, t, view.velocity), t.direction);
    const double mass = effective_mass(view, t, split, t.direction);
    if (!moves(view, t, mass)) continue;
    impacts_.push_back({.touch = &t,
                        .mass = mass,
                        .wanted = wanted_speed(t, response, closing, mass, view.dt),
                        .carried = is_carried(view, t)});
  }
}

ImpactEffort Impacts::add_to(ContactForces& forces, ImpactExchange& exchange, const ImpactPace& pace) {
  scale_ = forces.scale();
  first_excess_ = pace.first_excess;
  loads_.resize(4 * static_cast<std::size_t>(view_.n_nodes));
  ImpactEffort effort;
  for (int round = 0; round < pace.rounds; round += 3) {
    const double* velocity = exchange.velocities();
    if (load(velocity, forces, round == 0)) effort.rounds = round + 3;
    exchange.add_up(loads_);
    carry(velocity, forces);
    for (int k = 0; k < 2; ++k) add_round(exchange.velocities(), forces);
  }
  for (const Impact& i : impacts_) effort.first_excess = max_of(effort.first_excess, i.first_excess);
  return effort;
}

void ImpactTally::add(const ImpactPace& pace, const ImpactEffort& effort) {
  if (effort.first_excess > 0.0) ++steps;
  if (effort.rounds < pace.rounds) return;
  ++unsettled;
  if (pace.rounds >= Impacts::most_rounds) ++at_limit;
}

ImpactPace Impacts::next_pace(const ImpactPace& last, const ImpactEffort& effort) {
  // Whether the last three rounds were enough nobody has looked at. So there are three more than were needed, and many
  // more at once where the last look has still found too much.
  constexpr int more = 12;
  const int wanted = effort.rounds >= last.rounds ? last.rounds + more : static_cast<int>(effort.rounds) + 3;
  return {std::clamp(wanted, least_rounds, most_rounds), effort.first_excess};
}

/// Sums up what the corners of facets are to carry: of every touch that closes faster than it should, or has a push
/// that may be taken back, the mass and the momentum of the excess. Returns whether any touch has too much excess.
bool Impacts::load(const double* velocity, ContactForces& forces, bool first) {
  for (const std::int32_t node : active_) std::fill_n(&loads_[4 * static_cast<std::size_t>(node)], 4, 0);
  const double per_impulse = forces.scale().per_quantum / view_.kick_dt;
  bool too_much = false;
  for (Impact& i : impacts_) {
    const ContactTouch& t = *i.touch;
    const double mass = part_of_mass(t.node);
    i.excess = -dot(relative_velocity(view_, t, velocity), t.direction) - i.wanted;
    i.excess = mass > 0.0 ? max_of(i.excess, -i.push / mass) : 0.0;
    if (first) i.first_excess = max_of(i.excess, 0.0);
    too_much = too_much || i.excess > accuracy * max_of(i.first_excess, least_scale * first_excess_);
    if (!i.carried || i.excess == 0.0) continue;
    for (int k = 0; k < 4; ++k) {
      std::int64_t* row = &loads_[4 * static_cast<std::size_t>(corners_of(view_, t)[k])];
      const Vec3 momentum = t.direction * (-i.excess * mass * t.weights[k] * per_impulse);
      if (!(norm(momentum) < ForceScale::limit)) {
        forces.note_overflow(t.node);
        continue;
      }
      for (int d = 0; d < 3; ++d) row[d] += std::llrint(momentum[d]);
      row[3] += std::llrint(mass * t.weights[k] / split_.quantum);
    }
  }
  return too_much;
}

/// How much of the solution of a round with loads a touch may take. With the ratio r of load and own mass of a corner,
/// such a round multiplies what it does not solve by up to (1 + r/2)^2 / (1 + r) - 1, which is 1/8 for equal masses and
/// must stay below 1.
double Impacts::share_of_carrying(const ContactTouch& t) const {
  double r = 0.0;
  for (int k = 0; k < 4; ++k) {
    const std::int32_t corner = corners_of(view_, t)[k];
    if (!(t.weights[k] > 0.0)) continue;
    if (!(part_of_mass(corner) > 0.0)) return 0.0;
    r = max_of(r, load_of(corner) / part_of_mass(corner));
  }
  return min_of(1.0, greatest_factor * (1.0 + r) / ((1.0 + 0.5 * r) * (1.0 + 0.5 * r)));
}

/// Change of velocity that a corner gets from what it carries [m/s].
Vec3 Impacts::carried_along(int corner) const {
  const std::int64_t* row = &loads_[4 * static_cast<std::size_t>(corner)];
  const double mass = part_of_mass(corner) + load_of(corner);
  if (!(mass > 0.0)) return {};
  const double factor = view_.kick_dt * scale_.quantum / mass;
  const unsigned held = view_.held_axes(corner);
  Vec3 v;
  for (int d = 0; d < 3; ++d) v[d] = (held >> d & 1u) != 0 ? 0.0 : static_cast<double>(row[d]) * factor;
  return v;
}

/// One round in which facets carry nodes, given what their corners carry on all ranks. Edges are not carried: they get
/// half of their impact side by side.
void Impacts::carry(const double* velocity, ContactForces& forces) {
  for (Impact& i : impacts_) {
    const ContactTouch& t = *i.touch;
    if (t.second >= 0) hit(i, velocity, forces, 0.5);
    if (!i.carried || i.excess == 0.0) continue;
    Vec3 along;
    for (int k = 0; k < 4; ++k) along = along + carried_along(corners_of(view_, t)[k]) * t.weights[k];
    const double before = i.push;
    i.push = max_of(i.push + share_of_carrying(t) * part_of_mass(t.node) * (i.excess + dot(along, t.direction)), 0.0);
    forces.add(t, corners_of(view_, t), t.direction * ((i.push - before) / view_.kick_dt));
  }
}

/// Coulomb friction of a touch: what would stop the sliding, as far as the push allows [N s].
Vec3 Impacts::friction(const Impact& impact, const ContactTouch& touch, Vec3 sliding) const {
  const double speed = norm(sliding);
  Vec3 grip = impact.grip;
  if (speed > 0.0) {
    const double mass = effective_mass(view_, touch, split_, sliding * (1.0 / speed));
    if (moves(view_, touch, mass)) grip = grip - sliding * mass;
  }
  const double most = response_.friction * impact.push, size = norm(grip);
  return size > most ? grip * (most / size) : grip;
}

void Impacts::add_round(const double* velocity, ContactForces& forces) {
  for (Impact& i : impacts_) hit(i, velocity, forces, 1.0);
}

/// The given part of one impact, side by side with all others of its round.
void Impacts::hit(Impact& i, const double* velocity, ContactForces& forces, double part) const {
  const ContactTouch& t = *i.touch;
  const Vec3 v = relative_velocity(view_, t, velocity);
  const double closing = -dot(v, t.direction), before = i.push;
  i.push = max_of(i.push + part * i.mass * (closing - i.wanted), 0.0);
  const double per_impulse = 1.0 / view_.kick_dt;
  forces.add(t, corners_of(view_, t), t.direction * ((i.push - before) * per_impulse));
  if (!(response_.friction > 0.0)) return;
  const Vec3 grip = friction(i, t, (v + t.direction * closing) * part);
  forces.add_friction(t, corners_of(view_, t), (grip - i.grip) * per_impulse);
  i.grip = grip;
}

}  // namespace kerf
