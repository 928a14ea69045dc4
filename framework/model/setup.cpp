// From generators to a numbered, distributed model at time zero.
#include "model/setup.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <utility>

#include "core/assert.hpp"
#include "core/diagnostics.hpp"
#include "core/fixed_sum.hpp"
#include "core/memory.hpp"
#include "input/node_choice.hpp"
#include "kerf/collapsed_cell.hpp"
#include "mesh/quality.hpp"
#include "model/arrival.hpp"
#include "model/constraints.hpp"
#include "model/copies.hpp"
#include "model/initial_state.hpp"
#include "model/joining.hpp"
#include "model/law_variables.hpp"
#include "model/migrator.hpp"
#include "model/names.hpp"
#include "model/node_group.hpp"
#include "parallel/communicator.hpp"

namespace kerf {

namespace {

/// Finds the combination of part and sets that a node of one part has, and lists the combinations that occur.
class MembershipFinder {
 public:
  MembershipFinder(const Model& model, std::size_t part, std::vector<Membership>& all) : all_(all) {
    found_.parts = {static_cast<std::int32_t>(part)};
    for (std::size_t k = 0; k < model.input->sets.size(); ++k) {
      const NodeChoice choice(*model.input->sets[k], *model.parts[part].input);
      if (choice.possible()) rules_.push_back({choice, static_cast<std::int32_t>(k)});
    }
  }
  /// The place of the combination in the list.
  std::int32_t number(const MeshGenerator& mesh, std::int64_t i, Vec3 x) {
    found_.sets.clear();
    for (const Rule& r : rules_)
      if (r.choice.takes(mesh, i, x)) found_.sets.push_back(r.set);
    if (last_ < all_.size() && all_[last_] == found_) return static_cast<std::int32_t>(last_);
    const auto [at, fresh] = numbers_.emplace(found_.sets, all_.size());
    if (fresh) all_.push_back(found_);
    last_ = at->second;
    return static_cast<std::int32_t>(last_);
  }

 private:
  struct Rule {
    NodeChoice choice;
    std::int32_t set;
  };
  std::vector<Rule> rules_;
  std::vector<Membership>& all_;
  std::size_t last_ = std::numeric_limits<std::size_t>::max();
  std::map<std::vector<std::int32_t>, std::size_t> numbers_;  // by the sets
  Membership found_;
};

/// Edge of the dummies over the longest edge of all elements.
constexpr double dummy_size = 16.0;

/// What a rank learns of its share of the mesh while it makes it.
struct MeshFacts {
  double longest_edge = 0.0;  // [m]
  MeshScale scale;
  std::vector<std::array<double, 2>> sizes;  // per part: least and greatest longest edge of its elements [m]
  std::vector<double> shortest_edges;  // per part [m]
  std::vector<std::int64_t> n_unusable;  // per part: elements that cannot be computed
  std::vector<std::int64_t> first_unusable;  // per part: the lowest id of one
  /// Per part: the least number of an element that is collapsed though its technology does not take such cells, and of
  /// one whose corners coincide as in no kind of cell; beyond all elements where there is none.
  std::vector<std::int64_t> first_collapsed, first_unknown;
  std::vector<Membership> memberships;  // that the nodes have
  std::string law_trouble;  // what a law has thrown for the first element that it did not like

