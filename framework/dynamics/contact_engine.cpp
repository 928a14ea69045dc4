// Search, distribution and force exchange of one contact definition.
#include "dynamics/contact_engine.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "dynamics/element_loop.hpp"
#include "dynamics/setup.hpp"
#include "parallel/communicator.hpp"

namespace kerf {

ContactEngine::ContactEngine(const Model& model, const Contact& law, std::unique_ptr<SpatialDecomposition> space)
    : law_(law),
      request_(law.request()),
      slaves_(model, request_.slaves),
      masters_(model, request_.masters),
      space_(std::move(space)) {
  for (const auto& boundary : model.input->boundaries) mirrored_.emplace_back(model, boundary->nodes());
}

/// Takes out facets on planes of symmetry: the body goes on behind them.
void ContactEngine::drop_mirrored(const Model& model, std::vector<ExteriorFacet>& facets) const {
  if (mirrored_.empty()) return;
  const NodeStore& nodes = model.nodes;
  std::erase_if(facets, [&](const ExteriorFacet& f) {
    std::int32_t node[4];
    std::uint64_t sets[4];
    for (int k = 0; k < 4; ++k) {
      node[k] = model.parts[f.part].store->node(f.slot, hex_face[f.face][k]);
      sets[k] = nodes.sets[node[k]];
    }
    for (std::size_t b = 0; b < mirrored_.size(); ++b) {
      if (!mirrored_[b].holds_facet(f.part, sets)) continue;
      // By the undeformed position, which does not depend on when the question is asked; for most facets, the first
      // corner's settles it.
      const auto on_plane = [&](std::int32_t n) {
        return model.input->boundaries[b]->mirrors(reference_position(model, nodes.id[n]));
      };
      if (std::all_of(node, node + 4, on_plane)) return true;
    }
    return false;
  });
}

/// How far a node may move until the next search, relative to all parts and to its own, from where it is now.
void ContactEngine::track(const Model& model, int node, double time) {
  const Vec3 v = model.nodes.v(node);
  // Bounded: one racing node must not make boxes that hold the whole model. It will call for a search sooner.
  const double most = 0.25 * model.dummy_edge;  // four of the longest edges of the undeformed mesh
  allowance_[node] = std::min(1.25 * norm(v - drift_velocity_) * horizon_ + slack_, most);
  own_allowance_[node] = std::min(1.25 * norm(v - part_velocities_[model.nodes.part[node]]) * horizon_ + slack_, most);
  reference_[node] = model.nodes.x(node);
  reference_time_[node] = time;
}

Vec3 ContactEngine::reference(int node, Vec3 motion) const {
  return reference_[node] - motion * (reference_time_[node] - search_time_);
}

/// A node may move by its allowance before the candidates become incomplete. Positions have been advanced already.
bool ContactEngine::moved_too_far(const Model& model, const Step& step) const {
  const double* x = model.nodes.position.data();
  for (const Tracked& t : tracked_) {
    const double* p = x + 4 * static_cast<std::int64_t>(t.node);
    const Vec3 moved = Vec3{p[0], p[1], p[2]} - Vec3{t.position[0], t.position[1], t.position[2]};
    const double since = step.end() - t.time;
    const Vec3 away = moved - drift_velocity_ * since, within = moved - part_velocities_[t.part] * since;
    if (!(dot(away, away) <= t.allowance * t.allowance) || !(dot(within, within) <= t.own_allowance * t.own_allowance))
      return true;
  }
  return false;
}

std::vector<char> ContactEngine::mark_exterior(const Model& model, const std::vector<ExteriorFacet>& facets) const {
  std::vector<char> mark(static_cast<std::size_t>(model.nodes.n()), 0);
  for (const ExteriorFacet& f : facets)
    for (const int corner : hex_face[f.face]) mark[model.parts[f.part].store->node(f.slot, corner)] = 1;
  if (!model.ghost_plan) return mark;
  std::vector<std::int64_t> count(mark.begin(), mark.end());
  sum_over_copies(model, count.data(), 1);
  for (std::size_t i = 0; i < mark.size(); ++i) mark[i] = count[i] != 0 ? 1 : 0;
  return mark;
}

/// Tracks a node and, if this rank owns it and it plays a role, makes it a slave.
void ContactEngine::collect_slave(const Model& model, int i, double time, std::vector<ContactNodeRecord>& records) {
  const NodeStore& nodes = model.nodes;
  track(model, i, time);
  if (!nodes.owned[i]) return;
  const bool slave = slaves_.holds(nodes, i), master = masters_.holds(nodes, i);
  if (!slave && !master) return;
  const Vec3 x = nodes.x(i);
  tracked_.push_back({i, {x.x, x.y, x.z}, time, own_allowance_[i], allowance_[i], nodes.part[i]});
  ContactNodeRecord r;
  r.role = (slave ? 1u : 0u) | (master && request_.symmetric ? 2u : 0u);
  if (r.role == 0) return;
  r.id = nodes.id[i];
  const Vec3 all = reference(i, drift_velocity_), own = reference(i, part_velocities_[nodes.part[i]]);
  for (int d = 0; d < 3; ++d) {
    r.position[d] = all[d];
    r.own_position[d] = own[d];
  }
  r.allowance = allowance_[i];
  r.own_allowance = own_allowance_[i];
  r.local = i;
  r.part = nodes.part[i];
  r.owner = model.rank();
  records.push_back(r);
}

std::vector<ContactFacetRecord> ContactEngine::collect_facets(const Model& model,
                                                              const std::vector<ExteriorFacet>& facets) const {
  const NodeStore& nodes = model.nodes;
  std::vector<ContactFacetRecord> records;
  records.reserve(facets.size());
  for (const ExteriorFacet& f : facets) {
    const PartModel& part = model.parts[f.part];
    ContactFacetRecord r;
    std::uint64_t sets[4];
    Vec3 x[4], all[4], own[4];
    for (int k = 0; k < 4; ++k) {
      const std::int32_t n = part.store->node(f.slot, hex_face[f.face][k]);
      all[k] = reference(n, drift_velocity_);
      own[k] = reference(n, part_velocities_[f.part]);
      r.nodes[k] = nodes.id[n];
      r.owners[k] = model.node_owner[n];
      sets[k] = nodes.sets[n];
      x[k] = nodes.x(n);
      r.locals[k] = n;
      r.allowance = std::max(r.allowance, allowance_[n]);
      r.own_allowance = std::max(r.own_allowance, own_allowance_[n]);
    }
    for (int k = 0; k < 4; ++k) r.opposite[k] = nodes.id[part.store->node(f.slot, hex_face[opposite_face[f.face]][k])];
    const bool master = masters_.holds_facet(f.part, sets), slave = slaves_.holds_facet(f.part, sets);
    r.role = (master ? 1u : 0u) | (slave && request_.symmetric ? 2u : 0u);
    if (r.role == 0) continue;
    r.id = part.store->id(f.slot) * 8 + f.face;
    r.part = f.part;
    r.bulk_modulus = part.bulk_modulus;
    r.volume = part.store->field(PartStore::mass).at(f.slot, 0) / part.material->density;
    double longest = 0.0;
    for (int k = 0; k < 4; ++k) longest = std::max(longest, norm(x[(k + 1) % 4] - x[k]));
    const double area = 0.5 * norm(cross(x[2] - x[0], x[3] - x[1]));
    // Until the next search the facet may grow by what its corners may move.
    const double reach =
        law_.reach(longest + 2.0 * std::min(r.allowance, r.own_allowance), r.volume / std::max(area, 1e-300));
    for (int d = 0; d < 3; ++d) {
      r.low[d] = std::min({all[0][d], all[1][d], all[2][d], all[3][d]}) - reach;
      r.high[d] = std::max({all[0][d], all[1][d], all[2][d], all[3][d]}) + reach;
      r.own_low[d] = std::min({own[0][d], own[1][d], own[2][d], own[3][d]}) - reach;
      r.own_high[d] = std::max({own[0][d], own[1][d], own[2][d], own[3][d]}) + reach;
    }
    records.push_back(r);
  }
  return records;
}

/// Sends every slave to the rank whose box holds it and every facet to all ranks that it may reach.
void ContactEngine::distribute(const Model& model, std::vector<ContactNodeRecord>& slaves,
                               std::vector<ContactFacetRecord>& facets) {
  const auto n_ranks = static_cast<std::size_t>(model.n_ranks());
  std::vector<std::vector<ContactNodeRecord>> nodes_out(n_ranks);
  const auto share = [&] {
    for (auto& list : nodes_out) list.clear();
    for (const ContactNodeRecord& s : slaves)
      nodes_out[space_->owner({s.position[0], s.position[1], s.position[2]})].push_back(s);
  };
  const auto uneven = [&] {
    std::vector<std::int64_t> counts(n_ranks);
    for (std::size_t r = 0; r < n_ranks; ++r) counts[r] = static_cast<std::int64_t>(nodes_out[r].size());
    MPI_Allreduce(MPI_IN_PLACE, counts.data(), static_cast<int>(n_ranks), MPI_INT64_T, MPI_SUM, model.comm);
    std::int64_t total = 0, most = 0;
    for (const std::int64_t c : counts) {
      total += c;
      most = std::max(most, c);
    }
    return most * static_cast<std::int64_t>(n_ranks) * 4 > total * 5;
  };
  if (space_built_) share();
  if (!space_built_ || uneven()) {
    std::vector<double> coordinates, weights(slaves.size(), 1.0);
    for (const ContactNodeRecord& s : slaves) coordinates.insert(coordinates.end(), s.position, s.position + 3);
    space_->build(model.comm, coordinates, weights);
    space_built_ = true;
    share();
  }
  slave_reach_ = 1.5 * reach_of(model, slaves);  // leaves some for slaves that join before the next search
  send(model, slaves, facets);
}

/// How far slaves reach out of their box: their allowance, from either of their two positions. Collective.
double ContactEngine::reach_of(const Model& model, const std::vector<ContactNodeRecord>& slaves) const {
  double reach = 0.0;
  for (const ContactNodeRecord& s : slaves) {
    double apart = 0.0;
    for (int d = 0; d < 3; ++d) apart += std::fabs(s.position[d] - s.own_position[d]);
    reach = std::max({reach, s.allowance, s.own_allowance + apart});
  }
  return greatest(model.comm, reach);
}

/// Replaces the records that this rank made by those that concern its box of space.
void ContactEngine::send(const Model& model, std::vector<ContactNodeRecord>& slaves,
                         std::vector<ContactFacetRecord>& facets) {
  const auto n_ranks = static_cast<std::size_t>(model.n_ranks());
  std::vector<std::vector<ContactNodeRecord>> nodes_out(n_ranks);
  for (const ContactNodeRecord& s : slaves)
    nodes_out[space_->owner({s.position[0], s.position[1], s.position[2]})].push_back(s);
  std::vector<std::vector<ContactFacetRecord>> facets_out(n_ranks);
  std::vector<int> ranks;
  for (const ContactFacetRecord& f : facets) {
    const double inflate = slave_reach_ + std::max(f.allowance, f.own_allowance);
    Vec3 low, high;
    for (int d = 0; d < 3; ++d) {
      low[d] = std::min(f.low[d], f.own_low[d]) - inflate;
      high[d] = std::max(f.high[d], f.own_high[d]) + inflate;
    }
    space_->owners(low, high, ranks);
    for (const int r : ranks) facets_out[r].push_back(f);
  }
  slaves.clear();
  facets.clear();
  for (const auto& list : all_to_all(model.comm, nodes_out)) slaves.insert(slaves.end(), list.begin(), list.end());
  for (const auto& list : all_to_all(model.comm, facets_out)) facets.insert(facets.end(), list.begin(), list.end());
}

void ContactEngine::connect(const Model& model) {
  const std::size_t n = found_.node_id.size();
  position_.assign(4 * n, 0.0);
  velocity_.assign(4 * n, 0.0);
  mass_.assign(n, 0.0);
  force_.assign(4 * n, 0);
  load_ = {};
  local_.clear();
  plan_.reset();
  if (model.n_ranks() == 1) {
    local_ = found_.node_local;
    for (std::size_t i = 0; i < n; ++i) mass_[i] = model.nodes.mass[local_[i]];
    load_.nodes = local_;
  } else {
    std::vector<Needed> needed(n);
    for (std::size_t i = 0; i < n; ++i) needed[i] = {found_.node_id[i], found_.node_owner[i]};
    plan_ = std::make_unique<ExchangePlan>(model.comm, needed, [&](std::int64_t id) { return model.local_node(id); });
    plan_->pull(model.nodes.mass.data(), 1, mass_.data(), 1, 1);
    load_.nodes = plan_->sources();
    owned_force_.assign(4 * static_cast<std::size_t>(model.nodes.n()), 0);
  }
  load_.force.assign(4 * load_.nodes.size(), 0);
}

/// Mean velocity of the exterior nodes of all parts and of each. Only the size of the allowances depends on it.
void ContactEngine::choose_references(const Model& model, const std::vector<char>& exterior) {
  const std::size_t n = model.parts.size() + 1;
  std::vector<double> sums(4 * n, 0.0);
  for (int i = 0; i < model.nodes.n(); ++i) {
    if (exterior[i] == 0 || !model.nodes.owned[i]) continue;
    const Vec3 v = model.nodes.v(i);
    for (const std::size_t at : {std::size_t{0}, static_cast<std::size_t>(model.nodes.part[i]) + 1}) {
      for (int d = 0; d < 3; ++d) sums[4 * at + d] += v[d];
      sums[4 * at + 3] += 1.0;
    }
  }
  // On rank 0 and back, because all ranks must use the same bits.
  std::vector<double> totals(sums.size());
  MPI_Reduce(sums.data(), totals.data(), static_cast<int>(sums.size()), MPI_DOUBLE, MPI_SUM, 0, model.comm);
  MPI_Bcast(totals.data(), static_cast<int>(totals.size()), MPI_DOUBLE, 0, model.comm);
  part_velocities_.assign(model.parts.size(), {});
  for (std::size_t at = 0; at < n; ++at)
    for (int d = 0; d < 3; ++d) {
      const double mean = totals[4 * at + 3] > 0.0 ? totals[4 * at + d] / totals[4 * at + 3] : 0.0;
      (at == 0 ? drift_velocity_ : part_velocities_[at - 1])[d] = mean;
    }
}

void ContactEngine::search(Model& model, const Step& step) {
  std::vector<ExteriorFacet> exterior = model.surface.exterior(model);
  drop_mirrored(model, exterior);
  const std::vector<char> mark = mark_exterior(model, exterior);
  choose_references(model, mark);
  horizon_ = static_cast<double>(law_.search_interval + 1) * step.dt;
  slack_ = 0.002 * model.dummy_edge;  // about 3 % of the longest edge
  search_time_ = step.end();
  last_search_ = step.cycle;
  valid_ = true;

  const auto n_nodes = static_cast<std::size_t>(model.nodes.n());
  allowance_.resize(n_nodes);
  own_allowance_.resize(n_nodes);
  reference_.resize(n_nodes);
  reference_time_.assign(n_nodes, -1.0);
  tracked_.clear();
  std::vector<ContactNodeRecord> slaves;
  for (int i = 0; i < model.nodes.n(); ++i)
    if (mark[i] != 0 || takes_free(model, i)) collect_slave(model, i, search_time_, slaves);
  std::vector<ContactFacetRecord> facets = collect_facets(model, exterior);
  if (model.n_ranks() > 1) distribute(model, slaves, facets);
  search_ = std::make_unique<CandidateSearch>(std::move(slaves), std::move(facets), request_.same_part);
  found_ = search_->candidates();
  connect(model);
}

bool ContactEngine::takes_free(const Model& model, int node) const {
  return request_.free_nodes && model.nodes.free[node] != 0 && model.nodes.mass[node] > 0.0;
}

void ContactEngine::surface_changed(const Model& model, double time, const std::vector<std::int64_t>& dead_elements,
                                    std::vector<ExteriorFacet> opened, const std::vector<std::int32_t>& nodes) {
  // Nodes that leave contact are left to a search.
  if (!request_.free_nodes || model.input->checks.free_nodes != "keep") valid_ = false;
  if (!valid_) return;
  drop_mirrored(model, opened);
  // Nodes that join, on all ranks that have a copy.
  std::vector<std::int64_t> joins(static_cast<std::size_t>(model.nodes.n()) + NodeStore::n_dummies, 0);
  for (const ExteriorFacet& f : opened)
    for (const int corner : hex_face[f.face]) joins[model.parts[f.part].store->node(f.slot, corner)] = 1;
  for (const std::int32_t n : nodes)
    if (takes_free(model, n)) joins[n] = 1;
  sum_over_copies(model, joins.data(), 1);
  std::vector<ContactNodeRecord> slaves;
  for (int i = 0; i < model.nodes.n(); ++i)
    if (joins[i] != 0 && reference_time_[i] < 0.0) collect_slave(model, i, time, slaves);
  std::vector<ContactFacetRecord> facets = collect_facets(model, opened);
  std::vector<std::int64_t> dead = dead_elements;
  if (model.n_ranks() > 1) {
    // Facets of the search went as far as the slaves of the search could reach: one that reaches farther needs another.
    const double reach = slave_reach_;
    if (reach_of(model, slaves) > reach) {
      valid_ = false;
      return;
    }
    send(model, slaves, facets);
    std::vector<std::vector<std::int64_t>> to_all(static_cast<std::size_t>(model.n_ranks()), dead_elements);
    dead.clear();
    for (const auto& list : all_to_all(model.comm, to_all)) dead.insert(dead.end(), list.begin(), list.end());
  }
  search_->change(dead, facets, slaves);
  found_ = search_->candidates();
  connect(model);
}

void ContactEngine::pull(const Model& model) {
  if (plan_) {
    plan_->pull(model.nodes.position.data(), 4, position_.data(), 4, 3);
    plan_->pull(model.nodes.velocity.data(), 4, velocity_.data(), 4, 3);
    return;
  }
  for (std::size_t i = 0; i < local_.size(); ++i)
    for (int d = 0; d < 4; ++d) {
      position_[4 * i + d] = model.nodes.position[4 * static_cast<std::size_t>(local_[i]) + d];
      velocity_[4 * i + d] = model.nodes.velocity[4 * static_cast<std::size_t>(local_[i]) + d];
    }
}

void ContactEngine::push(Model& model) {
  const std::int64_t* totals = force_.data();
  if (plan_) {
    for (const std::int32_t n : load_.nodes) std::fill_n(&owned_force_[4 * static_cast<std::size_t>(n)], 4, 0);
    plan_->push_add(force_.data(), 4, owned_force_.data(), 4, 3);
    totals = owned_force_.data();
  }
  for (std::size_t k = 0; k < load_.nodes.size(); ++k) {
    const auto n = static_cast<std::size_t>(load_.nodes[k]);
    const std::size_t from = plan_ ? 4 * n : 4 * k;
    for (int d = 0; d < 3; ++d) {
      load_.force[4 * k + d] = totals[from + d];
      model.nodes.force[4 * n + d] += totals[from + d];
    }
  }
}

ContactView ContactEngine::view(double dt) const {
  ContactView v;
  v.dt = dt;
  v.n_nodes = static_cast<int>(found_.node_id.size());
  v.node_id = found_.node_id.data();
  v.position = position_.data();
  v.velocity = velocity_.data();
  v.mass = mass_.data();
  v.node_part = found_.node_part.data();
  v.n_facets = static_cast<int>(found_.facet_id.size());
  v.facet_id = found_.facet_id.data();
  v.facet_nodes = found_.facet_nodes.data();
  v.facet_part = found_.facet_part.data();
  v.facet_bulk_modulus = found_.facet_bulk_modulus.data();
  v.facet_volume = found_.facet_volume.data();
  v.n_slaves = static_cast<int>(found_.slave.size());
  v.slave = found_.slave.data();
  v.first_candidate = found_.first_candidate.data();
  v.candidate = found_.candidate.data();
  v.first_around = found_.first_around.data();
  v.around = found_.around.data();
  return v;
}

void ContactEngine::add_forces(Model& model, const Step& step, Timers& timers) {
  {
    const auto scope = timers.measure("contact_search");
    const bool due = !valid_ || step.cycle - last_search_ >= law_.search_interval || moved_too_far(model, step);
    if (greatest(model.comm, std::int64_t{due ? 1 : 0}) != 0) search(model, step);
  }
  const auto scope = timers.measure("contact_forces");
  pull(model);
  std::fill(force_.begin(), force_.end(), 0);
  ContactForces forces(force_.data(), model.quanta.force);
  law_.add_forces(view(step.dt), forces);
  if (forces.overflow_node() >= 0)
    trouble_ = fmt::format("the contact force on node {} (part {}, rank {}) is not finite or beyond all bounds",
                           found_.node_id[forces.overflow_node()],
                           model.parts[found_.node_part[forces.overflow_node()]].input->name, model.rank());
  push(model);
}

std::vector<std::string> ContactEngine::initial_penetrations(Model& model) {
  Step none;
  search(model, none);
  valid_ = false;
  pull(model);
  std::vector<int> nodes;
  std::vector<double> depths;
  law_.penetrations(view(0.0), nodes, depths);
  struct Deepest {
    double depth;
    std::int64_t id;
    std::int64_t part;
  };
  std::vector<Deepest> local;
  for (std::size_t i = 0; i < nodes.size(); ++i)
    local.push_back({depths[i], found_.node_id[nodes[i]], found_.node_part[nodes[i]]});
  const std::vector<Deepest> all = gather_to_root(model.comm, local);
  std::string text;
  if (!all.empty()) {
    const auto worst = *std::max_element(all.begin(), all.end(), [](const Deepest& a, const Deepest& b) {
      return a.depth != b.depth ? a.depth < b.depth : a.id > b.id;
    });
    const Vec3 x = reference_position(model, worst.id);
    text = fmt::format(
        "{}: error: {} node{} lie{} inside another body at the start, the deepest by {:.4g} m: node {} of "
        "part {} at ({:.5g}, {:.5g}, {:.5g}) m; move the parts apart",
        law_.origin, all.size(), all.size() == 1 ? "" : "s", all.size() == 1 ? "s" : "", worst.depth, worst.id,
        model.parts[worst.part].input->name, x.x, x.y, x.z);
  }
  text = broadcast(model.comm, text);
  return text.empty() ? std::vector<std::string>{} : std::vector<std::string>{text};
}

}  // namespace kerf
