// The exterior surface in parallel, through deletions, compactions and migrations, against a serial count of faces.
#include <gtest/gtest.h>

#include <algorithm>
#include <map>

#include "kerf/shape.hpp"
#include "model/migrator.hpp"
#include "model/surface.hpp"
#include "parallel/communicator.hpp"
#include "parallel/global_model.hpp"
#include "parallel/scene.hpp"

namespace {

using namespace kerf;
using namespace kerf::test;

/// A block beside a rod that touches nothing, with elements that any test may delete.
constexpr const char* block_and_rod = R"(
time: {end: 1 us}
materials:
  metal:
    density: 7850
    strength: {type: elastic, shear_modulus: 80e9}
    eos: {type: linear, bulk_modulus: 160e9}
    erosion: {criteria: [{type: fuse}]}
parts:
  plate: {material: metal, mesh: {type: block, size: [9e-3, 7e-3, 5e-3], cells: [9, 7, 5]}}
  rod:
    material: metal
    mesh: {type: cylinder, radius: 2e-3, length: 6e-3, cell_size: 1e-3, nose: {type: ogival, caliber_radius_head: 1}}
    placement: [{translate: [4e-3, 3e-3, 7e-3]}]
)";

/// Three blocks that share the nodes of their faces, so that neighbours are of different parts; the middle one comes
/// last, and all three meet in one edge.
constexpr const char* joined_blocks = R"(
time: {end: 1 us}
materials:
  metal:
    density: 7850
    strength: {type: elastic, shear_modulus: 80e9}
    eos: {type: linear, bulk_modulus: 160e9}
    erosion: {criteria: [{type: fuse}]}
parts:
  low: {material: metal, mesh: {type: block, size: [9e-3, 7e-3, 2e-3], cells: [9, 7, 2]}}
  side: {material: metal, mesh: {type: block, origin: [4e-3, 0, 2e-3], size: [5e-3, 7e-3, 3e-3], cells: [5, 7, 3]}}
  middle: {material: metal, mesh: {type: block, origin: [0, 0, 2e-3], size: [4e-3, 7e-3, 3e-3], cells: [4, 7, 3]}}
joined: [{parts: [low, side]}, {parts: [middle, side, low]}]
)";

class SurfaceOf : public testing::TestWithParam<const char*> {};
INSTANTIATE_TEST_SUITE_P(bodies, SurfaceOf, testing::Values(block_and_rod, joined_blocks), [](const auto& bodies) {
  return std::string(bodies.param == joined_blocks ? "joined_blocks" : "block_and_rod");
});

/// Facets round some nodes, asked for while those of dead elements may still be listed, against all facets.
void expect_true_surface_round(Model& model, std::vector<ExteriorFacet> round, const std::vector<char>& marked,
                               const std::string& when) {
  std::vector<ExteriorFacet> expected = model.surface.exterior(model.surface_mesh());
  std::erase_if(expected, [&](const ExteriorFacet& f) {
    return std::none_of(f.nodes.begin(), f.nodes.end(), [&](std::int32_t n) { return marked[n] != 0; });
  });
  std::sort(round.begin(), round.end());
  std::sort(expected.begin(), expected.end());
  EXPECT_TRUE(round == expected) << when << ": " << round.size() << " facets round some nodes instead of "
                                 << expected.size();
}

void expect_true_surface(Model& model, const std::string& when) {
  std::vector<char> marked;
  for (const std::int64_t id : model.nodes.id) marked.push_back(scatter(7, static_cast<std::uint64_t>(id)) < 0.1);
  expect_true_surface_round(model, model.surface.exterior_round(model.surface_mesh(), marked), marked, when);
  std::int64_t n_listed = 0;
  const std::set<GlobalFacet> listed = gather_exterior(model, n_listed);
  const GlobalModel global = gather_globally(model);
  if (model.rank() != 0) return;
  EXPECT_EQ(n_listed, static_cast<std::int64_t>(listed.size())) << when << ": a facet is listed twice";
  EXPECT_TRUE(listed == global.exterior())
      << when << ": " << listed.size() << " facets instead of " << global.exterior().size();
}

/// Neighbours across faces, as a partitioner's graph is told them.
void expect_true_neighbours(const Model& model, const std::string& when) {
  struct Link {
    std::int64_t from, to, rank_of_to, rank_of_from;
  };
  std::vector<Link> links;
  for (std::size_t p = 0; p < model.parts.size(); ++p)
    for (int s = 0; s < model.parts[p].store->n_slots(); ++s) {
      if (!model.parts[p].store->live(s)) continue;
      std::vector<std::int64_t> ids;
      std::vector<int> ranks;
      model.surface.neighbours(model.surface_mesh(), static_cast<int>(p), s, ids, ranks);
      for (std::size_t k = 0; k < ids.size(); ++k)
        links.push_back({model.parts[p].store->id(s), ids[k], ranks[k], model.rank()});
      if (ids.empty()) links.push_back({model.parts[p].store->id(s), -1, -1, model.rank()});
    }
  links = gather_to_root(model.comm, links);
  const GlobalModel global = gather_globally(model);
  if (model.rank() != 0) return;
  std::map<std::int64_t, std::int64_t> rank_of_element;
  for (const Link& l : links) rank_of_element[l.from] = l.rank_of_from;
  std::multiset<std::pair<std::int64_t, std::int64_t>> found, expected;
  for (const Link& l : links) {
    if (l.to < 0) continue;
    found.insert({l.from, l.to});
    EXPECT_EQ(l.rank_of_to, rank_of_element[l.to]) << when << ": element " << l.to;
  }
  std::map<std::set<std::int64_t>, std::vector<std::int64_t>> sides;
  for (const GlobalElement& e : global.elements)
    for (const auto& face : hexahedron.face) {
      std::set<std::int64_t> key;
      for (const int corner : face) key.insert(e.nodes[corner]);
      sides[key].push_back(e.id);
    }
  for (const auto& [key, ids] : sides)
    if (ids.size() == 2) {
      expected.insert({ids[0], ids[1]});
      expected.insert({ids[1], ids[0]});
    }
  EXPECT_TRUE(found == expected) << when << ": " << found.size() << " links instead of " << expected.size();
}

