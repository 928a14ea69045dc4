// Migration: whatever moves where, every bit of every element and node arrives, and nothing else changes.
#include <gtest/gtest.h>

#include <cstring>

#include "model/copies.hpp"
#include "model/migrator.hpp"
#include "parallel/communicator.hpp"
#include "parallel/global_model.hpp"
#include "parallel/scene.hpp"
#include "report/state_hash.hpp"

namespace {

using namespace kerf;
using namespace kerf::test;

constexpr const char* two_bodies = R"(
time: {end: 1 us}
materials:
  metal:
    density: 7850
    strength: {type: elastic_plastic, shear_modulus: 80e9, yield_stress: 1e9, hardening_modulus: 0.3e9}
    eos: {type: linear, bulk_modulus: 160e9}
    erosion: {criteria: [{type: geometric_strain, limit: 1}, {type: fuse}]}
  soft:
    density: 2700
    strength: {type: elastic, shear_modulus: 26e9}
    eos: {type: linear, bulk_modulus: 70e9}
    erosion: {criteria: [{type: fuse}]}
parts:
  plate: {material: soft, mesh: {type: block, size: [8e-3, 6e-3, 3e-3], cells: [8, 6, 3]}, velocity: [1, 2, 3]}
  rod:
    material: metal
    mesh: {type: cylinder, radius: 2e-3, length: 8e-3, cell_size: 1e-3}
    placement: [{translate: [4e-3, 3e-3, 4e-3]}]
sets:
  rim: {parts: plate, face: x_min}
  corner: {box: [0, 0, 0, 4e-3, 3e-3, 9e-3]}
checks: {free_nodes: FREE_NODES}
)";

std::unique_ptr<ModelInput> bodies(const std::string& free_nodes, const std::string& precision = "double") {
  std::string text = two_bodies;
  return scene("precision: " + precision + "\n" + text.replace(text.find("FREE_NODES"), 10, free_nodes));
}

/// Fills every array with numbers that are functions of ids alone, -0 and the smallest numbers among them.
void scramble(Model& model, std::uint64_t seed) {
  const auto number = [&](std::uint64_t item) {
    const double v = scatter(seed, item) - 0.5;
    return v < -0.48 ? -0.0 : v > 0.48 ? 0x1p-1074 : v * 1e9;
  };
  for (int i = 0; i < model.nodes.n(); ++i) {
    const auto item = static_cast<std::uint64_t>(model.nodes.id[i]) * 16;
    for (std::uint64_t d = 0; d < 3; ++d) {
      model.nodes.position[4 * i + d] += 1e-13 * number(item + d);
      model.nodes.velocity[4 * i + d] = number(item + 3 + d);
      model.nodes.force[4 * i + d] = (std::int64_t{1} << 55) + static_cast<std::int64_t>(number(item + 6 + d));
    }
  }
  for (PartModel& part : model.parts) {
    PartStore& store = *part.store;
    for (int f = PartStore::volume; f < PartStore::n_fields; ++f) {
      Field& field = store.field(static_cast<PartStore::FieldIndex>(f));
      for (int s = 0; s < store.n_slots(); ++s)
        for (int c = 0; c < field.n_components; ++c)
          if (store.live(s)) field.set(s, c, number(static_cast<std::uint64_t>(store.id(s)) * 4096 + f * 64 + c));
    }
  }
}

void expect_same(const GlobalModel& a, const GlobalModel& b) {
  EXPECT_EQ(a.trouble, "");
  EXPECT_EQ(b.trouble, "");
  ASSERT_EQ(a.elements.size(), b.elements.size());
  ASSERT_EQ(a.nodes.size(), b.nodes.size());
  for (std::size_t e = 0; e < a.elements.size(); ++e) {
    const GlobalElement &x = a.elements[e], &y = b.elements[e];
    ASSERT_TRUE(x.id == y.id && x.part == y.part && x.nodes == y.nodes) << "element " << x.id;
    ASSERT_EQ(x.record.size(), y.record.size());
    ASSERT_EQ(std::memcmp(x.record.data(), y.record.data(), x.record.size() * sizeof(double)), 0) << "element " << x.id;
  }
  for (std::size_t n = 0; n < a.nodes.size(); ++n) {
    const NodeRecord &x = a.nodes[n], &y = b.nodes[n];
    ASSERT_TRUE(x.id == y.id && x.membership == y.membership && x.part == y.part && x.free == y.free)
        << "node " << x.id;
    ASSERT_EQ(std::memcmp(x.position, y.position, sizeof x.position), 0) << "node " << x.id;
    ASSERT_EQ(std::memcmp(x.velocity, y.velocity, sizeof x.velocity), 0) << "node " << x.id;
    ASSERT_EQ(std::memcmp(x.force, y.force, sizeof x.force), 0) << "node " << x.id;
    ASSERT_EQ(x.mass, y.mass) << "node " << x.id;
  }
}

