// Order-independent sums against sums in higher precision, in any order and on any number of ranks.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <random>

#include "core/fixed_sum.hpp"

namespace {

using namespace kerf;

/// Numbers of very different sizes that nearly cancel.
std::vector<double> wild_numbers(std::size_t n) {
  std::mt19937 random(5);
  std::uniform_real_distribution<double> mantissa(-1.0, 1.0), exponent(-18.0, 4.0);
  std::vector<double> values;
  for (std::size_t i = 0; i < n; ++i) {
    values.push_back(mantissa(random) * std::pow(10.0, exponent(random)));
    values.push_back(-values.back() * (1.0 + 1e-9 * mantissa(random)));
  }
  return values;
}

/// Every rank's share of a list that all know.
std::vector<double> share_of(const std::vector<double>& all) {
  int rank = 0, n_ranks = 1;
  MPI_Comm_rank(MPI_COMM_WORLD, &rank);
  MPI_Comm_size(MPI_COMM_WORLD, &n_ranks);
  std::vector<double> mine;
  for (std::size_t i = 0; i < all.size(); ++i)
    if (static_cast<int>(i % 7) % n_ranks == rank) mine.push_back(all[i]);
  return mine;
}

TEST(OrderFreeSum, is_exact_but_for_its_unit) {
  const std::vector<double> all = wild_numbers(20000);
  long double exact = 0.0L;
  for (const double v : all) exact += v;
  // 40000 terms, none larger than 2^14, each off by half of 2^-72 of that at most; long double adds 2^-64 of a term.
  EXPECT_NEAR(order_free_sum(MPI_COMM_WORLD, share_of(all)), static_cast<double>(exact), 1e-12);
}

TEST(OrderFreeSum, does_not_depend_on_order_or_ranks) {
  std::vector<double> all = wild_numbers(5000);
  const double expected = order_free_sum(MPI_COMM_SELF, all);
  std::mt19937 random(6);
  for (int k = 0; k < 5; ++k) {
    std::shuffle(all.begin(), all.end(), random);
    EXPECT_EQ(order_free_sum(MPI_COMM_WORLD, share_of(all)), expected);
  }
}

TEST(OrderFreeSum, holds_more_terms_than_one_chunk) {
  const std::vector<double> ones((std::size_t{1} << 20) + 17, 1.0);
  EXPECT_EQ(order_free_sum(MPI_COMM_SELF, ones), static_cast<double>(ones.size()));
  const std::vector<double> small(ones.size(), -0.1);
  EXPECT_NEAR(order_free_sum(MPI_COMM_SELF, small), -0.1 * static_cast<double>(ones.size()), 1e-10);
}

TEST(OrderFreeSum, sums_several_lists_at_once) {
  const std::vector<double> a = {1.5, -0.25}, b, c = {1e300, 1e300, -1e300};
  const std::vector<double> sums = order_free_sums(MPI_COMM_SELF, {a, b, c});
  ASSERT_EQ(sums.size(), 3u);
  EXPECT_EQ(sums[0], 1.25);
  EXPECT_EQ(sums[1], 0.0);
  EXPECT_EQ(sums[2], 1e300);
}

TEST(OrderFreeSum, holds_at_the_ends_of_the_range) {
  const std::vector<double> tiny = {1e-280, 1e-280}, huge = {1e300, 1e300}, excessive = {1.7e308, 1.7e308};
  // The unit of 2^-972 is 2.5e-13 of a term.
  EXPECT_NEAR(order_free_sum(MPI_COMM_SELF, tiny) * 1e280, 2.0, 1e-12);
  EXPECT_EQ(order_free_sum(MPI_COMM_SELF, huge), 2e300);
  EXPECT_TRUE(std::isnan(order_free_sum(MPI_COMM_SELF, excessive)));
}

TEST(OrderFreeSum, is_no_number_where_a_term_is_none) {
  const double nan = std::numeric_limits<double>::quiet_NaN(), infinity = std::numeric_limits<double>::infinity();
  const std::vector<double> bad = {1.0, nan}, worse = {-infinity, 2.0}, fine = {3.0};
  const std::vector<double> sums = order_free_sums(MPI_COMM_WORLD, {bad, worse, fine});
  int n_ranks = 1;
  MPI_Comm_size(MPI_COMM_WORLD, &n_ranks);
  EXPECT_TRUE(std::isnan(sums[0]) && std::isnan(sums[1]));
  EXPECT_EQ(sums[2], 3.0 * n_ranks);
}

}  // namespace
