// Packing, sending, ordering and numbering of elements and nodes.
#include "model/migrator.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>

#include "core/assert.hpp"
#include "parallel/communicator.hpp"
#include "parallel/ownership.hpp"

namespace kerf {

namespace {

/// Position of an id in a sorted list of records: a table where the ids are dense, bisection where not.
class RecordIndex {
 public:
  explicit RecordIndex(const std::vector<NodeRecord>& sorted) : sorted_(sorted) {
    if (sorted.empty()) return;
    low_ = sorted.front().id;
    const std::int64_t span = sorted.back().id - low_ + 1;
    if (span > static_cast<std::int64_t>(4 * sorted.size()) + 1024) return;
    table_.assign(static_cast<std::size_t>(span), -1);
    for (std::size_t i = 0; i < sorted.size(); ++i) table_[sorted[i].id - low_] = static_cast<std::int32_t>(i);
  }
  std::int32_t operator()(std::int64_t id) const {
    if (!table_.empty()) return table_[id - low_];
    const auto it = std::lower_bound(sorted_.begin(), sorted_.end(), id,
                                     [](const NodeRecord& r, std::int64_t v) { return r.id < v; });
    return static_cast<std::int32_t>(it - sorted_.begin());
  }

 private:
  const std::vector<NodeRecord>& sorted_;
  std::int64_t low_ = 0;
  std::vector<std::int32_t> table_;
};

std::uint64_t spread_bits(std::uint64_t v) {
  v &= 0x1fffff;
  v = (v | v << 32) & 0x1f00000000ffffULL;
  v = (v | v << 16) & 0x1f0000ff0000ffULL;
  v = (v | v << 8) & 0x100f00f00f00f00fULL;
  v = (v | v << 4) & 0x10c30c30c30c30c3ULL;
  v = (v | v << 2) & 0x1249249249249249ULL;
  return v;
}

/// Order of elements along a Morton curve through their centres, so that neighbours share cache lines.
std::vector<std::int32_t> curve_order(const ElementBundle& part, const std::vector<NodeRecord>& nodes,
                                      const RecordIndex& index, int n_nodes) {
  const std::size_t n = part.ids.size();
  std::vector<Vec3> centre(n);
  Vec3 low{1e300, 1e300, 1e300}, high{-1e300, -1e300, -1e300};
  for (std::size_t e = 0; e < n; ++e) {
    Vec3 sum;
    for (int k = 0; k < n_nodes; ++k) {
      const double* x = nodes[index(part.nodes[e][static_cast<std::size_t>(k)])].position;
      sum = sum + Vec3{x[0], x[1], x[2]};
    }
    centre[e] = sum * (1.0 / n_nodes);
    for (int d = 0; d < 3; ++d) {
      low[d] = std::min(low[d], centre[e][d]);
      high[d] = std::max(high[d], centre[e][d]);
    }
  }
  const double edge = std::max({high.x - low.x, high.y - low.y, high.z - low.z, 1e-300});
  std::vector<std::pair<std::uint64_t, std::int32_t>> keys(n);
  for (std::size_t e = 0; e < n; ++e) {
    std::uint64_t code = 0;
    for (int d = 0; d < 3; ++d)
      code |= spread_bits(static_cast<std::uint64_t>((centre[e][d] - low[d]) / edge * 2097151.0)) << d;
    keys[e] = {code, static_cast<std::int32_t>(e)};
  }
  std::sort(keys.begin(), keys.end());
  std::vector<std::int32_t> order(n);
  for (std::size_t e = 0; e < n; ++e) order[e] = keys[e].second;
  return order;
}

void build_ghost_plan(Model& model) {
  const NodeStore& nodes = model.nodes;
  const Ownership ownership = agree_on_owners(model.comm, nodes.id);
  model.node_owner = ownership.owner;
  model.ghosts.clear();
  model.ghost_plan.reset();
  for (int i = 0; i < nodes.n(); ++i) model.nodes.owned[i] = ownership.owner[i] == model.rank() ? 1 : 0;
  if (model.n_ranks() == 1) return;
  std::vector<Needed> needed;
  for (int i = 0; i < nodes.n(); ++i)
    if (!nodes.owned[i]) {
      needed.push_back({nodes.id[i], ownership.owner[i]});
      model.ghosts.push_back(i);
    }
  model.ghost_plan =
      std::make_unique<ExchangePlan>(model.comm, needed, [&](std::int64_t id) { return model.local_node(id); });
}

/// Numbers the nodes in the order in which the elements touch them, free nodes last, and fills the stores.
void number(Model& model, ModelBundle& bundle, const RecordIndex& index) {
  const std::vector<NodeRecord>& records = bundle.nodes;
  std::vector<std::int32_t> local(records.size(), -1);
  std::vector<std::int32_t> sequence;
  sequence.reserve(records.size());
  const auto touch = [&](std::int32_t r) {
    if (local[r] < 0) {
      local[r] = static_cast<std::int32_t>(sequence.size());
      sequence.push_back(r);
    }
    return local[r];
  };
  for (std::size_t p = 0; p < model.parts.size(); ++p) {
    ElementBundle& part = bundle.parts[p];
    PartStore& store = *model.parts[p].store;
    const auto order = curve_order(part, records, index, store.n_nodes());
    store.make_room(static_cast<int>(order.size()));
    for (std::size_t slot = 0; slot < order.size(); ++slot) {
      const auto e = static_cast<std::size_t>(order[slot]);
      std::int32_t nodes[Shape::most_nodes];
      for (int k = 0; k < store.n_nodes(); ++k) nodes[k] = touch(index(part.nodes[e][k]));
      store.put(static_cast<int>(slot), part.ids[e], nodes, part.record(e, store.record_size()));
    }
    part = ElementBundle{};
  }
  const std::size_t n_touched = sequence.size();
  for (std::size_t r = 0; r < records.size(); ++r)
    if (local[r] < 0 && records[r].free != 0) touch(static_cast<std::int32_t>(r));
  KERF_ASSERT(n_touched <= sequence.size(), "nodes are numbered once");
  model.nodes.resize(static_cast<int>(sequence.size()));
  for (std::size_t i = 0; i < sequence.size(); ++i) model.nodes.assign(static_cast<int>(i), records[sequence[i]]);
}

}  // namespace

void assemble(Model& model, ModelBundle&& bundle) {
  auto& records = bundle.nodes;
  std::sort(records.begin(), records.end(), [](const NodeRecord& a, const NodeRecord& b) { return a.id < b.id; });
  records.erase(std::unique(records.begin(), records.end(),
                            [](const NodeRecord& a, const NodeRecord& b) { return a.id == b.id; }),
                records.end());
  {
    const RecordIndex index(records);
    number(model, bundle, index);
  }
  bundle = ModelBundle{};
  model.nodes.place_dummies(model.dummy_edge);
  model.live_elements.assign(static_cast<std::size_t>(model.nodes.n()), 0);
  for (PartModel& part : model.parts) {
    PartStore& store = *part.store;
    const double volume = part.input->element->volume(reference_cell(store.shape(), model.dummy_edge));
    store.set_dummies(model.nodes.first_dummy(), part.material->density * volume, volume);
    for (int s = 0; s < store.n_slots(); ++s)
      for (int k = 0; k < store.n_nodes(); ++k) ++model.live_elements[store.node(s, k)];
  }
  model.index_nodes();
  build_ghost_plan(model);
  model.surface.build(model.surface_mesh());
}

namespace {

/// An element on its way, apart from its record.
struct Header {
  std::int64_t id = 0;
  ElementNodeIds nodes{};
  std::int64_t part = 0;
};

/// What goes to every rank, or has come from it.
struct Cargo {
  std::vector<std::vector<Header>> headers;
  std::vector<std::vector<double>> records;
  std::vector<std::vector<NodeRecord>> nodes;

