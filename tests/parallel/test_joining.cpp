// Parts that share nodes: their mass and motion, memberships, bodies, and inputs that cannot be joined.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <map>

#include "core/diagnostics.hpp"
#include "model/joining.hpp"
#include "model/migrator.hpp"
#include "model/node_group.hpp"
#include "parallel/communicator.hpp"
#include "parallel/global_model.hpp"
#include "parallel/scene.hpp"

namespace {

using namespace kerf;
using namespace kerf::test;

constexpr const char* materials = R"(
time: {end: 1 us}
materials:
  heavy: {density: 8000, strength: {type: elastic, shear_modulus: 80e9}, eos: {type: linear, bulk_modulus: 160e9}}
  light: {density: 2000, strength: {type: elastic, shear_modulus: 30e9}, eos: {type: linear, bulk_modulus: 70e9}}
)";

std::string two_blocks(const std::string& gap, const std::string& joined) {
  return std::string(materials) + R"(
parts:
  apart: {material: light, mesh: {type: block, origin: [9e-3, 0, 0], size: [1e-3, 1e-3, 1e-3], cells: [1, 1, 1]}}
  left: {material: heavy, velocity: [10, 0, 0], mesh: {type: block, size: [2e-3, 3e-3, 2e-3], cells: [2, 3, 2]}}
  other: {material: light, mesh: {type: block, origin: [12e-3, 0, 0], size: [1e-3, 1e-3, 1e-3], cells: [1, 1, 1]}}
  right:
    material: light
    mesh: {type: block, size: [2e-3, 3e-3, 2e-3], cells: [2, 3, 2]}
    placement: [{translate: [)" +
         gap + R"(, 0, 0]}]
sets:
  seam: {parts: left, face: x_max}
  bottom: {face: z_min}
)" + joined;
}

TEST(Joining, shares_the_nodes_where_two_blocks_meet_and_no_others) {
  const auto input = scene(two_blocks("2e-3", "joined: [{parts: [left, right]}]"));
  Model model;
  generate(model, *input);
  EXPECT_EQ(model.n_nodes, 8 + 8 + 5 * 4 * 3);
  const GlobalModel global = gather_globally(model);
  EXPECT_EQ(global.trouble, "");
  for (const NodeRecord& n : global.nodes) {
    const Membership& m = model.memberships[n.membership];
    const bool on_seam = std::fabs(n.position[0] - 2e-3) < 1e-9;
    if (on_seam)
      EXPECT_THAT(m.parts, testing::ElementsAre(1, 3));
    else
      EXPECT_EQ(m.parts.size(), 1u);
    EXPECT_EQ(n.part, m.parts.front());
    EXPECT_EQ(model.part_of_node(n.id), n.part);
    // The sets of both parts' nodes.
    std::vector<std::int32_t> sets;
    if (on_seam) sets.push_back(0);
    if (n.position[2] == 0.0) sets.push_back(1);
    EXPECT_EQ(m.sets, sets);
    for (int d = 0; d < 3; ++d) EXPECT_EQ(n.reference[d], n.position[d]);
  }
  EXPECT_EQ(model.parts[1].body, 1);
  EXPECT_EQ(model.parts[3].body, 1);
  EXPECT_EQ(model.parts[2].body, 2);
}

TEST(Joining, gives_shared_nodes_the_mass_of_both_parts_and_the_velocity_of_a_plastic_impact) {
  const auto input = scene(two_blocks("2e-3", "joined: [{parts: [left, right]}]"));
  Model model;
  generate(model, *input);
  std::map<std::int64_t, std::map<int, double>> shares;
  for (const NodeShare& s : gather_to_root(model.comm, model.shared.shares)) shares[s.node][s.part] = s.mass;
  const GlobalModel global = gather_globally(model);
  if (model.rank() != 0) return;
  EXPECT_EQ(shares.size(), 4u * 3u);
  double mass[2] = {0.0, 0.0}, momentum = 0.0, whole = 0.0;
  for (const NodeRecord& n : global.nodes) {
    whole += n.mass;
    momentum += n.mass * n.velocity[0];
    if (shares.count(n.id) == 0) continue;
    // Cells are of one size: the masses of a node are as the densities.
    EXPECT_DOUBLE_EQ(shares[n.id][1] + shares[n.id][3], n.mass);
    EXPECT_NEAR(shares[n.id][1], 0.8 * n.mass, 1e-12 * n.mass);
    EXPECT_NEAR(n.velocity[0], 8.0, 1e-12 * 8.0);
    mass[0] += shares[n.id][1];
    mass[1] += shares[n.id][3];
  }
  // A quarter of the mass of a block of two layers is in the nodes of a face.
  EXPECT_NEAR(mass[0], 0.25 * 8000 * 12e-9, 1e-12 * mass[0]);
  EXPECT_NEAR(mass[1], 0.25 * 2000 * 12e-9, 1e-12 * mass[1]);
  EXPECT_NEAR(whole, (8000 + 2000) * 12e-9 + 2 * 2000 * 1e-9, 1e-12 * whole);
  EXPECT_NEAR(momentum, 8000 * 12e-9 * 10, 1e-12 * momentum);  // that of the moving block: none is lost
}

TEST(Joining, knows_the_shares_of_nodes_on_any_rank) {
  const auto input = scene(two_blocks("2e-3", "joined: [{parts: [left, right]}]"));
  Model model;
  generate(model, *input);
  migrate(model, owners_of_live(model, [&](std::int64_t id) { return static_cast<int>(id * 7 % model.n_ranks()); }));
  std::vector<std::int64_t> mine;
  for (int i = 0; i < model.nodes.n(); ++i)
    if (model.nodes.owned[i]) mine.push_back(model.nodes.id[i]);
  std::map<std::int64_t, double> mass;
  for (const NodeShare& s : shares_of(model, mine)) mass[s.node] += s.mass;
  for (const auto& [id, sum] : mass) EXPECT_DOUBLE_EQ(sum, model.nodes.mass[model.local_node(id)]);
  EXPECT_EQ(sum_of(model.comm, static_cast<std::int64_t>(mass.size())), 4 * 3);
}

TEST(Joining, moves_nodes_within_the_tolerance_to_those_of_the_part_that_comes_first) {
  const auto input = scene(two_blocks("2.01e-3", "joined: [{parts: [left, right], tolerance: 0.02 mm}]"));
  Model model;
  generate(model, *input);
  EXPECT_EQ(model.n_nodes, 8 + 8 + 5 * 4 * 3);
  const GlobalModel global = gather_globally(model);
  if (model.rank() != 0) return;
  double mass = 0.0;
  for (const NodeRecord& n : global.nodes) {
    mass += n.mass;
    EXPECT_FALSE(std::fabs(n.position[0] - 2.01e-3) < 1e-9);
    for (int d = 0; d < 3; ++d) EXPECT_EQ(n.reference[d], n.position[d]);
  }
  // The cells that fill the gap have the density of their material.
  EXPECT_NEAR(mass, 8000 * 12e-9 + 2000 * 2.01e-3 * 6e-6 + 2 * 2000 * 1e-9, 1e-12 * mass);
}

std::vector<std::string> errors_of(const std::string& yaml) {
  try {
    const auto input = scene(yaml);
    Model model;
    generate(model, *input);
  } catch (const InputError& e) {
    return e.lines();
  }
  return {};
}

TEST(Joining, refuses_parts_that_do_not_meet) {
  EXPECT_THAT(errors_of(two_blocks("2.01e-3", "joined: [{parts: [left, right]}]")),
              testing::ElementsAre(testing::HasSubstr("no node of part left is within"),
                                   testing::HasSubstr("no node of part right is within")));
  EXPECT_THAT(errors_of(two_blocks("2e-3", "joined: [{parts: [left, other, right]}]")),
              testing::ElementsAre(testing::HasSubstr("no node of part other is within")));
}

TEST(Joining, refuses_a_tolerance_as_large_as_cells) {
  EXPECT_THAT(errors_of(two_blocks("2e-3", "joined: [{parts: [left, right], tolerance: 0.6 mm}]")),
              testing::ElementsAre(testing::HasSubstr("would join nodes of one cell")));
}

TEST(Joining, refuses_to_fold_a_part_by_way_of_others) {
  // Along x at z = 1 mm, nodes of the three parts in turn are a third of a millimetre apart: each within the tolerance
  // of the next, so that those of one part, a millimetre apart, would all be one.
  const std::string text = std::string(materials) + R"(
parts:
  low: {material: heavy, mesh: {type: block, size: [1e-3, 1e-3, 1e-3], cells: [1, 1, 1]}}
  middle:
    material: heavy
    mesh: {type: block, origin: [0.33e-3, 0, 1e-3], size: [1e-3, 1e-3, 1e-3], cells: [1, 1, 1]}
  high: {material: heavy, mesh: {type: block, origin: [0.66e-3, 0, 1e-3], size: [1e-3, 1e-3, 1e-3], cells: [1, 1, 1]}}
joined: [{parts: [low, middle, high], tolerance: 0.4 mm}]
)";
  EXPECT_THAT(errors_of(text),
              testing::ElementsAre(testing::HasSubstr("nodes of part low would become one node of its own"),
                                   testing::HasSubstr("nodes of part middle would become one node of its own"),
                                   testing::HasSubstr("nodes of part high would become one node of its own")));
}