  explicit MeshFacts(std::size_t n_parts)
      : sizes(n_parts, {std::numeric_limits<double>::max(), 0.0}),
        shortest_edges(n_parts, std::numeric_limits<double>::max()),
        n_unusable(n_parts, 0),
        first_unusable(n_parts, std::numeric_limits<std::int64_t>::max()),
        first_collapsed(n_parts, std::numeric_limits<std::int64_t>::max()),
        first_unknown(n_parts, std::numeric_limits<std::int64_t>::max()) {
    scale.shortest_edge = std::numeric_limits<double>::max();
  }
};

/// Makes the record of a fresh element, and notes what its shape says.
void weigh_element(const PartModel& part, std::size_t p, std::int64_t id, const ElementNodeIds& ids,
                   const CellCorners& corners, double* record, MeshFacts& facts) {
  const DistinctCell cell(part.store->shape(), ids);
  const Shape& shape = *cell.shape;
  const CellCorners x = cell.of(corners);
  const double volume = part.input->element->volume(corners);
  if (!(volume > 0.0) || !(min_scaled_jacobian(shape, x) > 0.0)) {
    ++facts.n_unusable[p];
    facts.first_unusable[p] = std::min(facts.first_unusable[p], id);
  }
  const double edge = longest_edge(shape, x), shortest = shortest_edge(shape, x);
  facts.longest_edge = std::max(facts.longest_edge, edge);
  facts.scale.shortest_edge = std::min(facts.scale.shortest_edge, shortest);
  facts.shortest_edges[p] = std::min(facts.shortest_edges[p], shortest);
  facts.sizes[p] = {std::min(facts.sizes[p][0], edge), std::max(facts.sizes[p][1], edge)};
  part.store->initial_record(part.material->density * volume, record);
  InitialPoint point;
  for (std::size_t k = 0; k < static_cast<std::size_t>(shape.n_nodes); ++k) point.position = point.position + x[k];
  point.position = point.position * (1.0 / shape.n_nodes);
  point.length = kerf::pow(volume, 1.0 / 3.0);
  point.density = part.material->density;
  try {
    initialise_laws(part, point, record);
  } catch (const InputError& e) {  // only on this rank, perhaps: told later, by all
    if (facts.law_trouble.empty()) facts.law_trouble = e.lines().front();
  }
}

/// Least and greatest number of a node of the elements [first, last) of a mesh: a rank has room for its share only.
std::pair<std::int64_t, std::int64_t> range_of_nodes(const MeshGenerator& mesh, int n_nodes, std::int64_t first,
                                                     std::int64_t last) {
  std::pair<std::int64_t, std::int64_t> range{std::numeric_limits<std::int64_t>::max(), -1};
  for (std::int64_t e = first; e < last; ++e) {
    const auto corners = mesh.element(e);
    for (int k = 0; k < n_nodes; ++k) {
      range.first = std::min(range.first, static_cast<std::int64_t>(corners[k]));
      range.second = std::max(range.second, static_cast<std::int64_t>(corners[k]));
    }
  }
  return range;
}

/// Notes where corners coincide though they must not, or as they must not.
void look_at_kind(const PartModel& part, std::size_t p, std::int64_t element, const ElementNodeIds& ids,
                  MeshFacts& facts) {
  if (part.store->shape().vtk_type != hexahedron.vtk_type) return;
  const CellKind kind = kind_of_cell(ids);
  if (kind == CellKind::hexahedron) return;
  std::int64_t& first = kind == CellKind::unknown ? facts.first_unknown[p] : facts.first_collapsed[p];
  if (kind == CellKind::unknown || !part.input->element->takes_collapsed_cells()) first = std::min(first, element);
}

/// Elements [first, last) of a part, counted within the part.
void generate_part(const Model& model, std::size_t p, std::int64_t first, std::int64_t last, ModelBundle& bundle,
                   MeshFacts& facts) {
  const PartModel& part = model.parts[p];
  const MeshGenerator& mesh = *part.input->mesh;
  const Placement placement(*part.input);
  MembershipFinder memberships(model, p, facts.memberships);
  ElementBundle& out = bundle.parts[p];
  const int size = part.store->record_size();
  const auto n = static_cast<std::size_t>(last - first);
  out.records.resize(n * static_cast<std::size_t>(size));
  out.ids.reserve(n);
  out.nodes.reserve(n);
  // As many as the elements' share of the part, and some more on the cut to the next rank.
  const double share = static_cast<double>(n) / static_cast<double>(mesh.n_elements());
  const auto wanted = bundle.nodes.size() + static_cast<std::size_t>(1.05 * share * mesh.n_nodes()) + 64;
  // Of a thousand small parts, not each may move the nodes of all parts before it.
  if (wanted > bundle.nodes.capacity()) bundle.nodes.reserve(std::max(wanted, bundle.nodes.capacity() * 3 / 2));
  const auto [lowest, highest] = range_of_nodes(mesh, part.store->n_nodes(), first, last);
  std::vector<char> seen(static_cast<std::size_t>(highest - lowest + 1), 0);
  for (std::int64_t e = first; e < last; ++e) {
    const auto corners = mesh.element(e);
    CellCorners x;
    ElementNodeIds ids{};
    for (int k = 0; k < part.store->n_nodes(); ++k) {
      x[k] = placement.apply(mesh.node(corners[k]));
      ids[k] = part.first_node + corners[k];
      char& is_seen = seen[static_cast<std::size_t>(corners[k] - lowest)];
      if (is_seen != 0) continue;
      is_seen = 1;
      NodeRecord r;
      r.id = ids[k];
      r.part = static_cast<std::int32_t>(p);
      r.membership = memberships.number(mesh, corners[k], x[k]);
      for (int d = 0; d < 3; ++d) {
        r.reference[d] = r.position[d] = x[k][d];
        facts.scale.farthest = std::max(facts.scale.farthest, std::fabs(x[k][d]));
        r.velocity[d] = part.input->velocity[d];
      }
      bundle.nodes.push_back(r);
    }
    look_at_kind(part, p, e, corners, facts);
    weigh_element(part, p, part.first_element + e, ids, x,
                  out.records.data() + static_cast<std::size_t>(e - first) * size, facts);
    out.ids.push_back(part.first_element + e);
    out.nodes.push_back(ids);
  }
}

/// Throws where corners coincide in a way that cannot be computed. Collective.
void refuse_collapsed(const Model& model, const MeshFacts& facts) {
  std::vector<std::string> errors;
  const auto least_of = [&](std::int64_t mine) {
    MPI_Allreduce(MPI_IN_PLACE, &mine, 1, MPI_INT64_T, MPI_MIN, model.comm);
    return mine;
  };
  for (std::size_t p = 0; p < model.parts.size(); ++p) {
    const PartInput& part = *model.parts[p].input;
    const auto refuse = [&](std::int64_t element, const std::string& what) {
      if (element < part.mesh->n_elements())
        errors.push_back(fmt::format("{}: error: element {} of part {} {}", part.mesh->origin,
                                     part.mesh->element_label(element), part.name, what));
    };
    refuse(least_of(facts.first_collapsed[p]),
           fmt::format("is a wedge, a pyramid or a tetrahedron, and the element {} computes none; expected hexahedra, "
                       "or the element hex8",
                       part.element->type));
    refuse(least_of(facts.first_unknown[p]),
           "has corners that coincide in another way than those of a wedge, a pyramid or a tetrahedron; expected eight "
           "different nodes, or one of these cells");
  }
  if (!errors.empty()) throw InputError(errors);
}

/// Throws where elements have no volume or are turned inside out. Collective.
void refuse_unusable(const Model& model, const MeshFacts& facts) {
  if (const std::string text = first_text(model.comm, facts.law_trouble); !text.empty()) throw InputError({text});
  std::vector<std::string> errors;
  for (std::size_t p = 0; p < model.parts.size(); ++p) {
    const std::int64_t n = sum_of(model.comm, facts.n_unusable[p]);
    const std::int64_t first = -greatest(model.comm, -facts.first_unusable[p]);
    const PartInput& part = *model.parts[p].input;
    const bool labels = part.mesh->has_labels();
    if (n > 0)
      errors.push_back(fmt::format(
          "{}: error: {} of the {} elements of part {} {} no volume or a corner turned inside out{}; change {}{}",
          part.mesh->origin, n, model.parts[p].n_elements, part.name, n == 1 ? "has" : "have",
          labels ? fmt::format(", the first of them element {}", element_label(model, first)) : "",
          labels ? "the file" : "the parameters of the mesh",
          part.placement.empty() ? "" : " or the placement of the part"));
  }
  if (!errors.empty()) throw InputError(errors);
}

/// Throws where areas squared, or these times a modulus, would leave the range of floats: 1e-38 to 3e38. Dummies, whose
/// edges are 16 times the longest one, are computed too. Collective.
void refuse_beyond_floats(const Model& model, const MeshFacts& facts) {
  if (model.input->precision != "single") return;
  constexpr double least = 1e-7, most = 1e5;  // [m]
  std::vector<std::string> errors;
  for (std::size_t p = 0; p < model.parts.size(); ++p) {
    const PartInput& part = *model.parts[p].input;
    const double low = -greatest(model.comm, -facts.sizes[p][0]), high = greatest(model.comm, facts.sizes[p][1]);
    if (low < least || high > most)
      errors.push_back(fmt::format(
          "{}: error: part {} has elements of {:.3g} m, and `precision: single` computes with {:g} m to {:g} m; "
          "expected other units of the mesh, or `precision: double`",
          part.mesh->origin, part.name, low < least ? low : high, least, most));
  }
  if (!errors.empty()) throw InputError(errors);
}

/// Greatest speed of a node at time zero, and of what conditions impose on nodes in the course of the run [m/s].
/// Collective.
double greatest_speed(const Model& model) {
  constexpr int n_looks = 32;  // at a motion that changes with time
  const double end = model.input->time.end, dt = 1e-3 * end / n_looks;
  double square = 0.0;
  const auto see = [&square](Vec3 v) { square = std::max(square, dot(v, v)); };
  for (const auto& b : model.input->boundaries)
    for (int look = 0; look < n_looks; ++look) {
      const HalfSpace from = b->region(end * look / n_looks), to = b->region(end * look / n_looks + dt);
      if (const double length = norm(to.normal); length > 0.0)
        see(to.normal * ((to.offset - from.offset) / (dt * length * length)));
    }
  std::vector<NodeGroup> groups;
  for (const auto& b : model.input->boundaries) groups.emplace_back(model, b->nodes());
  for (int i = 0; i < model.nodes.n(); ++i) {
    Vec3 v = model.nodes.v(i);
    see(v);
    for (std::size_t k = 0; k < groups.size(); ++k) {
      if (!groups[k].holds(model.nodes, i)) continue;
      const Boundary& b = *model.input->boundaries[k];
      const BoundaryNode node = boundary_node(model.nodes, i, v);
      see(v = b.initial(node, v));
      if (b.ask(node.position) != Boundary::Ask::always) continue;
      for (int look = 0; look < n_looks; ++look) see(b.constrain(node, {end * look / n_looks + 0.5 * dt, dt}, Vec3{}));
    }
  }
  return std::sqrt(greatest(model.comm, square));
}

/// Makes anew the records of elements whose nodes have moved when parts were joined. Pre: the ids are in ascending
/// order.
void reweigh_elements(const Model& model, const std::vector<std::int64_t>& moved, ModelBundle& bundle,
                      MeshFacts& facts) {
  if (moved.empty()) return;
  const auto by_id = [](const NodeRecord& a, const NodeRecord& b) { return a.id < b.id; };
  std::sort(bundle.nodes.begin(), bundle.nodes.end(), by_id);
  for (std::size_t p = 0; p < model.parts.size(); ++p) {
    const PartStore& store = *model.parts[p].store;
    ElementBundle& elements = bundle.parts[p];
    for (std::size_t e = 0; e < elements.ids.size(); ++e) {
      CellCorners x;
      bool any = false;
      for (std::size_t k = 0; k < static_cast<std::size_t>(store.n_nodes()); ++k) {
        NodeRecord wanted;
        wanted.id = elements.nodes[e][k];
        any = any || std::binary_search(moved.begin(), moved.end(), wanted.id);
        const double* at = std::lower_bound(bundle.nodes.begin(), bundle.nodes.end(), wanted, by_id)->position;
        x[k] = {at[0], at[1], at[2]};
      }
      if (any)
        weigh_element(model.parts[p], p, elements.ids[e], elements.nodes[e], x,
                      &elements.records[e * static_cast<std::size_t>(store.record_size())], facts);
    }
  }
}

/// Throws where elements of different parts have the same nodes: the parts overlap by whole cells. Collective.
void refuse_same_cells(const Model& model, const ModelBundle& bundle) {
  struct Nodes {
    ElementNodeIds ids;
    std::int64_t part;
  };
  std::vector<std::vector<Nodes>> outgoing(static_cast<std::size_t>(model.n_ranks()));
  for (std::size_t p = 0; p < bundle.parts.size(); ++p)
    for (ElementNodeIds ids : bundle.parts[p].nodes) {
      for (std::size_t k = static_cast<std::size_t>(model.parts[p].store->n_nodes()); k < ids.size(); ++k)
        ids[k] = std::numeric_limits<std::int64_t>::max();
      std::sort(ids.begin(), ids.end());
      // Cells that are collapsed may repeat different nodes.
      std::fill(std::unique(ids.begin(), ids.end()), ids.end(), std::numeric_limits<std::int64_t>::max());
      outgoing[static_cast<std::size_t>(ids[0] % model.n_ranks())].push_back({ids, static_cast<std::int64_t>(p)});
    }
  std::vector<Nodes> all;
  for (const auto& list : all_to_all(model.comm, outgoing)) all.insert(all.end(), list.begin(), list.end());
  std::sort(all.begin(), all.end(), [](const Nodes& a, const Nodes& b) { return a.ids < b.ids; });
  const auto twice =
      std::adjacent_find(all.begin(), all.end(), [](const Nodes& a, const Nodes& b) { return a.ids == b.ids; });
  std::string text;
  if (twice != all.end()) {
    const PartInput &first = *model.parts[static_cast<std::size_t>(std::min(twice->part, twice[1].part))].input,
                    &second = *model.parts[static_cast<std::size_t>(std::max(twice->part, twice[1].part))].input;
    text = fmt::format(
        "{}: error: parts {} and {} are joined and overlap by whole cells; move them apart, so that they "
        "share a surface only",
        second.mesh->origin, first.name, second.name);
  }
  if (text = first_text(model.comm, text); !text.empty()) throw InputError({text});
}

/// Makes parts share nodes as the input says. Collective.
void join(Model& model, ModelBundle& bundle, const MeshFacts& facts) {
  std::vector<double> shortest = facts.shortest_edges;
  MPI_Allreduce(MPI_IN_PLACE, shortest.data(), static_cast<int>(shortest.size()), MPI_DOUBLE, MPI_MIN, model.comm);
  const std::vector<std::int64_t> moved = join_parts(model, bundle, shortest);
  refuse_same_cells(model, bundle);
  MeshFacts changed(model.parts.size());
  reweigh_elements(model, moved, bundle, changed);
  refuse_unusable(model, changed);
}

/// Lumped nodal masses: the shares that elements give to their nodes, summed in whole quanta over all ranks.
void lump_masses(Model& model) {
  double largest = 0.0;
  for (const PartModel& part : model.parts)
    for (int s = 0; s < part.store->n_slots(); ++s)
      largest = std::max(largest, part.store->field(PartStore::mass).at(s, 0));
  const double quantum = power_of_two_above(greatest(model.comm, largest)) * 0x1p-54;
  std::vector<std::int64_t> sums(static_cast<std::size_t>(model.nodes.n()) + NodeStore::n_dummies, 0);
  const auto share = [&](std::size_t p, int slot, int corner) {
    const PartStore& store = *model.parts[p].store;
    const double mass = store.field(PartStore::mass).at(slot, 0);
    return static_cast<std::int64_t>(std::llrint(mass * store.shape().mass_share[corner] / quantum));
  };
  for (std::size_t p = 0; p < model.parts.size(); ++p) {
    const PartStore& store = *model.parts[p].store;
    for (int s = 0; s < store.n_slots(); ++s)
      for (int k = 0; k < store.n_nodes(); ++k) sums[store.node(s, k)] += share(p, s, k);
  }
  sum_over_copies(model, sums.data(), 1);
  for (int i = 0; i < model.nodes.n(); ++i) model.nodes.set_mass(i, static_cast<double>(sums[i]) * quantum);
  if (model.has_joined_parts()) share_nodes(model, quantum, share);
}

/// What loads say that they will reach.
struct LoadBounds {
  double pressure = 0.0;  // [Pa]
  double force = 0.0;  // on a node [N]
};

/// The sum over all loads, which may act together. Collective.
LoadBounds bounds_of_loads(const Model& model) {
  LoadBounds bounds;
  double heaviest = 0.0;
  for (const double mass : model.nodes.mass) heaviest = std::max(heaviest, mass);
  heaviest = greatest(model.comm, heaviest);
  for (const auto& load : model.input->loads) {
    const double most = load->greatest().value_or(0.0);
    if (dynamic_cast<const FacetLoad*>(load.get())) bounds.pressure += most;
    if (dynamic_cast<const NodalLoad*>(load.get())) bounds.force += most;
    if (dynamic_cast<const BodyLoad*>(load.get())) bounds.force += most * heaviest;
  }
  return bounds;
}

/// From what the laws, the motion at time zero, the conditions and the loads say. Collective.
void set_force_quantum(Model& model) {
  // What two bodies that meet head on can press on each other: at least rho v^2 each, which in a cold gas is more than
  // any modulus.
  const double closing = 2.0 * greatest_speed(model), longest = model.dummy_edge / dummy_size;
  double stiffest = 0.0;
  for (const PartModel& part : model.parts)
    stiffest = std::max({stiffest, part.bulk_modulus + 4.0 / 3.0 * part.shear_modulus, std::fabs(part.initial_pressure),
                         part.hot_stiffness, part.material->density * closing * closing});
  const LoadBounds loads = bounds_of_loads(model);
  stiffest = std::max(stiffest, loads.pressure);
  // 64 times the stiffest modulus on the largest face is the largest force that fits (design, section 5).
  const double greatest_force = std::max(64.0 * stiffest * longest * longest, 4.0 * loads.force);
  model.quanta.force.quantum = power_of_two_above(greatest_force) / ForceScale::limit;
  model.quanta.force.per_quantum = 1.0 / model.quanta.force.quantum;
}

}  // namespace

std::vector<const FacetLoad*> facet_loads(const ModelInput& input) {
  std::vector<const FacetLoad*> found;
  for (const auto& load : input.loads)
    if (const auto* law = dynamic_cast<const FacetLoad*>(load.get())) found.push_back(law);
  return found;
}

namespace {

/// What the laws make of a point of the body is what fresh elements and empty slots begin with.
void start_laws(PartModel& part) {
  std::vector<double> record(static_cast<std::size_t>(part.store->record_size()));
  part.store->initial_record(0.0, record.data());
  InitialPoint point;
  point.position = part.placement->apply(part.input->mesh->node(0));
  point.length = 1.0;
  point.density = part.material->density;
  initialise_laws(part, point, record.data());
  part.store->set_initial_values(record.data());
}

}  // namespace

void create_parts(Model& model, MPI_Comm comm, const ModelInput& input) {
  model.set_comm(comm);
  model.input = &input;
  for (const auto& set : input.sets) model.set_names.push_back(set->name);
  const Precision precision = input.precision == "single" ? Precision::single_precision : Precision::double_precision;
  for (const auto& p : input.parts) {
    PartModel part;
    part.input = p.get();
    part.placement = std::make_unique<Placement>(*p);
    for (const auto& m : input.materials)
      if (m->name == p->material) part.material = m.get();
    KERF_ASSERT(part.material, "names of materials are checked when the input is read");
    part.first_element = model.n_elements;
    part.first_node = part.first_own_node = model.n_nodes;
    part.n_elements = p->mesh->n_elements();
    part.n_nodes = p->mesh->n_nodes();
    model.n_elements += part.n_elements;
    model.n_nodes += part.n_nodes;
    ask_moduli(part, input);
    part.work = input.balance.work.of_element(*p->element, *part.material);
    PartStore::Variables variables = variables_of(*part.material, part.first_criterion_state);
    variables.facet_loads = static_cast<int>(facet_loads(input).size());
    part.store =
        std::make_unique<PartStore>(static_cast<int>(model.parts.size()), *p->element, std::move(variables), precision);
    start_laws(part);
    part.material_reads = LawReads(part.material->stress_law(), *part.store);
    if (part.material->eos) part.eos_reads = LawReads(*part.material->eos, *part.store);
    model.parts.push_back(std::move(part));
  }
  number_bodies(model);
}

void generate_mesh(Model& model) {
  const ReturnedBlocks returned;
  const std::int64_t n = model.n_elements, r = model.rank(), n_ranks = model.n_ranks();
  const std::int64_t first = n / n_ranks * r + std::min(r, n % n_ranks);
  const std::int64_t last = first + n / n_ranks + (r < n % n_ranks ? 1 : 0);
  ModelBundle bundle;
  bundle.parts.resize(model.parts.size());
  MeshFacts facts(model.parts.size());
  for (std::size_t p = 0; p < model.parts.size(); ++p) {
    const PartModel& part = model.parts[p];
    const std::int64_t low = std::clamp(first - part.first_element, std::int64_t{0}, part.n_elements);
    const std::int64_t high = std::clamp(last - part.first_element, std::int64_t{0}, part.n_elements);
    if (low < high) generate_part(model, p, low, high, bundle, facts);
  }
  refuse_collapsed(model, facts);
  refuse_unusable(model, facts);
  refuse_beyond_floats(model, facts);
  model.dummy_edge = dummy_size * greatest(model.comm, facts.longest_edge);
  model.scale = {least(model.comm, facts.scale.shortest_edge), greatest(model.comm, facts.scale.farthest)};
  for (const auto& boundary : model.input->boundaries) boundary->prepare(model.scale);
  model.memberships = Memberships(model.comm, facts.memberships);
  std::vector<std::int32_t> numbers;
  for (const Membership& m : facts.memberships) numbers.push_back(model.memberships.number_of(m));
  for (NodeRecord& r : bundle.nodes) r.membership = numbers[static_cast<std::size_t>(r.membership)];
  if (model.has_joined_parts()) join(model, bundle, facts);
  assemble(model, std::move(bundle));
  lump_masses(model);
  find_arrivals(model);
  apply_initial_states(model);
  set_force_quantum(model);
}

}  // namespace kerf