int slab_owner(const Model& model, std::int64_t id, std::uint64_t shift) {
  const auto at = static_cast<std::int64_t>((static_cast<std::uint64_t>(id) + shift * 61) %
                                            static_cast<std::uint64_t>(model.n_elements));
  return static_cast<int>(at * model.n_ranks() / model.n_elements);
}

TEST_P(SurfaceOf, of_undamaged_bodies_is_their_skin) {
  const auto input = scene(GetParam());
  Model model;
  generate(model, *input);
  expect_true_surface(model, "as generated");
  expect_true_neighbours(model, "as generated");
}

TEST_P(SurfaceOf, stays_true_through_random_deletions_and_migrations) {
  const auto input = scene(GetParam());
  for (std::uint64_t seed = 0; seed < 3; ++seed) {
    Model model;
    generate(model, *input);
    Erosion erosion(model);
    Ledger ledger;
    ledger.open(model);
    for (std::uint64_t round = 0; round < 12; ++round) {
      const std::string when = "seed " + std::to_string(seed) + ", round " + std::to_string(round);
      // Small bites, which leave holes in the stores, and large ones, after which they are compacted.
      const double bite = round % 3 == 2 ? 0.3 : 0.015;
      delete_elements(model, erosion, ledger, [&](std::int64_t id) {
        return scatter(seed * 100 + round, static_cast<std::uint64_t>(id)) < bite;
      });
      expect_true_surface(model, when + ", deleted");
      expect_true_neighbours(model, when + ", deleted");
      if (round % 2 == 0) continue;
      // Slabs, and owners at random, where every neighbour is elsewhere.
      migrate(model, owners_of_live(model, [&](std::int64_t id) {
                return seed == 1 ? static_cast<int>(scatter(round, static_cast<std::uint64_t>(id)) * model.n_ranks())
                                 : slab_owner(model, id, round);
              }));
      expect_true_surface(model, when + ", moved");
      expect_true_neighbours(model, when + ", moved");
    }
  }
}

TEST_P(SurfaceOf, knows_what_others_have_lost_to_the_last_element) {
  const auto input = scene(GetParam());
  Model model;
  generate(model, *input);
  migrate(model, owners_of_live(model, [&](std::int64_t id) { return static_cast<int>(id % model.n_ranks()); }));
  Erosion erosion(model);
  Ledger ledger;
  ledger.open(model);
  for (std::int64_t kept = 64; kept >= 0; kept -= 8) {
    delete_elements(model, erosion, ledger, [&](std::int64_t id) { return id % 64 >= kept; });
    expect_true_surface(model, "kept " + std::to_string(kept) + " in 64");
  }
  EXPECT_EQ(sum_of(model.comm, static_cast<std::int64_t>(model.surface.exterior(model.surface_mesh()).size())), 0);
}

TEST_P(SurfaceOf, names_the_faces_that_dead_elements_had_covered) {
  const auto input = scene(GetParam());
  Model model;
  generate(model, *input);
  if (model.n_ranks() > 1) GTEST_SKIP() << "asked on one rank only";
  Erosion erosion(model);
  Ledger ledger;
  ledger.open(model);
  for (std::uint64_t round = 0; round < 6; ++round) {
    std::int64_t n_listed = 0;
    std::set<GlobalFacet> expected = gather_globally(model).exterior();
    const std::set<GlobalFacet> before = expected;
    const auto dies = [&](std::int64_t id) { return scatter(round, static_cast<std::uint64_t>(id)) < 0.1; };
    for (PartModel& part : model.parts) {
      auto* judge = dynamic_cast<PartJudge*>(erosion.judge(model, part.store->index(), 1));
      for (int s = 0; s < part.store->n_slots(); ++s)
        if (part.store->live(s) && dies(part.store->id(s))) judge->failures.push_back({s, 0, 0.0});
    }
    erosion.erode(model, {}, ledger);
    erosion.update_free_nodes(model);
    std::set<GlobalFacet> opened;
    for (const ExteriorFacet& f : model.surface.opened_by(model.surface_mesh(), erosion.retired()))
      opened.insert({model.parts[f.part].store->id(f.slot), f.face});
    expected.clear();
    for (const GlobalFacet& f : gather_exterior(model, n_listed))
      if (before.count(f) == 0) expected.insert(f);
    EXPECT_TRUE(opened == expected) << "round " << round;
    erosion.compact(model);
  }
}

TEST(Surface, of_joined_blocks_has_no_face_where_they_meet) {
  const auto input = scene(joined_blocks);
  Model model;
  generate(model, *input);
  // As of one block of 9 x 7 x 5 cells: its nodes are 10 x 8 x 6.
  EXPECT_EQ(model.n_nodes, 10 * 8 * 6);
  EXPECT_EQ(sum_of(model.comm, static_cast<std::int64_t>(model.surface.exterior(model.surface_mesh()).size())),
            2 * (9 * 7 + 9 * 5 + 7 * 5));
}

}  // namespace
