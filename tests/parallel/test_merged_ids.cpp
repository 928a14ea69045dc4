// Merging of nodes at one place, against a search through all pairs, on random copies of the nodes.
#include <gtest/gtest.h>

#include <algorithm>
#include <map>
#include <numeric>

#include "model/merged_ids.hpp"
#include "parallel/communicator.hpp"
#include "parallel/scene.hpp"

namespace {

using namespace kerf;
using test::scatter;

constexpr double tolerance = 1e-3, cube = 0.1;  // [m]

/// Lattices of several parts, one beside and over the other, whose nodes are displaced a little; the same on all ranks.
std::vector<JointNode> lattices(std::uint64_t seed) {
  std::vector<JointNode> nodes;
  std::int64_t id = 0;
  for (std::int32_t part = 0; part < 4; ++part)
    for (int k = 0; k < 216; ++k) {
      Vec3 x{0.1 * (k % 6) + 0.3 * (part % 2) - 0.25, 0.1 * (k / 6 % 6) + 0.2 * (part / 2) - 0.3, 0.1 * (k / 36) - 0.3};
      // Some are farther apart than the tolerance.
      const double size = scatter(seed, static_cast<std::uint64_t>(9 * id + 3)) < 0.1 ? 2e-2 : 4e-4;
      for (int d = 0; d < 3; ++d) x[d] += size * (scatter(seed, static_cast<std::uint64_t>(9 * id + d)) - 0.5);
      nodes.push_back({id++, part, x});
    }
  return nodes;
}

/// The nodes that a rank has: every node is on some rank, and may be on several.
std::vector<JointNode> share_of(const std::vector<JointNode>& all, std::uint64_t seed) {
  const int n_ranks = size_of(MPI_COMM_WORLD), here = rank_of(MPI_COMM_WORLD);
  std::vector<JointNode> mine;
  for (const JointNode& n : all) {
    const auto home = static_cast<int>(scatter(seed + 1, static_cast<std::uint64_t>(n.id)) * n_ranks);
    if (home == here || scatter(seed + 2, static_cast<std::uint64_t>(n.id * 64 + here)) < 0.2) mine.push_back(n);
  }
  return mine;
}

/// The lowest id that each node is merged with, by comparing all pairs.
std::vector<std::int64_t> survivors_of(const std::vector<JointNode>& all) {
  std::vector<std::int64_t> lowest(all.size());
  std::iota(lowest.begin(), lowest.end(), 0);
  for (bool changed = true; changed;) {
    changed = false;
    for (const JointNode& a : all)
      for (const JointNode& b : all) {
        const Vec3 d = a.position - b.position;
        if (a.part == b.part || dot(d, d) > tolerance * tolerance || lowest[a.id] >= lowest[b.id]) continue;
        lowest[b.id] = lowest[a.id];
        changed = true;
      }
  }
  return lowest;
}

TEST(MergedIds, nodes_at_one_place_become_the_one_of_the_lowest_id_on_any_number_of_ranks) {
  for (std::uint64_t seed = 0; seed < 4; ++seed) {
    const std::vector<JointNode> all = lattices(seed);
    const auto pairs = coincident_nodes(MPI_COMM_WORLD, share_of(all, seed), tolerance, cube);
    const MergedIds merged(MPI_COMM_WORLD, static_cast<std::int64_t>(all.size()), pairs);
    const std::vector<std::int64_t> survivor = survivors_of(all);
    std::vector<std::int64_t> ids, number(all.size(), -1);
    std::int64_t n = 0;
    for (std::size_t i = 0; i < all.size(); ++i) {
      ids.push_back(static_cast<std::int64_t>(i));
      if (survivor[i] == ids.back()) number[i] = n++;
    }
    ASSERT_LT(n, static_cast<std::int64_t>(all.size()) - 100) << "the lattices meet in many nodes";
    EXPECT_EQ(merged.n_merged(), static_cast<std::int64_t>(all.size()) - n);
    const std::vector<std::int64_t> found = merged.resolve(MPI_COMM_WORLD, ids);
    for (std::size_t i = 0; i < all.size(); ++i)
      ASSERT_EQ(found[i], number[static_cast<std::size_t>(survivor[i])]) << "node " << i << ", seed " << seed;
    const std::vector<std::int64_t> below = merged.n_survivors_below(MPI_COMM_WORLD, {0, 216, 500});
    for (std::size_t k = 0; k < 3; ++k) {
      const std::int64_t limit = k == 0 ? 0 : k == 1 ? 216 : 500;
      std::int64_t expected = 0;
      for (std::int64_t i = 0; i < limit; ++i) expected += survivor[static_cast<std::size_t>(i)] == i ? 1 : 0;
      EXPECT_EQ(below[k], expected);
    }
  }
}

TEST(MergedIds, a_chain_of_pairs_over_all_ranks_becomes_one_node) {
  // Every pair is known to one rank only, and the lowest id is at one end of the chain.
  constexpr std::int64_t n = 40;
  std::vector<IdPair> pairs;
  for (std::int64_t i = 0; i + 1 < n; ++i)
    if (i % size_of(MPI_COMM_WORLD) == rank_of(MPI_COMM_WORLD)) pairs.push_back({i + 1, i, 0, 1});
  const MergedIds merged(MPI_COMM_WORLD, n + 1, pairs);
  EXPECT_EQ(merged.n_merged(), n - 1);
  const auto found = merged.resolve(MPI_COMM_WORLD, {n, n - 1, 0});
  EXPECT_EQ(found, (std::vector<std::int64_t>{1, 0, 0}));
}

TEST(MergedIds, nodes_of_one_part_stay_apart) {
  std::vector<JointNode> nodes;
  if (rank_of(MPI_COMM_WORLD) == 0) nodes = {{0, 0, {0, 0, 0}}, {1, 0, {1e-4, 0, 0}}, {2, 1, {0.5, 0, 0}}};
  EXPECT_EQ(sum_of(MPI_COMM_WORLD,
                   static_cast<std::int64_t>(coincident_nodes(MPI_COMM_WORLD, nodes, tolerance, cube).size())),
            0);
}

TEST(MergedIds, nodes_are_found_across_the_faces_of_the_cubes_of_the_search) {
  // One node on either side of a corner of eight cubes.
  const std::vector<JointNode> nodes = {{7, 0, {-4e-4, -4e-4, -4e-4}}, {3, 1, {1e-4, 1e-4, 1e-4}}};
  const auto pairs = coincident_nodes(MPI_COMM_WORLD, nodes, tolerance, cube);
  const MergedIds merged(MPI_COMM_WORLD, 8, pairs);
  EXPECT_EQ(merged.n_merged(), 1);
  EXPECT_EQ(merged.resolve(MPI_COMM_WORLD, {7}), (std::vector<std::int64_t>{3}));
}

TEST(MergedIds, nothing_to_merge_is_fine) {
  const MergedIds merged(MPI_COMM_WORLD, 10, coincident_nodes(MPI_COMM_WORLD, {}, tolerance, cube));
  EXPECT_TRUE(merged.empty());
  EXPECT_EQ(merged.resolve(MPI_COMM_WORLD, {4, 2}), (std::vector<std::int64_t>{4, 2}));
}

}  // namespace
