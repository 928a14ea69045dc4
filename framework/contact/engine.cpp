// When a contact definition searches, and the exchange of its forces.
#include "contact/engine.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cstring>
#include <utility>

#include "kerf/collapsed_cell.hpp"
#include "kerf/shape.hpp"
#include "model/names.hpp"
#include "parallel/communicator.hpp"

namespace kerf {

ContactEngine::ContactEngine(const Model& model, const Contact& law, std::unique_ptr<SpatialDecomposition> space)
    : law_(law),
      request_(law.request()),
      slaves_(model, request_.slaves),
      masters_(model, request_.masters),
      space_(std::move(space)),
      channel_(model.comm) {
  for (const auto& boundary : model.input->boundaries) mirrored_.emplace_back(model, boundary->nodes());
  measure_sight(model);
}

double ContactSpeeds::fastest_pair() const {
  const Vec3 most_apart{most[0] + most[3], most[1] + most[4], most[2] + most[5]};
  return most[0] > -1e300 ? norm(most_apart) : 0.0;
}

/// The least sight of any face of any undeformed element. Collective.
void ContactEngine::measure_sight(const Model& model) {
  double least = beyond;
  for (const PartModel& part : model.parts)
    for (int s = 0; s < part.store->n_slots(); ++s) {
      if (!part.store->live(s)) continue;
      const Shape& shape = part.store->shape();
      std::int32_t node[Shape::most_nodes] = {};
      Vec3 x[Shape::most_nodes];
      for (int k = 0; k < shape.n_nodes; ++k) x[k] = model.nodes.x(node[k] = part.store->node(s, k));
      for (int f = 0; f < shape.n_faces; ++f) {
        const auto& face = shape.face[f];
        if (is_collapsed_face(std::array{node[face[0]], node[face[1]], node[face[2]], node[face[3]]})) continue;
        FacetBounds bounds;
        for (int k = 0; k < 4; ++k) bounds.edge = std::max(bounds.edge, norm(x[face[(k + 1) % 4]] - x[face[k]]));
        bounds.longest_edge = bounds.thickness = bounds.edge;
        least = std::min(least, law_.sight(bounds));
      }
    }
  least_sight_ = -greatest(model.comm, -least);
}

/// How fast the nodes that take part move, without the ones that have been dropped.
void ContactEngine::measure_speeds(const Model& model) {
  const bool first = prediction_ && !(prediction_->step().last_dt > 0.0);
  Quad low = Quad{} + 1e300, high = -low;
  for (const Tracked& t : tracked_) {
    if (!(model.nodes.mass[t.node] > 0.0)) continue;
    // Before the first step, pressures have not set anything in motion yet.
    const Quad v = first ? prediction_->velocity(t.node) : row_of(model.nodes.velocity.data(), t.node);
    low = v < low ? v : low;
    high = v > high ? v : high;
  }
  speeds_ = {};
  speeds_.longest_step = touches_.longest_step();
  for (int d = 0; d < 3; ++d) {
    speeds_.most[d] = -low[d];
    speeds_.most[3 + d] = high[d];
  }
}

void ContactEngine::renumbered(const Model& model) {
  invalidate();
  n_candidates_.clear();
  on_mirror_.assign(mirrored_.empty() ? 0 : static_cast<std::size_t>(model.nodes.n()), 0);
  // By the undeformed position, which does not depend on when the question is asked.
  mirrors_ = {};
  std::vector<std::int32_t> list;
  for (std::size_t i = 0; i < on_mirror_.size(); ++i) {
    const Vec3 x = model.nodes.reference_position(static_cast<int>(i));
    list.clear();
    for (std::size_t b = 0; b < mirrored_.size(); ++b)
      if (model.input->boundaries[b]->mirrors(x)) list.push_back(static_cast<std::int32_t>(b));
    if (!list.empty()) on_mirror_[i] = mirrors_.number(list);
  }
}

/// Tells owners how many candidates their slaves have. Collective.
void ContactEngine::count_candidates(const Model& model) {
  std::vector<std::int64_t> counts(found_->node_id.size(), 0);
  for (std::size_t k = 0; k < found_->slave.size(); ++k)
    counts[found_->slave[k]] = found_->candidates[k].end - found_->candidates[k].begin;
  n_candidates_.assign(static_cast<std::size_t>(model.nodes.n()), 0);
  channel_.add_to_owners(counts, n_candidates_);
}

/// Asks for the candidates, makes room for their nodes, and asks the owners for the ones that are new. Collective.
void ContactEngine::connect(const Model& model, bool fresh) {
  found_ = &search_->candidates();
  const std::size_t n = found_->node_id.size(), before = fresh ? 0 : mass_.size();
  if (fresh) {
    active_.clear();
    is_active_.clear();
  }
  position_.resize(4 * n);
  velocity_.resize(4 * n);
  pushed_velocity_.resize(4 * n);
  mass_.resize(n);
  for (auto* rows : {&force_, &friction_, &total_force_}) rows->resize(4 * n);
  share_.resize(MassSplit::width * n);
  channel_.request(*found_, before, [&model](std::int64_t id) { return model.local_node(id); });
}

void ContactEngine::search(Model& model, const Step& step) {
  outbox_.reset();
  in_outbox_.clear();  // all are made known anew
  std::vector<ExteriorFacet> exterior = model.surface.exterior(model.surface_mesh());
  drop_mirrored(model, exterior);
  const std::vector<std::int32_t> surface = surface_nodes(model, exterior);
  choose_frames(model, surface);
  slack_ = 0.002 * model.dummy_edge;  // about 3 % of the longest edge
  ++counts_.searches;
  last_search_ = last_renewal_ = step.cycle;
  valid_ = true;

  search_time_ = step.end();
  horizon_ = search_time_ + dt_ahead() + static_cast<double>(law_.search_interval + 1) * step.dt;
  track_of_.assign(static_cast<std::size_t>(model.nodes.n()), -1);
  tracked_.clear();
  own_boxes_.clear();
  home_.clear();
  undeformed_.clear();
  std::vector<ContactNodeRecord> slaves;
  slaves.reserve(surface.size());
  for (const std::int32_t i : surface)
    if (track(model, i, search_time_)) add_slave(model, tracked_.size() - 1, slaves);
  std::vector<ContactFacetRecord> facets = collect_facets(model, exterior);
  note_spread(facets);
  channel_.clear();
  if (model.n_ranks() > 1) distribute(model, slaves, facets);
  search_ = std::make_unique<CandidateSearch>(std::move(slaves), std::move(facets), request_.same_part,
                                              model.n_ranks() == 1 ? track_of_.size() : 0);
  connect(model, true);
  if (model.n_ranks() > 1) count_candidates(model);
}

/// Whether nodes without live elements take part at all.
bool ContactEngine::keeps_free(const Model& model) const {
  return request_.free_nodes && model.input->checks.free_nodes != "drop";
}

bool ContactEngine::takes_free(const Model& model, int node) const {
  return keeps_free(model) && model.nodes.free[node] != 0 && model.nodes.mass[node] > 0.0;
}

std::size_t ContactEngine::n_candidates() const {
  std::size_t n = 0;
  for (const ContactRow& row : found_->candidates) n += static_cast<std::size_t>(row.end - row.begin);
  return n;
}

Vec3 ContactEngine::predicted_v(const Model& model, int node) const {
  return prediction_ ? vector_of(prediction_->velocity(node)) : model.nodes.v(node);
}

Vec3 ContactEngine::predicted_x(const Model& model, int node) const {
  return prediction_ ? vector_of(prediction_->position(node)) : model.nodes.x(node);
}

double ContactEngine::dt_ahead() const { return prediction_ ? prediction_->step().dt : 0.0; }

void ContactEngine::pull(const Model& model) {
  const auto read = [&](std::int32_t node, double* row) {
    Prediction::Flight f{row_of(model.nodes.velocity.data(), node), row_of(model.nodes.position.data(), node)};
    if (prediction_) f = prediction_->flight(node);
    f.position[3] = f.held_axes;
    f.velocity[3] = model.nodes.mass[node];
    std::memcpy(row, &f.position, sizeof f.position);  // a message is not aligned like a vector
    std::memcpy(row + 4, &f.velocity, sizeof f.velocity);
  };
  channel_.pull_states(read, [this](std::int32_t i, const double* row) {
    std::copy_n(row, 4, &position_[4 * static_cast<std::size_t>(i)]);
    std::copy_n(row + 4, 4, &velocity_[4 * static_cast<std::size_t>(i)]);
    mass_[i] = row[7];
  });
}

/// Lists the nodes of all touches, and sums up what the touches of all ranks ask of the masses of nodes. Collective.
void ContactEngine::split_masses(const ContactView& view, double quantum) {
  list_active(view);
  for (const std::int32_t i : active_)
    std::fill_n(&share_[MassSplit::width * static_cast<std::size_t>(i)], MassSplit::width, 0);
  add_shares(view, touches_, {share_.data(), quantum});
  channel_.activate(active_, share_);
}

/// Sets active_ to the nodes of the present touches, each once.
void ContactEngine::list_active(const ContactView& view) {
  is_active_.resize(static_cast<std::size_t>(view.n_nodes), 0);
  for (const std::int32_t i : active_) is_active_[i] = 0;
  active_.clear();
  const auto join = [this](std::int32_t i) {
    if (is_active_[i] != 0) return;
    is_active_[i] = 1;
    active_.push_back(i);
  };
  for (const ContactTouch& t : touches_.touches()) {
    join(t.node);
    if (t.second >= 0) join(t.second);
    for (int k = 0; k < 4; ++k) join(view.facet_nodes[4 * static_cast<std::size_t>(t.facet) + k]);
  }
}

/// Sets pushed_velocity_ to what the forces so far lead to. Collective.
void ContactEngine::push_velocities(const Model& model) {
  channel_.sum(force_.data(), total_force_.data(), 4, 3);
  const double factor = model.quanta.force.quantum * prediction_->step().kick_dt();
  for (const std::int32_t active : active_) {
    const auto i = static_cast<std::size_t>(active);
    const std::int64_t* f = &total_force_[4 * i];
    if ((f[0] | f[1] | f[2]) == 0) {
      std::copy_n(&velocity_[4 * i], 3, &pushed_velocity_[4 * i]);  // what an earlier round pushed may be released
      continue;
    }
    const auto held = static_cast<unsigned>(position_[4 * i + 3]);
    const double a = factor / mass_[i];
    for (int d = 0; d < 3; ++d)
      if ((held >> d & 1u) == 0) pushed_velocity_[4 * i + d] = velocity_[4 * i + d] + static_cast<double>(f[d]) * a;
  }
}

void ContactEngine::push(Model& model) {
  const std::vector<std::int64_t>& totals = channel_.collect(force_.data(), 4, 3);
  load_.nodes = channel_.active_nodes();
  load_.force.assign(4 * load_.nodes.size(), 0);
  load_.friction.assign(4 * load_.nodes.size(), 0);
  for (std::size_t k = 0; k < load_.nodes.size(); ++k) {
    const auto n = static_cast<std::size_t>(load_.nodes[k]);
    for (int d = 0; d < 3; ++d) {
      load_.force[4 * k + d] = totals[4 * k + d];
      model.nodes.force[4 * n + d] += totals[4 * k + d];
    }
  }
  if (!(law_.response().friction > 0.0)) return;
  channel_.collect(friction_.data(), 4, 3);
  for (std::size_t k = 0; k < load_.nodes.size(); ++k) std::copy_n(&totals[4 * k], 3, &load_.friction[4 * k]);
}

ContactView ContactEngine::view() const {
  ContactView v;
  v.dt = dt_ahead();
  v.kick_dt = prediction_ ? prediction_->step().kick_dt() : 0.0;
  v.n_nodes = static_cast<int>(found_->node_id.size());
  v.node_id = found_->node_id.data();
  v.position = position_.data();
  v.velocity = velocity_.data();
  v.mass = mass_.data();
  v.node_body = found_->node_body.data();
  v.n_facets = static_cast<int>(found_->facet_id.size());
  v.facet_id = found_->facet_id.data();
  v.facet_nodes = found_->facet_nodes.data();
  v.facet_body = found_->facet_body.data();
  v.facet_bulk_modulus = found_->facet_bulk_modulus.data();
  v.facet_volume = found_->facet_volume.data();
  v.facet_edge = found_->facet_edge.data();
  v.n_slaves = static_cast<int>(found_->slave.size());
  v.slave = found_->slave.data();
  v.candidate_rows = found_->candidates.data();
  v.candidate = found_->candidate.data();
  v.around_rows = found_->around_rows.data();
  v.around = found_->around.data();
  return v;
}

/// Velocities and sums of all ranks for the rounds of impacts.
class ContactEngine::Exchange final : public ImpactExchange {
 public:
  Exchange(ContactEngine& engine, const Model& model) : engine_(engine), model_(model) {}
  const double* velocities() override {
    if (any_forces_) engine_.push_velocities(model_);
    any_forces_ = true;
    return engine_.pushed_velocity_.data();
  }
  void add_up(std::vector<std::int64_t>& rows) override { engine_.channel_.sum(rows.data(), rows.data(), 4, 4); }

