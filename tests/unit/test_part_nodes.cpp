// Requirement: the numbers of a part's nodes are right however the whole mesh is numbered, and their memory goes with
// the part.
#include <gtest/gtest.h>
#include <malloc.h>

#include <map>
#include <numeric>
#include <random>

#include "../../physics/meshes/part_nodes.hpp"

namespace {

using namespace kerf;
using Cells = std::vector<std::array<std::int32_t, 8>>;

std::vector<std::int32_t> all_of(const Cells& cells) {
  std::vector<std::int32_t> numbers(cells.size());
  std::iota(numbers.begin(), numbers.end(), 0);
  return numbers;
}

void expect_right(const Cells& cells, const std::vector<std::int32_t>& of_part) {
  std::map<std::int32_t, std::int32_t> expected;
  for (const std::int32_t c : of_part)
    for (const std::int32_t node : cells[static_cast<std::size_t>(c)]) expected[node] = 0;
  std::int32_t n = 0;
  for (auto& [node, number] : expected) number = n++;
  const PartNodes nodes(cells, of_part);
  ASSERT_EQ(nodes.size(), expected.size());
  for (const auto& [node, number] : expected) {
    EXPECT_EQ(nodes.local(node), number);
    EXPECT_EQ(nodes.whole(static_cast<std::size_t>(number)), node);
  }
}

TEST(PartNodes, are_numbered_in_the_order_of_the_whole_mesh) {
  std::mt19937 random(7);
  for (const std::int32_t range : {8, 9, 40, 1000, 100000, 2147483647})
    for (const std::size_t n_cells : {1u, 2u, 30u, 500u}) {
      Cells cells(n_cells);
      std::uniform_int_distribution<std::int32_t> any(0, range - 1);
      for (auto& cell : cells)
        for (std::int32_t& node : cell) node = any(random);
      expect_right(cells, all_of(cells));
      expect_right(cells, {static_cast<std::int32_t>(n_cells / 2)});
    }
}

TEST(PartNodes, may_stand_in_heaps_far_apart) {
  Cells cells;
  for (const std::int32_t heap : {5, 300000, 2147483647 - 600})
    for (std::int32_t k = 0; k < 60; ++k) {
      auto& cell = cells.emplace_back();
      for (std::int32_t corner = 0; corner < 8; ++corner)
        cell[static_cast<std::size_t>(corner)] = heap + 8 * k + corner;
    }
  expect_right(cells, all_of(cells));
}

TEST(PartNodes, take_memory_as_the_part_has_nodes) {
  constexpr std::int32_t n_parts = 1000, n_whole = 8 * n_parts;
  Cells cells(n_parts);
  for (std::int32_t c = 0; c < n_parts; ++c)
    for (std::int32_t k = 0; k < 8; ++k)  // every part has the first, one of the last, and some between
      cells[static_cast<std::size_t>(c)][static_cast<std::size_t>(k)] = k == 0 ? 0 : k * n_parts + c;
  const std::size_t before = mallinfo2().uordblks;
  std::vector<PartNodes> parts;
  parts.reserve(n_parts);
  for (std::int32_t c = 0; c < n_parts; ++c) parts.emplace_back(cells, std::vector<std::int32_t>{c});
  const std::size_t each = (mallinfo2().uordblks - before) / n_parts;
  EXPECT_LT(each, 600u) << "bytes for 8 nodes; a table of the whole mesh has " << n_whole * 4;
  EXPECT_GT(each, 8 * sizeof(std::int32_t));
}

}  // namespace
