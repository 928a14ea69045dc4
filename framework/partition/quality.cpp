// Counts what the parts of a partition have and share.
#include "partition/quality.hpp"

#include <algorithm>
#include <cmath>

#include "kerf/collapsed_cell.hpp"
#include "parallel/communicator.hpp"
#include "parallel/fetch_by_id.hpp"

namespace kerf {

namespace {

void add_up(MPI_Comm comm, std::vector<std::int64_t>& counts) {
  MPI_Allreduce(MPI_IN_PLACE, counts.data(), static_cast<int>(counts.size()), MPI_INT64_T, MPI_SUM, comm);
}

template <class T>
void keep_distinct(std::vector<T>& list) {
  std::sort(list.begin(), list.end());
  list.erase(std::unique(list.begin(), list.end()), list.end());
}

/// A node, and a part that has an element at it.
struct Incidence {
  std::int64_t node;
  std::int64_t part;
  auto operator<=>(const Incidence&) const = default;
};

/// On one rank only the incidences of nodes with several parts, on several ranks those of all nodes; each once.
std::vector<Incidence> local_incidences(const Model& model, const std::vector<int>& parts) {
  std::vector<int> first(static_cast<std::size_t>(model.nodes.n()), -1);
  std::vector<Incidence> found;
  std::size_t e = 0;
  for (const PartModel& p : model.parts) {
    const PartStore& store = *p.store;
    for (int s = 0; s < store.n_slots(); ++s) {
      if (!store.live(s)) continue;
      const int part = parts[e++];
      for (int k = 0; k < store.n_nodes(); ++k) {
        const std::int32_t n = store.node(s, k);
        int& seen = first[static_cast<std::size_t>(n)];
        if (seen == part) continue;
        if (seen >= 0) found.push_back({model.nodes.id[n], seen});
        if (seen >= 0 || model.n_ranks() > 1) found.push_back({model.nodes.id[n], part});
        if (seen < 0) seen = part;
      }
    }
  }
  keep_distinct(found);
  return found;
}

/// All incidences of the nodes whose home is this rank, by node. Collective.
std::vector<Incidence> incidences_at_home(const Model& model, const std::vector<int>& parts) {
  std::vector<Incidence> local = local_incidences(model, parts);
  if (model.n_ranks() == 1) return local;
  std::vector<std::vector<Incidence>> outgoing(static_cast<std::size_t>(model.n_ranks()));
  for (const Incidence& i : local) outgoing[static_cast<std::size_t>(i.node % model.n_ranks())].push_back(i);
  std::vector<Incidence> all;
  for (const auto& list : all_to_all(model.comm, outgoing)) all.insert(all.end(), list.begin(), list.end());
  keep_distinct(all);
  return all;
}

void count_nodes(const Model& model, const std::vector<int>& parts, int n_parts, PartitionQuality& q) {
  const std::vector<Incidence> all = incidences_at_home(model, parts);
  std::vector<std::int64_t> pairs;  // first part times the number of parts, plus the second
  std::vector<std::int64_t> totals(2, 0);
  for (std::size_t i = 0, end = 0; i < all.size(); i = end) {
    while (end < all.size() && all[end].node == all[i].node) ++end;
    if (end - i < 2) continue;
    ++totals[0];
    totals[1] += static_cast<std::int64_t>(end - i) - 1;
    for (std::size_t a = i; a < end; ++a) {
      ++q.interface_nodes[static_cast<std::size_t>(all[a].part)];
      for (std::size_t b = i; b < end; ++b)
        if (a != b) pairs.push_back(all[a].part * n_parts + all[b].part);
    }
    // A list of all occurrences would be long; there are few different ones.
    if (pairs.size() > (std::size_t{1} << 22)) keep_distinct(pairs);
  }
  keep_distinct(pairs);
  pairs = gather_to_root(model.comm, pairs);
  keep_distinct(pairs);
  for (const std::int64_t pair : pairs) ++q.neighbours[static_cast<std::size_t>(pair / n_parts)];
  add_up(model.comm, q.interface_nodes);
  add_up(model.comm, q.neighbours);
  add_up(model.comm, totals);
  q.all_interface_nodes = totals[0];
  q.node_copies = totals[1];
}

/// The part of an element on another rank.
struct PartOfElement {
  std::int64_t id;
  std::int64_t part;
  bool operator<(const PartOfElement& other) const { return id < other.id; }
};

/// Neighbours of all live elements of this rank, in compressed rows; the parts are in the places of the ids.
/// Collective.
struct NeighbourParts {
  std::vector<std::size_t> first;
  std::vector<std::int64_t> parts;
};

NeighbourParts parts_of_neighbours(const Model& model, const std::vector<int>& parts) {
  NeighbourParts n;
  std::vector<int> ranks;
  std::vector<PartOfElement> here;
  n.first.push_back(0);
  for (std::size_t p = 0; p < model.parts.size(); ++p) {
    const PartStore& store = *model.parts[p].store;
    for (int s = 0; s < store.n_slots(); ++s) {
      if (!store.live(s)) continue;
      here.push_back({store.id(s), parts[here.size()]});
      model.surface.neighbours(model.surface_mesh(), static_cast<int>(p), s, n.parts, ranks);
      n.first.push_back(n.parts.size());
    }
  }
  std::vector<std::int64_t> elsewhere;
  for (std::size_t k = 0; k < n.parts.size(); ++k)
    if (ranks[k] != model.rank()) elsewhere.push_back(n.parts[k]);
  keep_distinct(elsewhere);
  std::vector<PartOfElement> known = here;
  if (model.n_ranks() > 1) {
    const std::vector<PartOfElement> fetched = fetch_by_id(model.comm, here, elsewhere).wanted;
    known.insert(known.end(), fetched.begin(), fetched.end());
  }
  std::sort(known.begin(), known.end());
  for (std::int64_t& id : n.parts) id = std::lower_bound(known.begin(), known.end(), PartOfElement{id, 0})->part;
  return n;
}

void count_faces(const Model& model, const std::vector<int>& parts, PartitionQuality& q) {
  const NeighbourParts neighbours = parts_of_neighbours(model, parts);
  std::vector<std::int64_t> inner(q.faces.size(), 0);  // seen from both sides
  std::size_t e = 0;
  for (const PartModel& p : model.parts) {
    for (int s = 0; s < p.store->n_slots(); ++s) {
      if (!p.store->live(s)) continue;
      const auto part = static_cast<std::size_t>(parts[e]);
      ElementNodeIds nodes{};
      for (int k = 0; k < p.store->n_nodes(); ++k) nodes[static_cast<std::size_t>(k)] = p.store->node(s, k);
      q.faces[part] += DistinctCell(p.store->shape(), nodes).shape->n_faces;
      for (std::size_t k = neighbours.first[e]; k < neighbours.first[e + 1]; ++k)
        ++(neighbours.parts[k] == parts[e] ? inner : q.interface_faces)[part];
      ++e;
    }
  }
  add_up(model.comm, q.faces);
  add_up(model.comm, q.interface_faces);
  add_up(model.comm, inner);
  for (std::size_t part = 0; part < inner.size(); ++part) {
    q.faces[part] -= inner[part] / 2;
    q.all_faces += q.faces[part];
    q.all_interface_faces += q.interface_faces[part];
  }
  q.all_interface_faces /= 2;
  q.all_faces -= q.all_interface_faces;
}

void add_work(const Model& model, const std::vector<int>& parts, const std::vector<double>& contact_work,
              PartitionQuality& q) {
  // Of a node's work: a power of two, 2^36. A part may have 134 million nodes in contact before its sum overflows.
  constexpr double contact_units = 68719476736.0;
  const std::size_t n_parts = q.elements.size();
  std::vector<std::int64_t> of_body(n_parts), contact(n_parts, 0);
  std::size_t e = 0;
  for (const PartModel& p : model.parts) {
    std::fill(of_body.begin(), of_body.end(), 0);
    for (int s = 0; s < p.store->n_slots(); ++s) {
      if (!p.store->live(s)) continue;
      const auto part = static_cast<std::size_t>(parts[e]);
      ++of_body[part];
      contact[part] += std::llrint(contact_work[e++] * contact_units);
    }
    add_up(model.comm, of_body);
    for (std::size_t part = 0; part < n_parts; ++part) {
      q.elements[part] += of_body[part];
      q.work[part] += p.work * static_cast<double>(of_body[part]);
    }
  }
  add_up(model.comm, contact);
  for (std::size_t part = 0; part < n_parts; ++part)
    q.contact_work[part] = static_cast<double>(contact[part]) / contact_units;
}

}  // namespace

PartitionQuality measure_quality(const Model& model, const std::vector<int>& parts, int n_parts,
                                 const std::vector<double>& contact_work) {
  PartitionQuality q;
  const auto n = static_cast<std::size_t>(n_parts);
  for (auto* counts : {&q.elements, &q.interface_nodes, &q.interface_faces, &q.faces, &q.neighbours})
    counts->assign(n, 0);
  q.work.assign(n, 0.0);
  q.contact_work.assign(n, 0.0);
  add_work(model, parts, contact_work, q);
  count_nodes(model, parts, n_parts, q);
  count_faces(model, parts, q);
  return q;
}

}  // namespace kerf