TEST(Joining, knows_groups_of_more_than_64_parts_and_sets) {
  std::string text = std::string(materials) + "parts:\n", sets = "sets:\n";
  for (int k = 0; k < 70; ++k) {
    text += "  p" + std::to_string(k) + ": {material: heavy, mesh: {type: block, origin: [" + std::to_string(2 * k) +
            "e-3, 0, 0], size: [1e-3, 1e-3, 1e-3], cells: [1, 1, 1]}}\n";
    sets += "  s" + std::to_string(k) + ": {parts: p" + std::to_string(k) + ", face: z_max}\n";
  }
  const auto input = scene(text + sets);
  Model model;
  generate(model, *input);
  const NodeGroup part(model, {"p69"}), set(model, {"s68", "s3"});
  std::int64_t n_part = 0, n_set = 0;
  for (int i = 0; i < model.nodes.n(); ++i) {
    if (!model.nodes.owned[i]) continue;
    n_part += part.holds(model.nodes, i) ? 1 : 0;
    n_set += set.holds(model.nodes, i) ? 1 : 0;
    const bool is_last = model.nodes.x(i).x > 137.5e-3, is_top = model.nodes.x(i).z > 0.5e-3;
    EXPECT_EQ(part.holds(model.nodes, i), is_last);
    const bool is_68 = model.nodes.x(i).x > 135.5e-3 && !is_last;
    const bool is_3 = model.nodes.x(i).x > 5.5e-3 && model.nodes.x(i).x < 7.5e-3;
    EXPECT_EQ(set.holds(model.nodes, i), is_top && (is_68 || is_3));
  }
  EXPECT_EQ(sum_of(model.comm, n_part), 8);
  EXPECT_EQ(sum_of(model.comm, n_set), 8);
}

}  // namespace
