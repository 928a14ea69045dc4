// Shows a model to measures, rank by rank.
#include "report/measure_share.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <stdexcept>
#include <unordered_map>

#include "model/joining.hpp"
#include "parallel/communicator.hpp"

namespace kerf {

namespace {

using Key = MeasureRanks::Key;

struct KeyHash {
  std::size_t operator()(const Key& key) const {
    std::uint64_t h = 0;
    for (const std::int64_t k : key) {
      h = (h ^ static_cast<std::uint64_t>(k)) * 0x9e3779b97f4a7c15u;
      h ^= h >> 29;
    }
    return static_cast<std::size_t>(h);
  }
};

struct KeyedValue {
  Key key;
  std::int64_t value;
};

/// What parts give to the nodes that they share; known for nodes that this rank owns. Collective.
void add_shares(const Model& model, MeasureModel& m) {
  if (!model.has_joined_parts()) return;
  std::vector<std::int64_t> shared;
  for (int i = 0; i < model.nodes.n(); ++i) {
    if (!model.memberships.is_shared(model.nodes.membership[i])) continue;
    MeasureModel::Node& node = m.nodes[static_cast<std::size_t>(i)];
    node.first_share = static_cast<std::int32_t>(m.shares.size());
    for (const std::int32_t part : model.parts_of(i)) m.shares.push_back({node.id, part, 0.0});
    if (node.owned) shared.push_back(node.id);
  }
  for (const NodeShare& s : shares_of(model, shared)) {
    const MeasureModel::Node& node = m.nodes[static_cast<std::size_t>(model.local_node(s.node))];
    for (auto k = static_cast<std::size_t>(node.first_share); k < m.shares.size() && m.shares[k].node == s.node; ++k)
      if (m.shares[k].part == s.part) {
        m.shares[k].mass = s.mass;
        break;
      }
  }
}

void add_nodes(const Model& model, MeasureModel& m) {
  const NodeStore& nodes = model.nodes;
  m.nodes.reserve(static_cast<std::size_t>(nodes.n()));
  for (int i = 0; i < nodes.n(); ++i)
    m.nodes.push_back({nodes.id[i], nodes.part[i], nodes.free[i] != 0, nodes.mass[i], nodes.reference_position(i),
                       nodes.x(i), nodes.v(i), -1, nodes.owned[i] != 0, nodes.owned[i] == 0});
  // Owners know which of their nodes others have.
  if (model.ghost_plan)
    for (const std::int32_t i : model.ghost_plan->sources())
      if (i >= 0) m.nodes[static_cast<std::size_t>(i)].copied = true;
}

void add_elements(const Model& model, MeasureModel& m) {
  m.elements.reserve(static_cast<std::size_t>(model.n_live_local()));
  for (std::size_t p = 0; p < model.parts.size(); ++p) {
    const PartStore& store = *model.parts[p].store;
    for (int s = 0; s < store.n_slots(); ++s) {
      if (!store.live(s)) continue;
      MeasureModel::Element e{
          store.id(s), static_cast<int>(p), store.field(PartStore::mass).at(s, 0), {}, &store.shape()};
      for (int k = 0; k < store.n_nodes(); ++k) e.nodes[static_cast<std::size_t>(k)] = store.node(s, k);
      m.elements.push_back(e);
    }
  }
}

/// Throws where a measure has made a mistake. To be called before ranks meet: afterwards the others would wait.
void require_as_many(const std::vector<Key>& keys, const std::vector<std::int64_t>& values) {
  if (keys.size() != values.size())
    throw std::runtime_error(fmt::format("{} keys have {} values; expected one for each", keys.size(), values.size()));
}

/// This rank's share of n things.
std::pair<std::int64_t, std::int64_t> share_of(std::int64_t n, const Model& model) {
  return {n * model.rank() / model.n_ranks(), n * (model.rank() + 1) / model.n_ranks()};
}

}  // namespace

MeasureModel measure_share(const Model& model) {
  MeasureModel m;
  for (const PartModel& p : model.parts) {
    m.parts.push_back(p.input->name);
    m.initial_mass.push_back(p.initial_mass);
  }
  add_nodes(model, m);
  add_shares(model, m);
  add_elements(model, m);
  return m;
}

std::vector<double> MeasuringRanks::sums(const std::vector<std::span<const double>>& lists) {
  return meeting_.add_up(lists);
}

std::vector<double> MeasuringRanks::greatest(std::vector<double> values) {
  return meeting_.greatest_of(std::move(values));
}

std::vector<double> MeasuringRanks::least(std::vector<double> values) { return meeting_.least_of(std::move(values)); }

/// Each key has a rank where its values meet. Collective.
std::vector<std::int64_t> MeasuringRanks::combine(const std::vector<Key>& keys, const std::vector<std::int64_t>& values,
                                                  const std::function<void(std::int64_t&, std::int64_t)>& join) const {
  const auto n = static_cast<std::size_t>(model_.n_ranks());
  std::vector<std::vector<KeyedValue>> asked(n);
  for (std::size_t i = 0; i < keys.size(); ++i) asked[KeyHash()(keys[i]) % n].push_back({keys[i], values[i]});
  const std::vector<std::vector<KeyedValue>> met = all_to_all(model_.comm, std::move(asked));
  std::unordered_map<Key, std::int64_t, KeyHash> found;
  for (const std::vector<KeyedValue>& of_rank : met)
    for (const KeyedValue& k : of_rank)
      if (const auto [at, is_new] = found.try_emplace(k.key, k.value); !is_new) join(at->second, k.value);
  std::vector<std::vector<std::int64_t>> answers(n);
  for (std::size_t r = 0; r < n; ++r)
    for (const KeyedValue& k : met[r]) answers[r].push_back(found.at(k.key));
  answers = all_to_all(model_.comm, std::move(answers));
  std::vector<std::size_t> next(n, 0);
  std::vector<std::int64_t> combined;
  combined.reserve(keys.size());
  for (const Key& key : keys) {
    const std::size_t r = KeyHash()(key) % n;
    combined.push_back(answers[r][next[r]++]);
  }
  return combined;
}

std::vector<std::int64_t> MeasuringRanks::least_by_key(const std::vector<Key>& keys,
                                                       const std::vector<std::int64_t>& values) {
  require_as_many(keys, values);
  meeting_.come_to(MeetingPoint::least_by_key);
  return combine(keys, values, [](std::int64_t& a, std::int64_t b) { a = std::min(a, b); });
}

std::vector<std::int64_t> MeasuringRanks::sums_by_key(const std::vector<Key>& keys,
                                                      const std::vector<std::int64_t>& values) {
  require_as_many(keys, values);
  meeting_.come_to(MeetingPoint::sums_by_key);
  return combine(keys, values, [](std::int64_t& a, std::int64_t b) { a += b; });
}

std::vector<char> MeasuringRanks::bytes_on_root(const std::vector<char>& bytes) {
  meeting_.come_to(MeetingPoint::bytes_on_root);
  return gather_to_root(model_.comm, bytes);
}

const PartModel& MeasuringRanks::part_of(int part) const {
  if (part < 0 || part >= static_cast<int>(model_.parts.size()))
    throw std::runtime_error(fmt::format("there is no part {}", part));
  return model_.parts[static_cast<std::size_t>(part)];
}

std::vector<Vec3> MeasuringRanks::undeformed_nodes(int part) {
  const PartModel& p = part_of(part);
  const auto [first, last] = share_of(p.n_nodes, model_);
  std::vector<Vec3> places;
  places.reserve(static_cast<std::size_t>(last - first));
  for (std::int64_t i = first; i < last; ++i) places.push_back(p.placement->apply(p.input->mesh->node(i)));
  return places;
}

const Shape& MeasuringRanks::shape(int part) const { return part_of(part).store->shape(); }

void MeasuringRanks::visit_undeformed(int part, const std::function<void(const UndeformedElement&)>& visit) {
  const PartModel& p = part_of(part);  // throws before the ranks meet: afterwards the others would wait
  meeting_.come_to(MeetingPoint::visit_undeformed);
  const MeshGenerator& mesh = *p.input->mesh;
  const auto n_nodes = static_cast<std::size_t>(shape(part).n_nodes);
  const auto [first, last] = share_of(p.n_elements, model_);
  std::vector<std::int64_t> ids;  // of the mesh, then of the model
  for (std::int64_t e = first; e < last; ++e) {
    const ElementNodeIds corners = mesh.element(e);
    for (std::size_t k = 0; k < n_nodes; ++k) ids.push_back(p.first_node + corners[k]);
  }
  if (model_.has_joined_parts()) ids = model_.shared.ids.resolve(model_.comm, ids);
  auto next = ids.begin();
  for (std::int64_t e = first; e < last; ++e) {
    UndeformedElement element;
    element.id = p.first_element + e;
    const ElementNodeIds corners = mesh.element(e);
    for (std::size_t k = 0; k < n_nodes; ++k) {
      element.nodes[k] = *next++;
      element.places[k] = p.placement->apply(mesh.node(corners[k]));
    }
    visit(element);
  }
}

}  // namespace kerf
