// The kick and drift of all nodes, and the books of what constrains and loads them.
#include "dynamics/integrator.hpp"

#include <algorithm>
#include <cmath>

#include "core/fixed_sum.hpp"
#include "model/prediction.hpp"

namespace kerf {

namespace {

/// v += F/m dt; x += v dt; F = 0, for all nodes. `look(i, old velocity, new velocity, old, new position)` sees each.
template <class Look>
void advance_nodes(NodeStore& nodes, double quantum, double kick_dt, double dt, const Look& look) {
  const int n = nodes.n();
  auto* x = reinterpret_cast<Quad*>(nodes.position.data());
  auto* v = reinterpret_cast<Quad*>(nodes.velocity.data());
  auto* f = reinterpret_cast<QuadInt*>(nodes.force.data());
  const double* inverse_mass = nodes.inverse_mass.data();
  const double factor = quantum * kick_dt;
  for (int i = 0; i < n; ++i) {
    const Quad before = v[i], from = x[i];
    const Quad after = before + __builtin_convertvector(f[i], Quad) * (inverse_mass[i] * factor);
    const Quad to = from + after * dt;
    v[i] = after;
    x[i] = to;
    f[i] = QuadInt{};
    look(i, before, after, from, to);
  }
  for (int i = n; i < n + NodeStore::n_dummies; ++i) f[i] = QuadInt{};
}

/// What a force [force quanta] does in a kick [N s].
Vec3 impulse_of(const Model& model, const std::int64_t* force, double kick_dt) {
  const double q = model.quanta.force.quantum * kick_dt;
  return {static_cast<double>(force[0]) * q, static_cast<double>(force[1]) * q, static_cast<double>(force[2]) * q};
}

/// Work that contact takes from the nodes: minus force times mean velocity.
std::int64_t contact_work(const Model& model, const Ledger& ledger, const std::int64_t* force, double kick_dt,
                          Vec3 mean) {
  return -ledger.energy_quanta(model, dot(impulse_of(model, force, kick_dt), mean));
}

void save_velocities(const NodeStore& nodes, const std::vector<std::int32_t>& which, std::vector<double>& saved) {
  saved.clear();
  for (const std::int32_t n : which)
    saved.insert(saved.end(), {nodes.velocity[4 * n], nodes.velocity[4 * n + 1], nodes.velocity[4 * n + 2]});
}

/// Of a node before and after the kick [m/s].
Vec3 mean_velocity(const NodeStore& nodes, std::int32_t node, const double* before) {
  return (Vec3{before[0], before[1], before[2]} + nodes.v(node)) * 0.5;
}

}  // namespace

/// Pre: the node stands where the step began.
void Integrator::count(const Model& model, const Step& step, const std::vector<HalfSpace>& planes, const Passage& p,
                       Ledger& ledger) const {
  if (!model.nodes.owned[p.node]) return;
  const double mass = model.nodes.mass[p.node];
  const Vec3 impulse = (p.after - p.free_flight) * mass;
  for (int d = 0; d < 3; ++d) ledger.accounts.impulse[d] += ledger.momentum_quanta(impulse[d]);
  ledger.accounts.external += ledger.energy_quanta(model, 0.5 * dot(impulse, p.after + p.before));
  if (books_ == nullptr) return;
  std::vector<Vec3> left(model.input->boundaries.size());
  constraints_.constrain(model, p.node, step, planes, p.before, p.free_flight, left.data());
  Vec3 from = p.free_flight;
  for (std::size_t b = 0; b < left.size(); from = left[b++])
    books_->count_reaction(ledger, model, b, mass, from, left[b], p.before, p.after);
}

/// The pass over all nodes where some are asked only if their free flight ends where a condition acts.
void Integrator::advance_guarded(Model& model, const Step& step, const std::vector<HalfSpace>& planes, Ledger& ledger) {
  NodeStore& nodes = model.nodes;
  struct Hit {
    int node;
    Vec3 before, free_flight, from;
  };
  std::vector<Hit> hits;
  const auto& constrained = constraints_.constrained();
  advance_nodes(nodes, model.quanta.force.quantum, step.kick_dt(), step.dt,
                [&](int i, Quad before, Quad after, Quad from, Quad to) {
                  if (!constraints_.has_near(i) || !constraints_.ends_in_region(i, planes, vector_of(to))) return;
                  hits.push_back({i, vector_of(before), vector_of(after), vector_of(from)});
                });
  std::size_t next = 0;  // constrained nodes are computed before the pass, with all their conditions
  for (const Hit& h : hits) {
    while (next < constrained.size() && constrained[next] < h.node) ++next;
    if (next < constrained.size() && constrained[next] == h.node) continue;
    nodes.set_x(h.node, h.from);
    const Vec3 v = constraints_.constrain(model, h.node, step, planes, h.before, h.free_flight);
    count(model, step, planes, {h.node, h.before, h.free_flight, v}, ledger);
    nodes.set_v(h.node, v);
    nodes.set_x(h.node, h.from + v * step.dt);
  }
}

/// After the kick: the work of contact and loads, and the impulse of loads.
void Integrator::count_shares(const Model& model, const Step& step, const ForceShares& shares, Ledger& ledger) const {
  const auto& [contact, external] = shares;
  for (std::size_t k = 0; k < contact.nodes.size(); ++k) {
    const Vec3 mean = mean_velocity(model.nodes, contact.nodes[k], &old_contact_velocity_[3 * k]);
    ledger.accounts.contact += contact_work(model, ledger, &contact.force[4 * k], step.kick_dt(), mean);
    ledger.accounts.friction += contact_work(model, ledger, &contact.friction[4 * k], step.kick_dt(), mean);
  }
  for (std::size_t k = 0; k < external.nodes.size(); ++k) {
    if (!(model.nodes.mass[external.nodes[k]] > 0.0)) continue;  // dropped since the force was made
    const Vec3 impulse = impulse_of(model, &external.force[4 * k], step.kick_dt());
    const Vec3 mean = mean_velocity(model.nodes, external.nodes[k], &old_external_velocity_[3 * k]);
    for (int d = 0; d < 3; ++d) ledger.accounts.impulse[d] += ledger.momentum_quanta(impulse[d]);
    ledger.accounts.external += ledger.energy_quanta(model, dot(impulse, mean));
  }
}

void Integrator::kick_and_drift(Model& model, const Step& step, const ForceShares& shares, Ledger& ledger) {
  NodeStore& nodes = model.nodes;
  const double quantum = model.quanta.force.quantum, factor = quantum * step.kick_dt();
  // What must be known of the time before the kick: constrained velocities are found while positions still stand
  // at the start of the step.
  saved_.clear();
  const auto& constrained = constraints_.constrained();
  const std::vector<HalfSpace> planes = Constraints::regions(model, step);
  for (const std::int32_t c : constrained) {
    const Vec3 before = nodes.v(c), free_flight = vector_of(kicked(nodes, c, factor));
    const Vec3 v = constraints_.constrain(model, c, step, planes, before, free_flight);
    const Vec3 x = nodes.x(c);
    saved_.insert(saved_.end(), {v.x, v.y, v.z, x.x, x.y, x.z});
    count(model, step, planes, {c, before, free_flight, v}, ledger);
  }
  save_velocities(nodes, shares.contact.nodes, old_contact_velocity_);
  save_velocities(nodes, shares.external.nodes, old_external_velocity_);

  if (constraints_.none())
    advance_nodes(nodes, quantum, step.kick_dt(), step.dt, [](int, Quad, Quad, Quad, Quad) {});
  else
    advance_guarded(model, step, planes, ledger);

  for (std::size_t k = 0; k < constrained.size(); ++k) {
    const double* s = &saved_[6 * k];
    const Vec3 v{s[0], s[1], s[2]};
    nodes.set_v(constrained[k], v);
    nodes.set_x(constrained[k], Vec3{s[3], s[4], s[5]} + v * step.dt);
  }
  count_shares(model, step, shares, ledger);
}

Integrator::Outlook Integrator::look_ahead(const Model& model, const Step& next, const Ledger& ledger) const {
  const NodeStore& nodes = model.nodes;
  const double factor = model.quanta.force.quantum * next.kick_dt();
  // The share of the coming kick that lies before the present time. Kinetic energy and work grow by its power at the
  // velocity before it: what the rest of the kick will do (a wall that is hit, a motion that stops) stays out.
  const double share = next.last_dt / (next.last_dt + next.dt);
  const auto n = static_cast<std::size_t>(nodes.n());
  // Entries of ghosts stay zero: only the owner of a node counts it.
  Outlook out;
  for (auto* list : {&out.kinetic, &out.momentum[0], &out.momentum[1], &out.momentum[2]}) list->resize(n);
  const auto enter = [&](std::size_t i, Vec3 v, Vec3 w) {
    const double mass = nodes.owned[i] != 0 ? nodes.mass[i] : 0.0;
    out.kinetic[i] = mass * (0.5 * dot(v, v) + share * dot(v, w - v));
    for (int d = 0; d < 3; ++d) out.momentum[d][i] = mass * v[d];
  };
  for (std::size_t i = 0; i < n; ++i)
    enter(i, nodes.v(static_cast<int>(i)), vector_of(kicked(nodes, static_cast<int>(i), factor)));
  const std::vector<HalfSpace> planes = Constraints::regions(model, next);
  const auto apply = [&](int i) {
    const Vec3 before = nodes.v(i), free_flight = vector_of(kicked(nodes, i, factor));
    const Vec3 v = constraints_.constrain(model, i, next, planes, before, free_flight);
    enter(static_cast<std::size_t>(i), before, v);
    if (nodes.owned[i]) out.external += ledger.energy_quanta(model, nodes.mass[i] * dot(v - free_flight, before));
  };
  const int n_asked = constraints_.none() ? 0 : nodes.n();
  for (int i = 0; i < n_asked; ++i)
    if (constraints_.has_always(i) || constraints_.has_near(i)) apply(i);
  return out;
}

Balance Integrator::sample(const Model& model, const Step& next, const ForceShares& shares,
                           const Ledger& ledger) const {
  const NodeStore& nodes = model.nodes;
  const double share = next.last_dt / (next.last_dt + next.dt);
  const Outlook outlook = look_ahead(model, next, ledger);
  std::int64_t contact = 0, friction = 0, external = outlook.external;
  const ContactLoad& load = shares.contact;
  for (std::size_t k = 0; k < load.nodes.size(); ++k) {
    contact += contact_work(model, ledger, &load.force[4 * k], next.kick_dt(), nodes.v(load.nodes[k]));
    friction += contact_work(model, ledger, &load.friction[4 * k], next.kick_dt(), nodes.v(load.nodes[k]));
  }
  for (std::size_t k = 0; k < shares.external.nodes.size(); ++k) {
    const Vec3 impulse = impulse_of(model, &shares.external.force[4 * k], next.kick_dt());
    external += ledger.energy_quanta(model, dot(impulse, nodes.v(shares.external.nodes[k])));
  }
  std::int64_t sums[6] = {
      ledger.accounts.external, ledger.accounts.contact, ledger.accounts.friction, external, contact, friction};
  MPI_Allreduce(MPI_IN_PLACE, sums, 6, MPI_INT64_T, MPI_SUM, model.comm);
  const std::vector<double> totals =
      order_free_sums(model.comm, {outlook.kinetic, outlook.momentum[0], outlook.momentum[1], outlook.momentum[2]});
  Balance b;
  b.time = next.start;
  b.kinetic = totals[0];
  b.momentum = {totals[1], totals[2], totals[3]};
  const auto joule = [&](int k) {
    return (static_cast<double>(sums[k]) + share * static_cast<double>(sums[3 + k])) * model.quanta.energy;
  };
  b.external = joule(0);
  b.contact = joule(1);
  b.friction = joule(2);
  ledger.close(model, b);
  return b;
}

}  // namespace kerf
