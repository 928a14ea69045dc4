// Agreement on owners and matching of faces, on random holders.
#include <gtest/gtest.h>

#include <algorithm>
#include <map>
#include <random>

#include "parallel/communicator.hpp"
#include "parallel/ownership.hpp"
#include "parallel/scene.hpp"

namespace {

using namespace kerf;
using test::scatter;

bool holds(std::uint64_t seed, int rank, std::int64_t item, double share) {
  if (seed % 2 == 1 && rank == 0 && size_of(MPI_COMM_WORLD) > 1) return false;  // a rank without any item
  return scatter(seed, static_cast<std::uint64_t>(item * 64 + rank)) < share;
}

std::int64_t id_of(std::int64_t item) { return item % 5 == 0 ? (item + 1) << 40 : item; }

struct Claim {
  std::int64_t item = 0;
  int holder = 0, owner = 0;
};

TEST(Ownership, every_item_has_one_owner_who_holds_it_and_all_holders_know) {
  for (std::uint64_t seed = 0; seed < 6; ++seed) {
    const int here = rank_of(MPI_COMM_WORLD);
    const double share = seed < 2 ? 1.0 : 0.3;
    std::vector<std::int64_t> items, ids;
    for (std::int64_t i = 0; i < 500; ++i)
      if (holds(seed, here, i, share)) items.push_back(i);
    std::shuffle(items.begin(), items.end(), std::mt19937(static_cast<unsigned>(seed) + static_cast<unsigned>(here)));
    for (const std::int64_t i : items) ids.push_back(id_of(i));
    const Ownership found = agree_on_owners(MPI_COMM_WORLD, ids);
    ASSERT_EQ(found.owner.size(), ids.size());
    std::vector<Claim> claims;
    for (std::size_t i = 0; i < items.size(); ++i) claims.push_back({items[i], here, found.owner[i]});
    std::map<std::int64_t, std::vector<Claim>> by_item;
    for (const Claim& c : gather_to_root(MPI_COMM_WORLD, claims)) by_item[c.item].push_back(c);
    for (const auto& [item, all] : by_item) {
      const auto owner = all.front().owner;
      EXPECT_TRUE(std::any_of(all.begin(), all.end(), [&](const Claim& c) { return c.holder == owner; }));
      for (const Claim& c : all) EXPECT_EQ(c.owner, owner) << "item " << item;
    }
  }
}

TEST(Ownership, what_all_ranks_hold_is_spread_over_them) {
  std::vector<std::int64_t> ids;
  for (std::int64_t i = 0; i < 600; ++i) ids.push_back(i);
  const Ownership found = agree_on_owners(MPI_COMM_WORLD, ids);
  for (int r = 0; r < size_of(MPI_COMM_WORLD); ++r)
    EXPECT_GT(std::count(found.owner.begin(), found.owner.end(), r), 600 / size_of(MPI_COMM_WORLD) / 4);
}

TEST(Ownership, nothing_is_fine) { EXPECT_TRUE(agree_on_owners(MPI_COMM_WORLD, {}).owner.empty()); }

/// Face i lies between elements 2 i and 2 i + 1; a fifth of the faces have one side only.
TEST(MatchFaces, both_sides_find_each_other_and_lone_sides_find_nobody) {
  const int n_ranks = size_of(MPI_COMM_WORLD), here = rank_of(MPI_COMM_WORLD);
  if (n_ranks == 1) GTEST_SKIP() << "faces are matched across ranks only";
  for (std::uint64_t seed = 0; seed < 5; ++seed) {
    const auto rank_of_side = [&](std::int64_t face, std::uint64_t side) {
      const auto first = static_cast<int>(scatter(seed, static_cast<std::uint64_t>(2 * face)) * n_ranks);
      if (side == 0) return first;
      const auto step = 1 + static_cast<int>(scatter(seed, static_cast<std::uint64_t>(2 * face + 1)) * (n_ranks - 1));
      return (first + step) % n_ranks;
    };
    std::vector<OpenFace> mine;
    for (std::int64_t face = 0; face < 400; ++face)
      for (std::uint64_t side = 0; side < 2; ++side) {
        if (rank_of_side(face, side) != here || (side == 1 && face % 5 == 0)) continue;
        // Faces share nodes with one another, as faces do.
        mine.push_back({{face, face + 1, face + 1000 + face % 7, (face << 36) + 5000},
                        2 * face + static_cast<std::int64_t>(side)});
      }
    const std::vector<Neighbour> found = match_faces(MPI_COMM_WORLD, mine);
    ASSERT_EQ(found.size(), mine.size());
    for (std::size_t i = 0; i < mine.size(); ++i) {
      const std::int64_t face = mine[i].element / 2, side = mine[i].element % 2;
      if (face % 5 == 0) {
        EXPECT_EQ(found[i].element, -1);
        continue;
      }
      EXPECT_EQ(found[i].element, 2 * face + 1 - side);
      EXPECT_EQ(found[i].rank, rank_of_side(face, side == 0 ? 1 : 0));
    }
  }
}

}  // namespace
