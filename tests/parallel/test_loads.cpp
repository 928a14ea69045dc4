// Requirement: the marks of loaded facets pass through erosion as a serial rule says, on any number of ranks, and the
// forces of loads have the same bits.
#include <gtest/gtest.h>

#include <algorithm>
#include <map>

#include "erosion/erosion.hpp"
#include "kerf/shape.hpp"
#include "loads/facet_marks.hpp"
#include "loads/loads.hpp"
#include "model/migrator.hpp"
#include "parallel/communicator.hpp"
#include "parallel/global_model.hpp"
#include "parallel/scene.hpp"

namespace {

using namespace kerf;
using namespace kerf::test;

constexpr const char* pressed_block = R"(
time: {end: 1 us}
materials:
  metal:
    density: 7850
    strength: {type: elastic, shear_modulus: 80e9}
    eos: {type: linear, bulk_modulus: 160e9}
    erosion: {criteria: [{type: fuse}]}
parts:
  block: {material: metal, mesh: {type: block, size: [7e-3, 6e-3, 6e-3], cells: [7, 6, 6]}}
  rod:
    material: metal
    mesh: {type: cylinder, radius: 2e-3, length: 4e-3, cell_size: 1e-3}
    placement: [{translate: [3e-3, 3e-3, 7e-3]}]
sets:
  top: {parts: block, face: z_max}
boundaries:
  - {type: symmetry, nodes: rod, point: [0, 0, 7e-3], normal: [0, 0, 1]}
loads:
  - {type: pressure, facets: top, pressure: 1e9, follow_erosion: true}
  - {type: gravity, acceleration: [1e6, 2e6, 3e6]}
  - {type: pressure, facets: [rod, top], pressure: 2e9}
  - {type: pressure, facets: rod, pressure: 3e9, follow_erosion: true}
)";
constexpr std::size_t n_laws = 3;

using Facets = std::set<GlobalFacet>;

/// On rank 0, what each law on facets acts on; empty elsewhere. Collective.
std::array<Facets, n_laws> gather_marks(const Model& model, const FacetMarks& marks) {
  struct Item {
    std::int64_t element, face, law;
  };
  std::vector<Item> mine;
  for (const FacetMarks::Marked& m : marks.find(model))
    mine.push_back({model.parts[m.facet.part].store->id(m.facet.slot), m.facet.face, static_cast<std::int64_t>(m.law)});
  std::array<Facets, n_laws> all;
  for (const Item& i : gather_to_root(model.comm, mine))
    all[static_cast<std::size_t>(i.law)].insert({i.element, static_cast<int>(i.face)});
  return all;
}

void erode(Model& model, Erosion& erosion, Ledger& ledger, FacetMarks& marks,
           const std::function<bool(std::int64_t)>& dies) {
  for (PartModel& part : model.parts) {
    auto* judge = dynamic_cast<PartJudge*>(erosion.judge(model, part.store->index(), 1));
    for (int s = 0; s < part.store->n_slots(); ++s)
      if (part.store->live(s) && dies(part.store->id(s))) judge->failures.push_back({s, 0, 0.0});
  }
  marks.before_erosion(model, erosion.failing());
  erosion.erode(model, {1, 0.0, 1e-9, 1e-9}, ledger);
  erosion.update_free_nodes(model);
  marks.after_erosion(model, model.surface.opened_by(model.surface_mesh(), erosion.retired()));
  erosion.compact(model);
}

std::set<std::int64_t> nodes_of(const GlobalElement& e, int face) {
  std::set<std::int64_t> nodes;
  for (const int corner : hexahedron.face[face]) nodes.insert(e.nodes[static_cast<std::size_t>(corner)]);
  return nodes;
}

/// The rule, written without regard to ranks: marks of the living stay; those of the dead spread over the dead of the
/// same step that touch face to face, and from these to the living behind.
Facets marks_after(const GlobalModel& before, const Facets& marks, bool follows,
                   const std::function<bool(std::int64_t)>& dies) {
  std::map<std::set<std::int64_t>, std::vector<GlobalFacet>> sides;
  for (const GlobalElement& e : before.elements)
    for (int face = 0; face < hexahedron.n_faces; ++face) sides[nodes_of(e, face)].push_back({e.id, face});
  Facets after;
  std::set<std::int64_t> reached;
  for (const GlobalFacet& f : marks) {
    if (!dies(f.element))
      after.insert(f);
    else if (follows)
      reached.insert(f.element);
  }
  std::vector<std::int64_t> front(reached.begin(), reached.end());
  while (!front.empty()) {
    const GlobalElement& e = before.element(front.back());
    front.pop_back();
    for (int face = 0; face < hexahedron.n_faces; ++face)
      for (const GlobalFacet& other : sides[nodes_of(e, face)]) {
        if (other.element == e.id) continue;
        if (!dies(other.element))
          after.insert(other);
        else if (reached.insert(other.element).second)
          front.push_back(other.element);
      }
  }
  return after;
}

TEST(FacetMarks, are_chosen_by_set_and_part_and_leave_out_planes_of_symmetry) {
  const auto input = scene(pressed_block);
  Model model;
  generate(model, *input);
  const FacetMarks marks(*input);
  marks.choose(model);
  const auto found = gather_marks(model, marks);
  const GlobalModel global = gather_globally(model);
  if (model.rank() != 0) return;
  Facets top, rod;
  for (const GlobalFacet& f : global.exterior()) {
    const GlobalElement& e = global.element(f.element);
    double lowest = 1.0, highest = 0.0;
    for (const std::int64_t n : nodes_of(e, f.face)) {
      lowest = std::min(lowest, global.x(n).z);
      highest = std::max(highest, global.x(n).z);
    }
    if (e.part == 0 && lowest > 5.9e-3) top.insert(f);
    if (e.part == 1 && highest > 7.1e-3) rod.insert(f);  // but for its base, which lies on the plane
  }
  ASSERT_EQ(top.size(), 42u);
  EXPECT_TRUE(found[0] == top);
  EXPECT_TRUE(found[2] == rod);
  top.insert(rod.begin(), rod.end());
  EXPECT_TRUE(found[1] == top);
}

