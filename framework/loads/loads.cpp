// Evaluates loads node by node and facet by facet, and adds their forces in whole quanta.
#include "loads/loads.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <exception>
#include <limits>

#include "loads/facet_shares.hpp"
#include "model/copies.hpp"
#include "model/names.hpp"
#include "model/node_group.hpp"
#include "parallel/fetch_by_id.hpp"

namespace kerf {

namespace {

/// Another number whenever elements of this rank came, went or changed places.
std::int64_t arrangement_of(const Model& model) {
  std::int64_t sum = 0;
  for (const PartModel& part : model.parts) sum += part.store->arrangement();
  return sum;
}

std::size_t n_corners(const ExteriorFacet& f) { return f.nodes[3] == f.nodes[2] ? 3 : 4; }

/// The mean over the corners of a facet of what `value(node)` returns.
template <class Value>
Vec3 mean_of(const ExteriorFacet& f, const Value& value) {
  Vec3 sum;
  for (std::size_t c = 0; c < n_corners(f); ++c) sum = sum + value(f.nodes[c]);
  return sum * (1.0 / static_cast<double>(n_corners(f)));
}

ForceActor actor_of(const Load& load) { return {"the load " + load.type, load.origin}; }

std::array<Vec3, 4> shares_of(const NodeStore& nodes, const ExteriorFacet& f) {
  return facet_shares({nodes.x(f.nodes[0]), nodes.x(f.nodes[1]), nodes.x(f.nodes[2]), nodes.x(f.nodes[3])});
}

}  // namespace

Loads::Loads(const ModelInput& input) : input_(input), marks_(input) {
  for (const auto& load : input.loads) {
    OnNodes on;
    on.load = load.get();
    on.nodal = dynamic_cast<const NodalLoad*>(load.get());
    on.body = dynamic_cast<const BodyLoad*>(load.get());
    if (on.nodal != nullptr || on.body != nullptr) on_nodes_.push_back(std::move(on));
  }
}

void Loads::begin(Model& model) {
  marks_.choose(model);
  renumbered(model);
}

void Loads::renumbered(const Model& model) {
  arrangement_ = -1;
  acting_ = {};  // these forces have done their work before anything moves
  for (OnNodes& on : on_nodes_) {
    on.nodes.clear();
    on.reference.clear();
    const NodeGroup group(model, on.load->targets());
    for (int i = 0; i < model.nodes.n(); ++i) {
      if (!group.holds(model.nodes, i)) continue;
      on.nodes.push_back(i);
      if (on.load->reads_reference_position()) on.reference.push_back(model.nodes.reference_position(i));
    }
  }
}

void Loads::find_facets(const Model& model) {
  const std::int64_t now = arrangement_of(model);
  if (now == arrangement_) return;
  arrangement_ = now;
  on_facets_.clear();
  for (const FacetMarks::Marked& mark : marks_.find(model)) {
    OnFacet on{mark, {}};
    if (marks_.laws()[mark.law]->reads_reference_position())
      on.reference = mean_of(mark.facet, [&](std::int32_t i) { return model.nodes.reference_position(i); });
    on_facets_.push_back(on);
  }
}

/// Adds a force to one copy of a node. One that is not finite or too large is not added, but named in `trouble_`.
void Loads::add(const Model& model, std::int32_t node, Vec3 newton, const ForceActor& actor) {
  for (int d = 0; d < 3; ++d) {
    std::int64_t& sum = force_[4 * static_cast<std::size_t>(node) + static_cast<std::size_t>(d)];
    const double quanta = newton[d] * model.quanta.force.per_quantum;
    // Negated, so that it holds for what is no number.
    const bool fits = std::fabs(quanta) < ForceScale::limit;
    if (fits) sum += std::llrint(quanta);
    if ((fits && std::fabs(static_cast<double>(sum)) < ForceScale::limit) || !trouble_.empty()) continue;
    trouble_ = fmt::format(
        "the force of {} ({}) on {}, {:.4g} N, is not finite, or out of all proportion to what the materials can bear;",
        actor.name, actor.origin, node_name(model, model.nodes.id[node]), newton[d]);
  }
}

/// Of the law that was asked last.
void Loads::note_failure(const char* what) {
  if (trouble_.empty()) trouble_ = fmt::format("the load {} ({}) failed: {};", asked_->type, asked_->origin, what);
}

/// What a law sees of a facet whose corners have these shares of its area.
LoadedFacet Loads::seen(const Model& model, const OnFacet& on, const std::array<Vec3, 4>& shares) const {
  const NodeStore& nodes = model.nodes;
  const ExteriorFacet& f = on.mark.facet;
  const Vec3 whole = shares[0] + shares[1] + shares[2] + shares[3];
  LoadedFacet facet;
  facet.id = model.parts[static_cast<std::size_t>(f.part)].store->id(f.slot) * Shape::code_of_faces + f.face;
  facet.area = norm(whole);
  facet.normal = facet.area > 0.0 ? whole * (1.0 / facet.area) : Vec3{};
  facet.position = mean_of(f, [&](std::int32_t i) { return nodes.x(i); });
  facet.velocity = mean_of(f, [&](std::int32_t i) { return nodes.v(i); });
  facet.reference_position = on.reference;
  return facet;
}

void Loads::add_facet_forces(const Model& model, double time) {
  ForceActor actor;
  for (const OnFacet& on : on_facets_) {
    const ExteriorFacet& f = on.mark.facet;
    const FacetLoad& law = *marks_.laws()[on.mark.law];
    if (asked_ != &law || actor.name.empty()) actor = actor_of(law);
    asked_ = &law;
    const std::array<Vec3, 4> shares = shares_of(model.nodes, f);
    const LoadedFacet facet = seen(model, on, shares);
    const FacetForce acts = law.force(facet, time);
    for (std::size_t c = 0; c < 4; ++c)
      add(model, f.nodes[c], shares[c] * -acts.pressure + acts.traction * dot(shares[c], facet.normal), actor);
  }
}

void Loads::add_node_forces(const Model& model, const OnNodes& on, const Step& step) {
  const NodeStore& nodes = model.nodes;
  asked_ = on.load;
  const ForceActor actor = actor_of(*on.load);
  for (std::size_t k = 0; k < on.nodes.size(); ++k) {
    const std::int32_t i = on.nodes[k];
    // A point mass is nobody's material; a dropped node is nothing.
    if (!(nodes.mass[i] > 0.0) || (on.nodal != nullptr && nodes.free[i] != 0)) continue;
    const LoadedNode node{
        nodes.id[i], nodes.mass[i], nodes.x(i), nodes.v(i), on.reference.empty() ? Vec3{} : on.reference[k], step.dt};
    const Vec3 newton =
        on.nodal != nullptr ? on.nodal->force(node, step.end()) : on.body->acceleration(node, step.end()) * node.mass;
    add(model, i, newton, actor);
  }
}

void Loads::add_forces(Model& model, const Step& step) {
  if (input_.loads.empty() && !has_source()) return;
  const double time = step.end();
  trouble_.clear();
  find_facets(model);
  force_.assign(4 * (static_cast<std::size_t>(model.nodes.n()) + NodeStore::n_dummies), 0);
  try {
    add_facet_forces(model, time);
  } catch (const std::exception& e) {
    note_failure(e.what());
  }
  if (has_source())
    source_->add_forces(
        step, [&](std::int32_t node, Vec3 newton, const ForceActor& actor) { add(model, node, newton, actor); });
  // Each facet is computed once, by the rank that has its element, and observers know owned nodes; the laws of nodes
  // are computed on all ranks that have a copy.
  if (!marks_.laws().empty() || has_source()) sum_over_copies(model, force_.data(), 4);
  try {
    for (const OnNodes& on : on_nodes_) add_node_forces(model, on, step);
  } catch (const std::exception& e) {
    note_failure(e.what());
  }
  hand_over(model);
}

/// Adds the sums to the forces of the nodes, and keeps the sums of owned nodes.
void Loads::hand_over(Model& model) {
  acting_ = {};
  for (int i = 0; i < model.nodes.n(); ++i) {
    const std::int64_t* f = &force_[4 * static_cast<std::size_t>(i)];
    if (f[0] == 0 && f[1] == 0 && f[2] == 0) continue;
    for (std::size_t d = 0; d < 3; ++d) model.nodes.force[4 * static_cast<std::size_t>(i) + d] += f[d];
    if (model.nodes.owned[i] == 0) continue;
    acting_.nodes.push_back(i);
    acting_.force.insert(acting_.force.end(), {f[0], f[1], f[2], 0});
  }
}

void Loads::after_erosion(Model& model, const std::vector<ExteriorFacet>& opened) {
  if (marks_.after_erosion(model, opened)) arrangement_ = -1;
}

void Loads::restore(const Model& model, const std::vector<LoadOnNode>& share) {
  acting_ = {};
  if (input_.loads.empty() && !has_source()) return;
  std::vector<std::int64_t> owned;
  for (int i = 0; i < model.nodes.n(); ++i)
    if (model.nodes.owned[i] != 0) owned.push_back(model.nodes.id[i]);
  for (const LoadOnNode& l : fetch_by_id(model.comm, share, owned).wanted) {
    acting_.nodes.push_back(model.local_node(l.id));
    acting_.force.insert(acting_.force.end(), {l.force[0], l.force[1], l.force[2], 0});
  }
}

std::vector<std::int64_t> Loads::count_targets(const Model& model) const {
  std::vector<std::int64_t> counts(input_.loads.size(), 0);
  const auto number_of = [this](const Load* load) {
    return static_cast<std::size_t>(
        std::find_if(input_.loads.begin(), input_.loads.end(), [load](const auto& l) { return l.get() == load; }) -
        input_.loads.begin());
  };
  for (const FacetMarks::Marked& m : marks_.find(model)) ++counts[number_of(marks_.laws()[m.law])];
  for (const OnNodes& on : on_nodes_)
    for (const std::int32_t i : on.nodes)
      if (model.nodes.owned[i] != 0) ++counts[number_of(on.load)];
  MPI_Allreduce(MPI_IN_PLACE, counts.data(), static_cast<int>(counts.size()), MPI_INT64_T, MPI_SUM, model.comm);
  return counts;
}

namespace {

/// What a load has against its facets of one rank.
struct FacetTally {
  std::int64_t n = 0, refused = 0, reached = 0, in_time = 0;
  std::int64_t first = std::numeric_limits<std::int64_t>::max();  // the least id of those that are refused
  std::string text;  // about it
};

}  // namespace

std::vector<std::string> Loads::complaints(const Model& model) {
  find_facets(model);
  late_.clear();
  std::vector<FacetTally> tallies(marks_.laws().size());
  for (const OnFacet& on : on_facets_) {
    const FacetLoad& law = *marks_.laws()[on.mark.law];
    FacetTally& t = tallies[on.mark.law];
    const LoadedFacet facet = seen(model, on, shares_of(model.nodes, on.mark.facet));
    std::string text = law.objection(facet);
    ++t.n;
    if (law.can_reach(facet, std::numeric_limits<double>::infinity())) ++t.reached;
    if (law.can_reach(facet, model.input->time.end)) ++t.in_time;
    if (text.empty()) continue;
    ++t.refused;
    if (facet.id < t.first) t.text = std::move(text);
    t.first = std::min(t.first, facet.id);
  }
  std::vector<std::string> lines;
  for (std::size_t k = 0; k < tallies.size(); ++k) {
    const FacetTally& t = tallies[k];
    const Load& law = *marks_.laws()[k];
    const std::int64_t refused = sum_of(model.comm, t.refused), all = sum_of(model.comm, t.n);
    const std::int64_t reached = sum_of(model.comm, t.reached), in_time = sum_of(model.comm, t.in_time);
    if (reached > 0 && in_time == 0)
      late_.push_back(
          fmt::format("{}: warning: the load {} pushes its first facet after the end of the run at {:.3g} s; raise "
                      "time.end, or let it act earlier",
                      law.origin, law.type, model.input->time.end));
    if (refused == 0 && reached == 0 && all > 0)
      lines.push_back(
          fmt::format("{}: error: the load {} can push none of its {} facets; expected a place, a direction and a time "
                      "at which it acts on some",
                      law.origin, law.type, all));
    if (refused == 0) continue;
    // The same facet on any number of ranks.
    std::int64_t least = 0;
    MPI_Allreduce(&t.first, &least, 1, MPI_INT64_T, MPI_MIN, model.comm);
    const std::string text = first_text(model.comm, t.first == least ? t.text : std::string{});
    lines.push_back(fmt::format("{}: error: the load {} cannot act on {} of its {} facets; the first has {}",
                                law.origin, law.type, refused, all, text));
  }
  return lines;
}

}  // namespace kerf
