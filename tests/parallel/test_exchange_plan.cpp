// Exchange plans on random maps: every copy gets its owner's bits, every owner gets the exact sum of its copies.
#include <gtest/gtest.h>

#include <algorithm>
#include <random>

#include "parallel/communicator.hpp"
#include "parallel/exchange_plan.hpp"
#include "parallel/scene.hpp"

namespace {

using namespace kerf;
using test::scatter;

constexpr std::int64_t n_items = 400;

/// Items on ranks at random: who owns each, who needs it. Every rank can compute all of it.
struct RandomMap {
  std::uint64_t seed = 0;
  bool rank_0_owns_nothing = false, last_rank_needs_nothing = false;

  std::int64_t id(std::int64_t item) const { return item % 3 == 0 ? item : (item << 35) + 7; }
  int owner(std::int64_t item) const {
    const int n = size_of(MPI_COMM_WORLD), skipped = rank_0_owns_nothing && n > 1 ? 1 : 0;
    return skipped + static_cast<int>(scatter(seed, 2 * static_cast<std::uint64_t>(item)) * (n - skipped));
  }
  bool needs(int rank, std::int64_t item) const {
    if (last_rank_needs_nothing && rank == size_of(MPI_COMM_WORLD) - 1) return false;
    return scatter(seed + 17, static_cast<std::uint64_t>(item * 64 + rank)) < 0.4;
  }
  int n_needing(std::int64_t item) const {
    int n = 0;
    for (int r = 0; r < size_of(MPI_COMM_WORLD); ++r) n += needs(r, item) ? 1 : 0;
    return n;
  }
};

/// This rank's side of a map: its own items and its copies, both in an order of its own.
struct Side {
  explicit Side(const RandomMap& m) : map(m) {
    const int here = rank_of(MPI_COMM_WORLD);
    for (std::int64_t i = 0; i < n_items; ++i) {
      if (map.owner(i) == here) owned.push_back(i);
      if (map.needs(here, i)) copied.push_back(i);
    }
    std::mt19937 random(static_cast<unsigned>(map.seed) * 31u + static_cast<unsigned>(here));
    std::shuffle(owned.begin(), owned.end(), random);
    std::shuffle(copied.begin(), copied.end(), random);
    std::vector<Needed> needed;
    for (const std::int64_t i : copied) needed.push_back({map.id(i), map.owner(i)});
    plan = std::make_unique<ExchangePlan>(MPI_COMM_WORLD, needed, [&](std::int64_t id) {
      const auto it = std::find_if(owned.begin(), owned.end(), [&](std::int64_t i) { return map.id(i) == id; });
      EXPECT_NE(it, owned.end()) << "asked for an item that this rank does not own";
      return static_cast<std::int32_t>(it - owned.begin());
    });
  }

