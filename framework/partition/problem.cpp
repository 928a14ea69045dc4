// Lists elements with their work, neighbours and nodes.
#include "partition/problem.hpp"

#include <fmt/format.h>

#include "core/diagnostics.hpp"
#include "core/physics_error.hpp"
#include "model/copies.hpp"
#include "model/node_group.hpp"
#include "parallel/communicator.hpp"

namespace kerf {

namespace {

/// What moves with an element: its record, its id, and the ids of its nodes.
std::int32_t record_bytes_of(const PartStore& store) {
  const std::size_t header = sizeof(std::int64_t) * (1 + Shape::most_nodes);
  return static_cast<std::int32_t>(header + sizeof(double) * static_cast<std::size_t>(store.record_size()));
}

/// The nodes that any contact definition brings into contact.
class ContactNodes {
 public:
  explicit ContactNodes(const Model& model) {
    for (const auto& law : model.input->contacts) {
      const ContactRequest request = law->request();
      groups_.emplace_back(model, request.slaves);
      groups_.emplace_back(model, request.masters);
    }
  }
  bool hold(const NodeStore& nodes, std::int32_t node) const {
    for (const NodeGroup& group : groups_)
      if (group.holds(nodes, node)) return true;
    return false;
  }

 private:
  std::vector<NodeGroup> groups_;
};

/// Throws, on all ranks, where a partitioner has not answered for each element with a part that was asked for.
void refuse_wrong_parts(const Partitioner& partitioner, const PartitionProblem& problem,
                        const std::vector<int>& parts) {
  std::string trouble;
  if (parts.size() != problem.ids.size())
    trouble = fmt::format("the partitioner `{}` returns {} parts for {} elements; expected one for each",
                          partitioner.type, parts.size(), problem.ids.size());
  for (std::size_t i = 0; i < parts.size() && trouble.empty(); ++i)
    if (parts[i] < 0 || parts[i] >= problem.n_parts)
      trouble = fmt::format("the partitioner `{}` gives element {} to part {}; expected a part from 0 to {}",
                            partitioner.type, problem.ids[i], parts[i], problem.n_parts - 1);
  if (const std::string first = first_text(problem.comm, trouble); !first.empty()) throw PhysicsError(first);
}

}  // namespace

std::vector<double> contact_work(Model& model, const std::vector<double>& node_work) {
  const ContactNodes surface(model);
  const std::vector<ExteriorFacet>& facets = model.surface.exterior(model.surface_mesh());
  // Exterior faces round each node, on all ranks together. A triangle repeats a corner, which counts once.
  std::vector<std::int64_t> n_faces(static_cast<std::size_t>(model.nodes.n()) + NodeStore::n_dummies, 0);
  const auto is_repeated = [](const ExteriorFacet& f, std::size_t k) {
    for (std::size_t j = 0; j < k; ++j)
      if (f.nodes[j] == f.nodes[k]) return true;
    return false;
  };
  for (const ExteriorFacet& f : facets)
    for (std::size_t k = 0; k < f.nodes.size(); ++k)
      if (!is_repeated(f, k)) ++n_faces[static_cast<std::size_t>(f.nodes[k])];
  sum_over_copies(model, n_faces.data(), 1);
  std::vector<std::vector<double>> of_slot;
  for (const PartModel& part : model.parts) of_slot.emplace_back(static_cast<std::size_t>(part.store->n_slots()), 0.0);
  for (const ExteriorFacet& f : facets)
    for (std::size_t k = 0; k < f.nodes.size(); ++k)
      if (!is_repeated(f, k) && surface.hold(model.nodes, f.nodes[k]))
        of_slot[static_cast<std::size_t>(f.part)][static_cast<std::size_t>(f.slot)] +=
            (node_work.empty() ? 1.0 : node_work[static_cast<std::size_t>(f.nodes[k])]) /
            static_cast<double>(n_faces[static_cast<std::size_t>(f.nodes[k])]);
  std::vector<double> work;
  for (std::size_t p = 0; p < model.parts.size(); ++p)
    for (int s = 0; s < model.parts[p].store->n_slots(); ++s)
      if (model.parts[p].store->live(s)) work.push_back(of_slot[p][static_cast<std::size_t>(s)]);
  return work;
}

std::vector<double> element_work(Model& model, const std::vector<std::int64_t>& n_candidates) {
  std::vector<double> work;
  for (const PartModel& part : model.parts)
    work.insert(work.end(), static_cast<std::size_t>(part.store->n_live()), part.work);
  if (!model.input->balance.has_contact_with_elements() || model.input->contacts.empty()) return work;
  const std::size_t n = static_cast<std::size_t>(model.nodes.n()) + NodeStore::n_dummies;
  std::vector<std::int64_t> candidates = n_candidates;
  candidates.resize(n, 0);
  copy_to_ghosts(model, candidates.data(), 1);
  std::vector<double> node_work;
  for (const std::int64_t of_node : candidates)
    node_work.push_back(model.input->balance.work.of_contact(static_cast<double>(of_node)));
  const std::vector<double> contact = contact_work(model, node_work);
  for (std::size_t e = 0; e < work.size(); ++e) work[e] += contact[e];
  return work;
}

PartitionProblem problem_of(Model& model, const Partitioner& partitioner, int n_parts,
                            std::optional<std::vector<double>> work) {
  if (!work) work = element_work(model, {});
  PartitionProblem problem;
  problem.comm = model.comm;
  problem.n_parts = n_parts;
  problem.n_elements = model.n_elements;
  const bool graph = partitioner.needs_graph(), nodes = partitioner.needs_nodes();
  if (graph) problem.first.push_back(0);
  if (nodes) problem.first_node.push_back(0);
  std::vector<double> contact;
  if (partitioner.needs_contact_work()) {
    problem.n_weights = 2;
    contact = contact_work(model);
  }
  for (std::size_t p = 0; p < model.parts.size(); ++p) {
    const PartStore& store = *model.parts[p].store;
    for (int s = 0; s < store.n_slots(); ++s) {
      if (!store.live(s)) continue;
      problem.ids.push_back(store.id(s));
      Vec3 centre;
      for (int k = 0; k < store.n_nodes(); ++k) centre = centre + model.nodes.x(store.node(s, k));
      centre = centre * (1.0 / store.n_nodes());
      problem.coordinates.insert(problem.coordinates.end(), {centre.x, centre.y, centre.z});
      problem.weights.push_back((*work)[problem.ids.size() - 1]);
      if (!contact.empty()) problem.weights.push_back(contact[problem.ids.size() - 1]);
      problem.record_bytes.push_back(record_bytes_of(store));
      if (graph) {
        model.surface.neighbours(model.surface_mesh(), static_cast<int>(p), s, problem.neighbours,
                                 problem.neighbour_ranks);
        problem.first.push_back(static_cast<std::int64_t>(problem.neighbours.size()));
      }
      if (nodes) {
        for (int k = 0; k < store.n_nodes(); ++k) problem.nodes.push_back(model.nodes.id[store.node(s, k)]);
        problem.first_node.push_back(static_cast<std::int64_t>(problem.nodes.size()));
      }
    }
  }
  return problem;
}

std::vector<int> find_parts(Partitioner& partitioner, const PartitionProblem& problem) {
  if (const std::vector<std::string> lines = partitioner.complaints(problem); !lines.empty()) throw InputError(lines);
  std::vector<int> parts = partitioner.partition(problem);
  refuse_wrong_parts(partitioner, problem, parts);
  return parts;
}

}  // namespace kerf
