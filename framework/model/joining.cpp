// Which nodes meet, what they become, and how mass and momentum of a shared node are divided between its parts.
#include "model/joining.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>
#include <tuple>

#include "core/assert.hpp"
#include "core/diagnostics.hpp"
#include "input/placement.hpp"
#include "model/common_nodes.hpp"
#include "model/migrator.hpp"
#include "model/model.hpp"
#include "model/names.hpp"
#include "parallel/communicator.hpp"

namespace kerf {

namespace {

std::size_t index(std::int32_t i) { return static_cast<std::size_t>(i); }

std::int32_t part_named(const Model& model, const std::string& name) {
  for (std::size_t p = 0; p < model.parts.size(); ++p)
    if (model.parts[p].input->name == name) return static_cast<std::int32_t>(p);
  KERF_ASSERT(false, "names of joined parts are checked when the input is read");
  return -1;
}

/// One entry of the input's list `joined`.
struct Joint {
  std::vector<std::int32_t> parts;
  double tolerance = 0.0, cube = 0.0;  // [m]; of the grid that finds the nodes [m]
  std::string origin;
};

/// Throws where a tolerance is too large for the cells. The same on all ranks.
std::vector<Joint> resolve_joints(const Model& model, const std::vector<double>& shortest_edges) {
  std::vector<Joint> joints;
  std::vector<std::string> errors;
  for (const auto& input : model.input->joined) {
    Joint joint;
    double shortest = std::numeric_limits<double>::max();
    for (const std::string& name : input->parts) {
      joint.parts.push_back(part_named(model, name));
      shortest = std::min(shortest, shortest_edges[index(joint.parts.back())]);
    }
    joint.tolerance = input->tolerance > 0.0 ? input->tolerance : model.scale.tolerance();
    joint.cube = shortest;
    joint.origin = input->origin;
    if (!(joint.tolerance < 0.5 * shortest))
      errors.push_back(
          fmt::format("{}: error: the tolerance of {:.4g} m would join nodes of one cell; expected less "
                      "than half of the shortest edge of these parts, {:.4g} m",
                      joint.origin, joint.tolerance, shortest));
    joints.push_back(std::move(joint));
  }
  if (!errors.empty()) throw InputError(errors);
  // Cubes must be larger than twice the tolerance.
  for (Joint& joint : joints) joint.cube = std::max(joint.cube, 4.0 * joint.tolerance);
  return joints;
}

/// The boxes round the parts: lower corners with a minus, then upper corners; of all ranks. Collective.
std::vector<double> boxes_of_parts(const Model& model, const std::vector<NodeRecord>& nodes) {
  std::vector<double> limits(6 * model.parts.size(), -std::numeric_limits<double>::max());
  for (const NodeRecord& n : nodes)
    for (std::size_t d = 0; d < 3; ++d) {
      double* box = &limits[6 * index(n.part)];
      box[d] = std::max(box[d], -n.position[d]);
      box[3 + d] = std::max(box[3 + d], n.position[d]);
    }
  MPI_Allreduce(MPI_IN_PLACE, limits.data(), static_cast<int>(limits.size()), MPI_DOUBLE, MPI_MAX, model.comm);
  return limits;
}

bool is_near_box(const double* box, const double* x, double tolerance) {
  for (int d = 0; d < 3; ++d)
    if (x[d] < -box[d] - tolerance || x[d] > box[3 + d] + tolerance) return false;
  return true;
}

/// Nodes of the parts of a joint that lie where another of its parts may be; `taken` gets a mark for each of them.
std::vector<JointNode> nodes_near_others(const Joint& joint, const std::vector<NodeRecord>& nodes,
                                         const std::vector<double>& boxes, std::vector<char>& taken) {
  std::vector<JointNode> near;
  for (std::size_t i = 0; i < nodes.size(); ++i) {
    const NodeRecord& n = nodes[i];
    if (std::find(joint.parts.begin(), joint.parts.end(), n.part) == joint.parts.end()) continue;
    const bool meets = std::any_of(joint.parts.begin(), joint.parts.end(), [&](std::int32_t p) {
      return p != n.part && is_near_box(&boxes[6 * index(p)], n.position, joint.tolerance);
    });
    if (!meets) continue;
    taken[i] = 1;
    near.push_back({n.id, n.part, {n.position[0], n.position[1], n.position[2]}});
  }
  return near;
}

/// Throws where a part has no node in common with the others of a joint. Collective.
void refuse_loose_parts(const Model& model, const Joint& joint, const std::vector<IdPair>& pairs) {
  std::vector<std::int64_t> met(model.parts.size(), 0);
  for (const IdPair& p : pairs) met[index(p.low_part)] = met[index(p.high_part)] = 1;
  MPI_Allreduce(MPI_IN_PLACE, met.data(), static_cast<int>(met.size()), MPI_INT64_T, MPI_MAX, model.comm);
  std::vector<std::string> errors;
  for (const std::int32_t p : joint.parts)
    if (met[index(p)] == 0)
      errors.push_back(
          fmt::format("{}: error: no node of part {} is within {:.4g} m of a node of another of these parts, so that "
                      "nothing is joined; expected meshes that meet node by node, or a larger `tolerance`",
                      joint.origin, model.parts[index(p)].input->name, joint.tolerance));
  if (!errors.empty()) throw InputError(errors);
}

/// The part that a node was generated for.
std::int32_t part_of_mesh_node(const Model& model, std::int64_t id) {
  const auto at = std::upper_bound(model.parts.begin(), model.parts.end(), id,
                                   [](std::int64_t wanted, const PartModel& p) { return wanted < p.first_node; });
  return static_cast<std::int32_t>(at - model.parts.begin()) - 1;
}

/// Where a node of the parts' meshes stands once its part is placed [m].
Vec3 placed_node(const Model& model, std::int64_t id) {
  const PartModel& part = model.parts[index(part_of_mesh_node(model, id))];
  return part.placement->apply(part.input->mesh->node(id - part.first_node));
}

/// Pairs of nodes of a bundle that are one node of the mesh that their parts are taken from; `taken` gets a mark for
/// each. Throws where two parts place the same node differently. Collective.
std::vector<IdPair> nodes_of_whole_meshes(const Model& model, const std::vector<NodeRecord>& nodes,
                                          std::vector<char>& taken) {
  std::vector<IdPair> pairs;
  std::string trouble;
  for (const CommonNodes& common : common_nodes(model))
    for (std::size_t k = 0; k < nodes.size(); ++k) {
      const NodeRecord& n = nodes[k];
      if (!std::binary_search(common.parts.begin(), common.parts.end(), n.part)) continue;
      const PartModel& part = model.parts[index(n.part)];
      const auto node = static_cast<std::size_t>(part.input->mesh->node_of_whole(n.id - part.first_node));
      if (common.is_shared[node] == 0) continue;
      taken[k] = 1;
      const std::int64_t first = common.first[node];
      if (first == n.id) continue;
      pairs.push_back({first, n.id, part_of_mesh_node(model, first), n.part});
      if (trouble.empty() && norm(placed_node(model, first) - placed_node(model, n.id)) > 0.0)
        trouble = fmt::format(
            "{}: error: parts {} and {} share node {} of their file and place it differently; expected "
            "the same `placement` and `unit`",
            part.input->mesh->origin, model.parts[index(pairs.back().low_part)].input->name, part.input->name,
            part.input->mesh->node_label(n.id - part.first_node));
    }
  if (trouble = first_text(model.comm, trouble); !trouble.empty()) throw InputError({trouble});
  return pairs;
}

/// Throws where two nodes of one part became one, which makes cells of no volume. Collective.
void refuse_folded_parts(const Model& model, const std::vector<Joint>& joints) {
  const MergedIds& ids = model.shared.ids;
  const auto n_ranks = static_cast<std::size_t>(model.n_ranks());
  struct Member {
    std::int64_t survivor, part;
    auto operator<=>(const Member&) const = default;
  };
  std::vector<std::vector<Member>> outgoing(n_ranks);
  for (const MergedIds::Merged& m : ids.merged())
    outgoing[static_cast<std::size_t>(m.survivor) % n_ranks].push_back({m.survivor, part_of_mesh_node(model, m.id)});
  std::vector<Member> members;
  for (const auto& list : all_to_all(model.comm, outgoing)) members.insert(members.end(), list.begin(), list.end());
  std::sort(members.begin(), members.end());
  const std::size_t n_merged = members.size();
  for (std::size_t i = 0; i < n_merged; ++i)
    if (i == 0 || members[i].survivor != members[i - 1].survivor)
      members.push_back({members[i].survivor, part_of_mesh_node(model, members[i].survivor)});
  std::sort(members.begin(), members.end());
  std::vector<std::int64_t> n_folded(model.parts.size(), 0);
  for (std::size_t i = 1; i < members.size(); ++i)
    if (members[i] == members[i - 1]) ++n_folded[static_cast<std::size_t>(members[i].part)];
  MPI_Allreduce(MPI_IN_PLACE, n_folded.data(), static_cast<int>(n_folded.size()), MPI_INT64_T, MPI_SUM, model.comm);
  std::vector<std::string> errors;
  for (std::size_t p = 0; p < n_folded.size(); ++p) {
    if (n_folded[p] == 0) continue;
    const auto at = std::find_if(joints.begin(), joints.end(), [&](const Joint& j) {
      return std::find(j.parts.begin(), j.parts.end(), static_cast<std::int32_t>(p)) != j.parts.end();
    });
    errors.push_back(fmt::format(
        "{}: error: nodes of part {} would become one node of its own, {} of them; expected a "
        "smaller `tolerance`",
        at == joints.end() ? model.parts[p].input->mesh->origin : at->origin, model.parts[p].input->name, n_folded[p]));
  }
  if (!errors.empty()) throw InputError(errors);
}

/// What a node says of itself to all that are merged with it, and the answer.
struct Claim {
  std::int64_t id = 0, old_id = 0;
  std::int64_t membership = 0, is_merged = 0;
  double position[3] = {};
};

/// Tells the taken nodes of all ranks what they have become. The claims come back in the order of this rank's taken
/// nodes; model.memberships gets the new combinations. Collective.
std::vector<std::vector<Claim>> settle(Model& model, std::vector<std::vector<Claim>> claims) {
  auto incoming = all_to_all(model.comm, claims);
  std::vector<Claim*> sorted;
  for (auto& list : incoming)
    for (Claim& c : list) sorted.push_back(&c);
  std::sort(sorted.begin(), sorted.end(),
            [](const Claim* a, const Claim* b) { return std::tie(a->id, a->old_id) < std::tie(b->id, b->old_id); });
  const Memberships before = model.memberships;
  std::vector<Membership> found = model.rank() == 0 ? before.all() : std::vector<Membership>{}, of_claims;
  for (std::size_t i = 0, end = 0; i < sorted.size(); i = end) {
    Membership all;
    for (end = i; end < sorted.size() && sorted[end]->id == sorted[i]->id; ++end)
      all = joined(all, before[static_cast<std::int32_t>(sorted[end]->membership)]);
    const bool is_merged = sorted[end - 1]->old_id != sorted[i]->old_id;
    for (std::size_t k = i; k < end; ++k) {
      std::copy_n(sorted[i]->position, 3, sorted[k]->position);
      sorted[k]->is_merged = is_merged ? 1 : 0;
      sorted[k]->membership = static_cast<std::int64_t>(of_claims.size());
    }
    found.push_back(all);
    of_claims.push_back(std::move(all));
  }
  model.memberships = Memberships(model.comm, found);
  for (Claim* c : sorted)
    c->membership = model.memberships.number_of(of_claims[static_cast<std::size_t>(c->membership)]);
  return all_to_all(model.comm, incoming);
}

/// Gives all nodes of a bundle their new ids, and the taken ones what they have become. Returns the new ids of
/// the nodes that have moved. Collective.
std::vector<std::int64_t> renumber_nodes(Model& model, std::vector<NodeRecord>& nodes, const std::vector<char>& taken,
                                         const std::vector<std::int64_t>& new_ids) {
  const auto n_ranks = static_cast<std::size_t>(model.n_ranks());
  const Memberships before = model.memberships;
  std::vector<std::vector<Claim>> claims(n_ranks);
  for (std::size_t i = 0; i < nodes.size(); ++i) {
    if (taken[i] == 0) continue;
    Claim c{new_ids[i], nodes[i].id, nodes[i].membership, 0, {}};
    std::copy_n(nodes[i].position, 3, c.position);
    claims[static_cast<std::size_t>(c.id) % n_ranks].push_back(c);
  }
  const auto answers = settle(model, std::move(claims));
  std::vector<std::size_t> next(n_ranks, 0);
  std::vector<std::int64_t> moved;
  for (std::size_t i = 0; i < nodes.size(); ++i) {
    NodeRecord& n = nodes[i];
    n.id = new_ids[i];
    if (taken[i] == 0) {
      n.membership = model.memberships.number_of(before[n.membership]);
      continue;
    }
    const auto home = static_cast<std::size_t>(n.id) % n_ranks;
    const Claim& c = answers[home][next[home]++];
    n.membership = static_cast<std::int32_t>(c.membership);
    n.part = model.memberships[n.membership].parts.front();
    if (std::equal(c.position, c.position + 3, n.position)) continue;
    std::copy_n(c.position, 3, n.position);
    std::copy_n(c.position, 3, n.reference);
    moved.push_back(n.id);
  }
  std::sort(moved.begin(), moved.end());
  return moved;
}

/// Gives the elements of a bundle the new ids of their nodes.
void renumber_corners(const Model& model, ModelBundle& bundle, const std::vector<std::int64_t>& new_ids) {
  std::vector<std::pair<std::int64_t, std::int64_t>> number;  // old and new id
  number.reserve(new_ids.size());
  for (std::size_t i = 0; i < new_ids.size(); ++i) number.emplace_back(bundle.nodes[i].id, new_ids[i]);
  std::sort(number.begin(), number.end());
  for (std::size_t p = 0; p < bundle.parts.size(); ++p)
    for (ElementNodeIds& corners : bundle.parts[p].nodes)
      for (int k = 0; k < model.parts[p].store->n_nodes(); ++k) {
        std::int64_t& id = corners[static_cast<std::size_t>(k)];
        id = std::lower_bound(number.begin(), number.end(), std::pair(id, std::int64_t{-1}))->second;
      }
}

/// Sums the entries of each node and part, and sorts them.
struct Quanta64 {
  std::int64_t node, part, quanta;
};
void add_up(std::vector<Quanta64>& list) {
  std::sort(list.begin(), list.end(),
            [](const Quanta64& a, const Quanta64& b) { return std::tie(a.node, a.part) < std::tie(b.node, b.part); });
  std::size_t n = 0;
  for (const Quanta64& q : list) {
    if (n > 0 && list[n - 1].node == q.node && list[n - 1].part == q.part)
      list[n - 1].quanta += q.quanta;
    else
      list[n++] = q;
  }
  list.resize(n);
}

auto shares_from(const std::vector<NodeShare>& shares, std::int64_t node) {
  return std::lower_bound(shares.begin(), shares.end(), node,
                          [](const NodeShare& s, std::int64_t wanted) { return s.node < wanted; });
}

/// Velocity of a shared node: what its parts have in common, or the mean of theirs, weighted by mass [m/s].
Vec3 common_velocity(const Model& model, std::int64_t node) {
  const std::vector<NodeShare>& shares = model.shared.shares;
  auto at = shares_from(shares, node);
  const Vec3 first = model.parts[index(at->part)].input->velocity;
  bool differ = false;
  double mass = 0.0;
  Vec3 momentum;
  for (; at != shares.end() && at->node == node; ++at) {
    const Vec3 v = model.parts[index(at->part)].input->velocity;
    for (int d = 0; d < 3; ++d) differ = differ || v[d] != first[d];
    mass += at->mass;
    momentum = momentum + v * at->mass;
  }
  return differ ? momentum * (1.0 / mass) : first;
}

}  // namespace

std::int64_t SharedNodes::before_joining(std::int64_t id) const {
  // Up to the k-th merged number, k of its number less are left: these differences ascend, too.
  std::size_t low = 0, high = merged.size();
  while (low < high) {
    const std::size_t middle = low + (high - low) / 2;
    if (merged[middle] - static_cast<std::int64_t>(middle) <= id)
      low = middle + 1;
    else
      high = middle;
  }
  return id + static_cast<std::int64_t>(low);
}

void number_bodies(Model& model) {
  std::vector<std::vector<std::int32_t>> groups;  // of parts that are joined
  for (const auto& joint : model.input->joined) {
    groups.emplace_back();
    for (const std::string& name : joint->parts) groups.back().push_back(part_named(model, name));
  }
  for (const auto& [first, second] : parts_with_common_nodes(model)) groups.push_back({first, second});
  model.set_joined_parts(!groups.empty());
  const auto n = static_cast<std::int32_t>(model.parts.size());
  for (std::int32_t p = 0; p < n; ++p) model.parts[index(p)].body = p;
  for (bool changed = true; changed;) {
    changed = false;
    for (const std::vector<std::int32_t>& group : groups) {
      std::int32_t lowest = n;
      for (const std::int32_t p : group) lowest = std::min(lowest, model.parts[index(p)].body);
      for (const std::int32_t p : group) {
        changed = changed || model.parts[index(p)].body != lowest;
        model.parts[index(p)].body = lowest;
      }
    }
  }
  // Numbers of elements, body by body.
  std::int64_t next = 0;
  for (std::int32_t body = 0; body < n; ++body)
    for (PartModel& part : model.parts) {
      if (part.body != body) continue;
      part.shift_in_body = next - part.first_element;
      next += part.n_elements;
    }
}

std::vector<std::int64_t> join_parts(Model& model, ModelBundle& bundle, const std::vector<double>& shortest_edges) {
  const std::vector<Joint> joints = resolve_joints(model, shortest_edges);
  const std::vector<double> boxes = boxes_of_parts(model, bundle.nodes);
  std::vector<char> taken(bundle.nodes.size(), 0);
  std::vector<IdPair> pairs = nodes_of_whole_meshes(model, bundle.nodes, taken);
  for (const Joint& joint : joints) {
    const std::vector<JointNode> near = nodes_near_others(joint, bundle.nodes, boxes, taken);
    const std::vector<IdPair> found = coincident_nodes(model.comm, near, joint.tolerance, joint.cube);
    refuse_loose_parts(model, joint, found);
    pairs.insert(pairs.end(), found.begin(), found.end());
  }
  MergedIds& ids = model.shared.ids;
  ids = MergedIds(model.comm, model.n_nodes, pairs);
  refuse_folded_parts(model, joints);
  if (has_labels(model)) model.shared.merged = ids.all_merged(model.comm);
  std::vector<std::int64_t> old_ids, firsts;
  for (const NodeRecord& n : bundle.nodes) old_ids.push_back(n.id);
  const std::vector<std::int64_t> new_ids = ids.resolve(model.comm, old_ids);
  renumber_corners(model, bundle, new_ids);
  for (const PartModel& part : model.parts) firsts.push_back(part.first_node);
  firsts = ids.n_survivors_below(model.comm, firsts);
  for (std::size_t p = 0; p < model.parts.size(); ++p) model.parts[p].first_own_node = firsts[p];
  model.n_nodes -= ids.n_merged();
  return renumber_nodes(model, bundle.nodes, taken, new_ids);
}

void share_nodes(Model& model, double quantum, const std::function<std::int64_t(std::size_t, int, int)>& share) {
  const auto n_ranks = static_cast<std::size_t>(model.n_ranks());
  std::vector<Quanta64> given;
  for (std::size_t p = 0; p < model.parts.size(); ++p) {
    const PartStore& store = *model.parts[p].store;
    for (int s = 0; s < store.n_slots(); ++s)
      for (int k = 0; store.live(s) && k < store.n_nodes(); ++k) {
        const std::int32_t i = store.node(s, k);
        if (model.memberships.is_shared(model.nodes.membership[i]))
          given.push_back({model.nodes.id[i], static_cast<std::int64_t>(p), share(p, s, k)});
      }
  }
  add_up(given);
  std::vector<std::vector<Quanta64>> outgoing(n_ranks);
  for (const Quanta64& q : given) outgoing[static_cast<std::size_t>(q.node) % n_ranks].push_back(q);
  const auto incoming = all_to_all(model.comm, outgoing);
  std::vector<Quanta64> all;
  for (const auto& list : incoming) all.insert(all.end(), list.begin(), list.end());
  add_up(all);
  model.shared.shares.clear();
  for (const Quanta64& q : all)
    model.shared.shares.push_back({q.node, static_cast<std::int32_t>(q.part), static_cast<double>(q.quanta) * quantum});
  struct Answer {  // to a rank that has the node
    std::int64_t node;
    Vec3 velocity;
  };
  std::vector<std::vector<Answer>> answers(n_ranks);
  for (std::size_t r = 0; r < n_ranks; ++r)
    for (const Quanta64& q : incoming[r])
      if (answers[r].empty() || answers[r].back().node != q.node)
        answers[r].push_back({q.node, common_velocity(model, q.node)});
  for (const auto& list : all_to_all(model.comm, answers))
    for (const Answer& a : list) model.nodes.set_v(model.local_node(a.node), a.velocity);
}

std::vector<NodeShare> shares_of(const Model& model, const std::vector<std::int64_t>& nodes) {
  const auto n_ranks = static_cast<std::size_t>(model.n_ranks());
  std::vector<std::vector<std::int64_t>> questions(n_ranks);
  for (const std::int64_t id : nodes) questions[static_cast<std::size_t>(id) % n_ranks].push_back(id);
  std::vector<std::vector<NodeShare>> answers(n_ranks);
  const auto asked = all_to_all(model.comm, questions);
  for (std::size_t r = 0; r < n_ranks; ++r)
    for (const std::int64_t id : asked[r])
      for (auto at = shares_from(model.shared.shares, id); at != model.shared.shares.end() && at->node == id; ++at)
        answers[r].push_back(*at);
  std::vector<NodeShare> all;
  for (const auto& list : all_to_all(model.comm, answers)) all.insert(all.end(), list.begin(), list.end());
  std::sort(all.begin(), all.end(),
            [](const NodeShare& a, const NodeShare& b) { return std::tie(a.node, a.part) < std::tie(b.node, b.part); });
  return all;
}

}  // namespace kerf