  explicit Cargo(std::size_t n_ranks) : headers(n_ranks), records(n_ranks), nodes(n_ranks) {}
};

/// Makes room for exactly what goes to each rank: at this time the model is in memory twice.
void reserve(const Model& model, const std::vector<int>& owners, Cargo& cargo) {
  std::vector<std::size_t> n_elements(cargo.headers.size(), 0), n_reals(cargo.headers.size(), 0);
  std::size_t e = 0;
  for (const PartModel& part : model.parts)
    for (int s = 0; s < part.store->n_slots(); ++s) {
      if (!part.store->live(s)) continue;
      ++n_elements[owners[e]];
      n_reals[owners[e++]] += static_cast<std::size_t>(part.store->record_size());
    }
  KERF_ASSERT(e == owners.size(), "one owner per live element");
  for (std::size_t r = 0; r < cargo.headers.size(); ++r) {
    cargo.headers[r].reserve(n_elements[r]);
    cargo.records[r].reserve(n_reals[r]);
  }
}

void load_elements(const Model& model, const std::vector<int>& owners, Cargo& cargo) {
  reserve(model, owners, cargo);
  std::size_t e = 0;
  for (std::size_t p = 0; p < model.parts.size(); ++p) {
    const PartStore& store = *model.parts[p].store;
    for (int s = 0; s < store.n_slots(); ++s) {
      if (!store.live(s)) continue;
      const int to = owners[e++];
      Header h{store.id(s), {}, static_cast<std::int64_t>(p)};
      for (int k = 0; k < store.n_nodes(); ++k) h.nodes[k] = model.nodes.id[store.node(s, k)];
      cargo.headers[to].push_back(h);
      std::vector<double>& records = cargo.records[to];
      records.resize(records.size() + static_cast<std::size_t>(store.record_size()));
      store.pack(s, records.data() + records.size() - store.record_size());
    }
  }
}

/// The nodes of the elements that go to each rank, each of them once, and free nodes, which stay.
void load_nodes(const Model& model, Cargo& cargo) {
  std::vector<std::int32_t> taken_for(static_cast<std::size_t>(model.nodes.n()), -1);
  std::vector<std::int32_t> list;
  for (std::size_t r = 0; r < cargo.headers.size(); ++r) {
    list.clear();
    for (const Header& h : cargo.headers[r])
      for (int k = 0; k < model.parts[h.part].store->n_nodes(); ++k) {
        const std::int32_t n = model.local_node(h.nodes[k]);
        if (taken_for[n] == static_cast<std::int32_t>(r)) continue;
        taken_for[n] = static_cast<std::int32_t>(r);
        list.push_back(n);
      }
    if (static_cast<int>(r) == model.rank())
      for (int i = 0; i < model.nodes.n(); ++i)
        if (model.nodes.free[i] && model.nodes.owned[i]) list.push_back(i);
    cargo.nodes[r].reserve(list.size());
    for (const std::int32_t n : list) cargo.nodes[r].push_back(model.nodes.record(n));
  }
}

/// Fills the cargo, and gives the memory of what is in it back as early as may be: this is when most memory is needed.
void load(Model& model, const std::vector<int>& owners, Cargo& cargo) {
  model.surface = Surface{};
  model.ghost_plan.reset();
  load_elements(model, owners, cargo);
  for (PartModel& part : model.parts) part.store->release();
  load_nodes(model, cargo);
  model.nodes = NodeStore{};
  model.index_nodes();
}

}  // namespace

std::int64_t migrate(Model& model, const std::vector<int>& owners) {
  const auto n_ranks = static_cast<std::size_t>(model.n_ranks());
  const std::int64_t n_left = std::count_if(owners.begin(), owners.end(), [&](int r) { return r != model.rank(); });
  Cargo cargo(n_ranks);
  load(model, owners, cargo);

  ModelBundle bundle;
  bundle.parts.resize(model.parts.size());
  std::vector<std::vector<Header>> headers = all_to_all(model.comm, std::move(cargo.headers));
  bundle.messages = all_to_all(model.comm, std::move(cargo.records));
  for (auto& list : all_to_all(model.comm, std::move(cargo.nodes))) {
    bundle.nodes.insert(bundle.nodes.end(), list.begin(), list.end());
    list = {};
  }
  for (std::size_t r = 0; r < n_ranks; ++r) {
    const double* record = bundle.messages[r].data();
    for (const Header& h : headers[r]) {
      ElementBundle& part = bundle.parts[h.part];
      part.ids.push_back(h.id);
      part.nodes.push_back(h.nodes);
      part.record_at.push_back(record);
      record += model.parts[h.part].store->record_size();
    }
    headers[r] = {};
  }
  assemble(model, std::move(bundle));
  return n_left;
}

}  // namespace kerf
