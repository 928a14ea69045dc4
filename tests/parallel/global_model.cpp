// Gathering and comparing of all ranks' copies.
#include "parallel/global_model.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cstring>
#include <map>

#include "kerf/shape.hpp"
#include "model/surface.hpp"
#include "parallel/communicator.hpp"

namespace kerf::test {

namespace {

struct Copy {
  NodeRecord record;
  std::int64_t owned = 0, rank = 0;
};

bool same_bits(const NodeRecord& a, const NodeRecord& b) {
  return a.id == b.id && a.membership == b.membership && a.part == b.part && a.free == b.free &&
         std::memcmp(a.reference, b.reference, sizeof(a.reference)) == 0 &&
         std::memcmp(a.position, b.position, sizeof(a.position)) == 0 &&
         std::memcmp(a.velocity, b.velocity, sizeof(a.velocity)) == 0 && a.mass == b.mass &&
         std::memcmp(a.force, b.force, sizeof(a.force)) == 0;
}

void merge_copies(std::vector<Copy> copies, GlobalModel& global) {
  std::sort(copies.begin(), copies.end(), [](const Copy& a, const Copy& b) {
    return a.record.id != b.record.id ? a.record.id < b.record.id : a.rank < b.rank;
  });
  for (std::size_t i = 0; i < copies.size();) {
    std::size_t end = i;
    std::int64_t owners = 0;
    for (; end < copies.size() && copies[end].record.id == copies[i].record.id; ++end) {
      owners += copies[end].owned;
      if (!same_bits(copies[end].record, copies[i].record))
        global.trouble = fmt::format("node {} differs between ranks {} and {}", copies[i].record.id, copies[i].rank,
                                     copies[end].rank);
    }
    if (owners != 1) global.trouble = fmt::format("node {} has {} owners", copies[i].record.id, owners);
    global.nodes.push_back(copies[i].record);
    i = end;
  }
}

}  // namespace

GlobalModel gather_globally(const Model& model) {
  GlobalModel global;
  std::vector<Copy> copies;
  for (int i = 0; i < model.nodes.n(); ++i)
    copies.push_back({model.nodes.record(i), model.nodes.owned[i] != 0 ? 1 : 0, model.rank()});
  merge_copies(gather_to_root(model.comm, copies), global);
  for (std::size_t p = 0; p < model.parts.size(); ++p) {
    const PartStore& store = *model.parts[p].store;
    std::vector<std::int64_t> headers;
    std::vector<double> records;
    for (int s = 0; s < store.n_slots(); ++s) {
      if (!store.live(s)) continue;
      headers.push_back(store.id(s));
      for (int k = 0; k < 8; ++k) headers.push_back(model.nodes.id[store.node(s, k)]);
      records.resize(records.size() + store.record_size());
      store.pack(s, records.data() + records.size() - store.record_size());
    }
    headers = gather_to_root(model.comm, headers);
    records = gather_to_root(model.comm, records);
    for (std::size_t e = 0; 9 * e < headers.size(); ++e) {
      GlobalElement element;
      element.id = headers[9 * e];
      element.part = static_cast<int>(p);
      std::copy_n(headers.begin() + 9 * e + 1, 8, element.nodes.begin());
      const auto at = records.begin() + static_cast<std::ptrdiff_t>(e) * store.record_size();
      element.record.assign(at, at + store.record_size());
      global.elements.push_back(std::move(element));
    }
  }
  std::sort(global.elements.begin(), global.elements.end(), [](const auto& a, const auto& b) { return a.id < b.id; });
  for (std::size_t e = 1; e < global.elements.size(); ++e)
    if (global.elements[e].id == global.elements[e - 1].id)
      global.trouble = fmt::format("element {} is there twice", global.elements[e].id);
  return global;
}

bool GlobalModel::has_node(std::int64_t id) const {
  const auto it =
      std::lower_bound(nodes.begin(), nodes.end(), id, [](const NodeRecord& n, std::int64_t v) { return n.id < v; });
  return it != nodes.end() && it->id == id;
}

const NodeRecord& GlobalModel::node(std::int64_t id) const {
  return *std::lower_bound(nodes.begin(), nodes.end(), id,
                           [](const NodeRecord& n, std::int64_t v) { return n.id < v; });
}

const GlobalElement& GlobalModel::element(std::int64_t id) const {
  return *std::lower_bound(elements.begin(), elements.end(), id,
                           [](const GlobalElement& e, std::int64_t v) { return e.id < v; });
}

Vec3 GlobalModel::x(std::int64_t node_id) const {
  const NodeRecord& n = node(node_id);
  return {n.position[0], n.position[1], n.position[2]};
}

std::set<GlobalFacet> GlobalModel::exterior() const {
  std::map<std::array<std::int64_t, 4>, std::vector<GlobalFacet>> faces;
  for (const GlobalElement& e : elements)
    for (int f = 0; f < 6; ++f) {
      std::array<std::int64_t, 4> key{};
      for (int k = 0; k < 4; ++k) key[k] = e.nodes[hexahedron.face[f][k]];
      std::sort(key.begin(), key.end());
      faces[key].push_back({e.id, f});
    }
  std::set<GlobalFacet> result;
  for (const auto& [key, sides] : faces)
    if (sides.size() == 1) result.insert(sides.front());
  return result;
}

std::set<GlobalFacet> gather_exterior(Model& model, std::int64_t& n_listed) {
  std::vector<GlobalFacet> local;
  for (const ExteriorFacet& f : model.surface.exterior(model.surface_mesh()))
    local.push_back({model.parts[f.part].store->id(f.slot), f.face});
  const std::vector<GlobalFacet> all = gather_to_root(model.comm, local);
  n_listed = static_cast<std::int64_t>(all.size());
  return {all.begin(), all.end()};
}

}  // namespace kerf::test