/// What a model must be on every rank by itself: nodes that somebody needs and no others, and plans that work.
void expect_in_order(const Model& model) {
  std::vector<std::int64_t> touching(static_cast<std::size_t>(model.nodes.n()) + NodeStore::n_dummies, 0);
  for (const PartModel& part : model.parts)
    for (int s = 0; s < part.store->n_slots(); ++s)
      for (int k = 0; k < 8 && part.store->live(s); ++k) ++touching[part.store->node(s, k)];
  for (int i = 0; i < model.nodes.n(); ++i) {
    EXPECT_EQ(touching[i], model.live_elements[i]);
    EXPECT_TRUE(touching[i] > 0 || model.nodes.free[i] != 0) << "nobody needs node " << model.nodes.id[i];
    EXPECT_EQ(model.local_node(model.nodes.id[i]), i);
    EXPECT_EQ(model.node_owner[i] == model.rank(), model.nodes.owned[i] != 0);
  }
  // Elements around each node, over all ranks, against a count on rank 0.
  sum_over_copies(model, touching.data(), 1);
  struct Count {
    std::int64_t node, n;
  };
  std::vector<Count> counts;
  for (int i = 0; i < model.nodes.n(); ++i) counts.push_back({model.nodes.id[i], touching[i]});
  counts = gather_to_root(model.comm, counts);
  const GlobalModel global = gather_globally(model);
  std::map<std::int64_t, std::int64_t> expected;
  for (const GlobalElement& e : global.elements)
    for (const std::int64_t n : e.nodes) ++expected[n];
  for (const Count& c : counts) ASSERT_EQ(c.n, expected[c.node]) << "node " << c.node;
}

/// Migrates and compares with what was there before.
void move_and_compare(Model& model, const std::function<int(std::int64_t)>& owner) {
  const GlobalModel before = gather_globally(model);
  const std::string hash = state_hash(model);
  std::int64_t leaving = 0;
  const std::vector<int> owners = owners_of_live(model, owner);
  for (const int r : owners) leaving += r != model.rank() ? 1 : 0;
  EXPECT_EQ(migrate(model, owners), leaving);
  for (const PartModel& part : model.parts)
    for (int s = 0; s < part.store->n_slots(); ++s)
      if (part.store->live(s)) {
        ASSERT_EQ(owner(part.store->id(s)), model.rank());
      }
  EXPECT_EQ(state_hash(model), hash);
  expect_same(gather_globally(model), before);
  expect_in_order(model);
}

int at_random(std::uint64_t seed, std::int64_t id, int n_ranks) {
  return static_cast<int>(scatter(seed, static_cast<std::uint64_t>(id)) * n_ranks);
}

TEST(Migrator, everything_arrives_bit_for_bit_however_often_it_moves) {
  for (const char* precision : {"double", "single"}) {
    const auto input = bodies("keep", precision);
    Model model;
    generate(model, *input);
    EXPECT_EQ(model.parts[0].store->field(PartStore::deviator).is_single, std::string(precision) == "single");
    scramble(model, 3);
    const int n = model.n_ranks();
    for (std::uint64_t round = 0; round < 4; ++round)
      move_and_compare(model, [&](std::int64_t id) { return at_random(round, id, n); });
    move_and_compare(model, [&](std::int64_t id) { return static_cast<int>(id * n / model.n_elements); });
  }
}