 private:
  ContactEngine& engine_;
  const Model& model_;
  bool any_forces_ = false;
};

void ContactEngine::add_forces(Model& model, const Step& step, const Prediction& prediction, const ContactPlan& plan,
                               Timers& timers) {
  prediction_ = &prediction;
  {
    const auto scope = timers.measure("contact_search");
    keep_complete(model, step, plan);
  }
  const auto scope = timers.measure("contact_forces");
  pull(model);
  const ContactView seen = view();
  touches_.clear();
  law_.find_touches(seen, touches_);
  measure_speeds(model);
  split_masses(seen, model.quanta.mass);
  for (const std::int32_t active : active_) {
    const std::size_t i = 4 * static_cast<std::size_t>(active);
    std::fill_n(&force_[i], 4, 0);
    std::fill_n(&friction_[i], 4, 0);
    std::copy_n(&velocity_[i], 4, &pushed_velocity_[i]);
  }
  ContactForces forces(force_.data(), friction_.data(), model.quanta.force);
  Impacts impacts(seen, touches_, law_.response(), {share_.data(), model.quanta.mass}, active_);
  Exchange exchange(*this, model);
  effort_ = impacts.add_to(forces, exchange, plan.pace);
  if (forces.overflow_node() >= 0)
    trouble_ = fmt::format("the contact force on {} is not finite or beyond all bounds",
                           node_name(model, found_->node_id[forces.overflow_node()]));
  push(model);
  prediction_ = nullptr;
}

std::vector<std::string> ContactEngine::initial_penetrations(Model& model) {
  Step none;
  prediction_ = nullptr;
  search(model, none);
  valid_ = false;
  pull(model);
  std::vector<int> nodes;
  std::vector<double> depths;
  law_.penetrations(view(), nodes, depths);
  struct Deepest {
    double depth;
    std::int64_t id;
  };
  std::vector<Deepest> local;
  for (std::size_t i = 0; i < nodes.size(); ++i) local.push_back({depths[i], found_->node_id[nodes[i]]});
  const std::vector<Deepest> all = gather_to_root(model.comm, local);
  // Only ranks that have the node know where it is.
  struct {
    std::int64_t n = 0;
    Deepest worst{0.0, -1};
  } found;
  found.n = static_cast<std::int64_t>(all.size());
  if (!all.empty())
    found.worst = *std::max_element(all.begin(), all.end(), [](const Deepest& a, const Deepest& b) {
      return a.depth != b.depth ? a.depth < b.depth : a.id > b.id;
    });
  MPI_Bcast(&found, sizeof found, MPI_BYTE, 0, model.comm);
  if (found.n == 0) return {};
  const std::int32_t node = model.local_node(found.worst.id);
  std::string text;
  if (node >= 0) {
    const Vec3 x = model.nodes.reference_position(node);
    text = fmt::format(
        "{}: error: {} node{} lie{} inside another body at the start, the deepest by {:.4g} m: {} at ({:.5g}, "
        "{:.5g}, {:.5g}) m; move the parts apart",
        law_.origin, found.n, found.n == 1 ? "" : "s", found.n == 1 ? "s" : "", found.worst.depth,
        node_name(model, found.worst.id), x.x, x.y, x.z);
  }
  return {first_text(model.comm, text)};
}

}  // namespace kerf