TEST(FacetMarks, pass_through_random_erosion_and_migration_as_the_serial_rule_says) {
  const auto input = scene(pressed_block);
  constexpr std::array<bool, n_laws> follows = {true, false, true};
  for (std::uint64_t seed = 0; seed < 3; ++seed) {
    Model model;
    generate(model, *input);
    FacetMarks marks(*input);
    marks.choose(model);
    Erosion erosion(model);
    Ledger ledger;
    ledger.open(model);
    std::size_t n_passed_on = 0;
    for (std::uint64_t round = 0; round < 8; ++round) {
      const auto dies = [&](std::int64_t id) {
        return scatter(10 * seed + round, static_cast<std::uint64_t>(id)) < (round % 3 == 2 ? 0.4 : 0.08);
      };
      const auto before = gather_marks(model, marks);
      const GlobalModel global = gather_globally(model);
      erode(model, erosion, ledger, marks, dies);
      const auto after = gather_marks(model, marks);
      for (std::size_t k = 0; k < n_laws && model.rank() == 0; ++k) {
        const Facets expected = marks_after(global, before[k], follows[k], dies);
        EXPECT_TRUE(after[k] == expected) << "seed " << seed << ", round " << round << ", law " << k << ": "
                                          << after[k].size() << " facets instead of " << expected.size();
        for (const GlobalFacet& f : expected) n_passed_on += before[k].count(f) == 0 ? 1 : 0;
      }
      migrate(model, owners_of_live(model, [&](std::int64_t id) {
                return static_cast<int>(scatter(round, static_cast<std::uint64_t>(id)) * model.n_ranks());
              }));
      const auto moved = gather_marks(model, marks);
      EXPECT_TRUE(moved == after) << "seed " << seed << ", round " << round << ", moved";  // empty but on rank 0
    }
    EXPECT_TRUE(model.rank() != 0 || n_passed_on > 20) << "otherwise this shows little";
  }
}

/// The forces of all loads by node id, as every copy has them.
std::map<std::int64_t, std::array<std::int64_t, 3>> forces_on_copies(Model& model, Loads& loads) {
  std::fill(model.nodes.force.begin(), model.nodes.force.end(), 0);
  loads.add_forces(model, Step{});
  EXPECT_EQ(loads.trouble(), "");
  std::map<std::int64_t, std::array<std::int64_t, 3>> forces;
  for (int i = 0; i < model.nodes.n(); ++i)
    forces[model.nodes.id[i]] = {model.nodes.force[4 * i], model.nodes.force[4 * i + 1], model.nodes.force[4 * i + 2]};
  return forces;
}

TEST(Loads, have_the_same_forces_wherever_elements_are) {
  const auto input = scene(pressed_block);
  Model model;
  generate(model, *input);
  Loads loads(*input);
  loads.begin(model);
  auto first = forces_on_copies(model, loads);
  // Of each node the force that rank 0 knows, or else another rank: all must be equal.
  for (std::uint64_t round = 0; round < 4; ++round) {
    migrate(model, owners_of_live(model, [&](std::int64_t id) {
              return static_cast<int>(scatter(round, static_cast<std::uint64_t>(id)) * model.n_ranks());
            }));
    loads.renumbered(model);
    struct Item {
      std::int64_t id;
      std::array<std::int64_t, 3> force;
    };
    std::vector<Item> mine;
    for (const auto& [id, force] : first) mine.push_back({id, force});
    const auto now = forces_on_copies(model, loads);
    for (const auto& [id, force] : now) mine.push_back({id, force});
    std::map<std::int64_t, std::array<std::int64_t, 3>> of_all;
    for (const Item& i : gather_to_root(model.comm, mine)) {
      const auto [known, fresh] = of_all.emplace(i.id, i.force);
      EXPECT_TRUE(fresh || known->second == i.force) << "node " << i.id << ", round " << round;
    }
    first = now;
  }
}

TEST(Loads, come_back_from_a_restart_to_whoever_owns_the_node) {
  const auto input = scene(pressed_block);
  Model model;
  generate(model, *input);
  Loads loads(*input);
  loads.begin(model);
  loads.add_forces(model, Step{});
  std::vector<LoadOnNode> share;
  const ExternalLoad before = loads.acting();
  for (std::size_t k = 0; k < before.nodes.size(); ++k)
    share.push_back(
        {model.nodes.id[before.nodes[k]], {before.force[4 * k], before.force[4 * k + 1], before.force[4 * k + 2]}});
  // Everything on the last rank, as a file may give it.
  std::vector<std::vector<LoadOnNode>> to_last(static_cast<std::size_t>(model.n_ranks()));
  to_last.back() = share;
  share.clear();
  for (const auto& list : all_to_all(model.comm, to_last)) share.insert(share.end(), list.begin(), list.end());
  loads.renumbered(model);
  ASSERT_TRUE(loads.acting().nodes.empty());
  loads.restore(model, share);
  std::map<std::int32_t, std::int64_t> was, is;
  for (std::size_t k = 0; k < before.nodes.size(); ++k) was[before.nodes[k]] = before.force[4 * k + 2];
  for (std::size_t k = 0; k < loads.acting().nodes.size(); ++k)
    is[loads.acting().nodes[k]] = loads.acting().force[4 * k + 2];
  EXPECT_FALSE(was.empty());
  EXPECT_TRUE(was == is);
}

}  // namespace