TEST(PartStore, keeps_floats_through_compaction_and_takes_half_the_room_for_them) {
  const auto wide = bodies("keep"), narrow = bodies("keep", "single");
  Model in_doubles, in_floats;
  generate(in_doubles, *wide);
  generate(in_floats, *narrow);
  scramble(in_floats, 8);
  PartStore& store = *in_floats.parts[0].store;
  if (in_floats.n_ranks() == 1) {
    // Deviator, pressure and what the element keeps: 6 + 1 + 16 numbers of four bytes less, in blocks of eight.
    const auto saved = in_doubles.parts[0].store->bytes() - store.bytes();
    EXPECT_EQ(saved, static_cast<std::size_t>(store.n_blocks()) * lane_width * 23 * sizeof(float));
  }
  std::map<std::int64_t, std::vector<double>> before;
  for (int s = 0; s < store.n_slots(); ++s) {
    before[store.id(s)].resize(static_cast<std::size_t>(store.record_size()));
    store.pack(s, before[store.id(s)].data());
  }
  for (int s = 0; s < store.n_slots(); s += 3) store.retire(s, in_floats.nodes.first_dummy());
  store.compact();
  for (int s = 0; s < store.n_slots(); ++s) {
    std::vector<double> now(static_cast<std::size_t>(store.record_size()));
    store.pack(s, now.data());
    EXPECT_EQ(now, before.at(store.id(s)));
  }
}

TEST(Migrator, staying_put_changes_nothing) {
  const auto input = bodies("keep");
  Model model;
  generate(model, *input);
  scramble(model, 4);
  const std::vector<int> owners = owners_of_live(model, [&](std::int64_t) { return model.rank(); });
  const GlobalModel before = gather_globally(model);
  EXPECT_EQ(migrate(model, owners), 0);
  expect_same(gather_globally(model), before);
}

TEST(Migrator, ranks_may_end_with_nothing_and_get_something_again) {
  const auto input = bodies("keep");
  Model model;
  generate(model, *input);
  scramble(model, 5);
  const int n = model.n_ranks();
  move_and_compare(model, [&](std::int64_t) { return n - 1; });
  EXPECT_EQ(model.n_live_local(), model.rank() == n - 1 ? model.n_elements : 0);
  if (model.rank() != n - 1) {
    EXPECT_EQ(model.nodes.n(), 0);
  }
  move_and_compare(model, [&](std::int64_t id) { return id == 7 ? n - 1 : 0; });
  move_and_compare(model, [&](std::int64_t id) { return at_random(9, id, n); });
}

class FreeNodes : public testing::TestWithParam<const char*> {};
INSTANTIATE_TEST_SUITE_P(Checks, FreeNodes, testing::Values("keep", "drop"),
                         [](const auto& info) { return std::string(info.param); });

TEST_P(FreeNodes, travel_unharmed_while_elements_die) {
  const auto input = bodies(GetParam());
  const bool drop = std::string(GetParam()) == "drop";
  Model model;
  generate(model, *input);
  scramble(model, 6);
  Erosion erosion(model);
  Ledger ledger;
  ledger.open(model);
  const int n = model.n_ranks();
  std::int64_t n_free = 0;
  for (std::uint64_t round = 0; round < 5; ++round) {
    delete_elements(model, erosion, ledger,
                    [&](std::int64_t id) { return scatter(100 + round, static_cast<std::uint64_t>(id)) < 0.4; });
    move_and_compare(model, [&](std::int64_t id) { return at_random(20 + round, id, n); });
    const GlobalModel global = gather_globally(model);
    if (model.rank() != 0) continue;
    EXPECT_EQ(static_cast<std::int64_t>(global.nodes.size()), model.n_nodes) << "no node is ever lost";
    std::set<std::int64_t> touched;
    for (const GlobalElement& e : global.elements) touched.insert(e.nodes.begin(), e.nodes.end());
    n_free = 0;
    for (const NodeRecord& r : global.nodes) {
      EXPECT_EQ(r.free != 0, touched.count(r.id) == 0) << "node " << r.id;
      EXPECT_EQ(r.mass == 0.0, drop && r.free != 0) << "node " << r.id;
      n_free += r.free != 0 ? 1 : 0;
    }
  }
  if (model.rank() == 0) {
    EXPECT_GT(n_free, 0);
  }
  // The last elements die: ranks have free nodes only, or nothing.
  delete_elements(model, erosion, ledger, [](std::int64_t) { return true; });
  move_and_compare(model, [](std::int64_t) { return 0; });
  EXPECT_EQ(model.n_live_local(), 0);
  const double dropped = static_cast<double>(sum_of(model.comm, ledger.accounts.dropped_mass)) * ledger.mass_quantum;
  // Each node's mass is rounded to whole quanta, half a quantum at most.
  EXPECT_NEAR(dropped, drop ? ledger.initial_mass : 0.0, ledger.mass_quantum * static_cast<double>(model.n_nodes));
}

}  // namespace