  RandomMap map;
  std::vector<std::int64_t> owned, copied;  // items
  std::unique_ptr<ExchangePlan> plan;
};

std::vector<RandomMap> maps() {
  return {{1, false, false}, {2, true, false}, {3, false, true}, {4, true, true}, {5, false, false}};
}

double real_value(std::int64_t item, int c) { return 1.0 / static_cast<double>(3 * item + c + 1); }
/// Neither a double nor a double's sum can hold these.
std::int64_t whole_value(std::int64_t item, int c) { return (std::int64_t{1} << 60) + item * 1000003 + c; }

TEST(ExchangePlan, copies_get_the_bits_of_their_owner) {
  for (const RandomMap& map : maps()) {
    const Side side(map);
    for (int n_components = 1; n_components <= 4; ++n_components) {
      std::vector<double> values(5 * side.owned.size(), -1.0), copies(7 * side.copied.size(), -2.0);
      for (std::size_t i = 0; i < side.owned.size(); ++i)
        for (int c = 0; c < 5; ++c) values[5 * i + c] = real_value(side.owned[i], c);
      side.plan->pull(values.data(), 5, copies.data(), 7, n_components);
      for (std::size_t i = 0; i < side.copied.size(); ++i)
        for (int c = 0; c < 7; ++c)
          ASSERT_EQ(copies[7 * i + c], c < n_components ? real_value(side.copied[i], c) : -2.0);
    }
  }
}

TEST(ExchangePlan, whole_numbers_beyond_doubles_arrive_exactly) {
  for (const RandomMap& map : maps()) {
    const Side side(map);
    std::vector<std::int64_t> values(3 * side.owned.size()), copies(3 * side.copied.size());
    for (std::size_t i = 0; i < side.owned.size(); ++i)
      for (int c = 0; c < 3; ++c) values[3 * i + c] = -whole_value(side.owned[i], c);
    side.plan->pull(values.data(), 3, copies.data(), 3, 3);
    for (std::size_t i = 0; i < side.copied.size(); ++i)
      for (int c = 0; c < 3; ++c) ASSERT_EQ(copies[3 * i + c], -whole_value(side.copied[i], c));
  }
}

TEST(ExchangePlan, owners_get_the_exact_sum_of_all_copies_on_top) {
  for (const RandomMap& map : maps()) {
    const Side side(map);
    for (int repeat = 0; repeat < 3; ++repeat) {  // nothing may be left over from the call before
      std::vector<std::int64_t> values(4 * side.owned.size(), 11), copies(3 * side.copied.size());
      for (std::size_t i = 0; i < side.copied.size(); ++i)
        for (int c = 0; c < 3; ++c)
          copies[3 * i + c] = whole_value(side.copied[i], c) / 8 + rank_of(MPI_COMM_WORLD) + repeat;
      side.plan->push_add(copies.data(), 3, values.data(), 4, 3);
      for (std::size_t i = 0; i < side.owned.size(); ++i)
        for (int c = 0; c < 4; ++c) {
          std::int64_t expected = 11;
          for (int r = 0; r < size_of(MPI_COMM_WORLD) && c < 3; ++r)
            if (map.needs(r, side.owned[i])) expected += whole_value(side.owned[i], c) / 8 + r + repeat;
          ASSERT_EQ(values[4 * i + c], expected);
        }
    }
  }
}

TEST(ExchangePlan, sources_are_the_owned_items_that_somebody_needs) {
  for (const RandomMap& map : maps()) {
    const Side side(map);
    std::vector<std::int32_t> expected, sources = side.plan->sources();
    for (std::size_t i = 0; i < side.owned.size(); ++i)
      if (map.n_needing(side.owned[i]) > 0) expected.push_back(static_cast<std::int32_t>(i));
    std::sort(sources.begin(), sources.end());
    EXPECT_EQ(sources, expected);
  }
}

TEST(ExchangePlan, after_renumbering_items_are_found_and_those_gone_give_zero) {
  for (const RandomMap& map : maps()) {
    const Side side(map);
    // Every third item goes; the others close ranks in reverse order.
    const auto gone = [](std::int64_t item) { return item % 3 == 1; };
    std::vector<std::int32_t> moved(side.owned.size(), -1);
    std::vector<std::int64_t> kept;
    for (std::size_t i = side.owned.size(); i-- > 0;)
      if (!gone(side.owned[i])) {
        moved[i] = static_cast<std::int32_t>(kept.size());
        kept.push_back(side.owned[i]);
      }
    side.plan->renumber([&](std::int32_t old) { return moved[old]; });
    std::vector<std::int64_t> values(kept.size()), copies(side.copied.size(), -5);
    for (std::size_t i = 0; i < kept.size(); ++i) values[i] = whole_value(kept[i], 0);
    side.plan->pull(values.data(), 1, copies.data(), 1, 1);
    for (std::size_t i = 0; i < copies.size(); ++i)
      ASSERT_EQ(copies[i], gone(side.copied[i]) ? 0 : whole_value(side.copied[i], 0));
    std::fill(copies.begin(), copies.end(), 1);
    side.plan->push_add(copies.data(), 1, values.data(), 1, 1);
    for (std::size_t i = 0; i < kept.size(); ++i)
      ASSERT_EQ(values[i], whole_value(kept[i], 0) + map.n_needing(kept[i]));
  }
}

TEST(ExchangePlan, works_where_nobody_needs_anything) {
  ExchangePlan plan(MPI_COMM_WORLD, {}, [](std::int64_t) { return 0; });
  std::vector<std::int64_t> values{1, 2, 3};
  plan.pull(values.data(), 1, values.data(), 1, 1);
  plan.push_add(values.data(), 1, values.data(), 1, 1);
  EXPECT_EQ(values, (std::vector<std::int64_t>{1, 2, 3}));
  EXPECT_TRUE(plan.sources().empty());
}

}  // namespace
