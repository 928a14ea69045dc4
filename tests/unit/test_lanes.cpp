// Vectors of the element kernels: rounding to whole numbers, masks, gather and scatter. Built once for this machine and
// once for the narrowest registers.
#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <random>
#include <vector>

#include "kerf/lanes.hpp"

namespace {

using namespace kerf;

#ifdef KERF_EXPECTED_LANES
static_assert(register_lanes == KERF_EXPECTED_LANES);
#endif

/// Numbers of all sizes below `limit`, among them whole ones, halves, and their neighbours.
std::vector<double> samples(double limit) {
  std::vector<double> values = {0.0, -0.0, 0.5, 1.5, 2.5, std::nextafter(0.5, 0.0), std::nextafter(0.5, 1.0), 1e-300};
  std::mt19937_64 random(4);
  std::uniform_real_distribution<double> mantissa(1.0, 2.0);
  for (double size = 0.25; size < limit; size *= 2.0)
    for (int k = 0; k < 20; ++k) {
      const double value = mantissa(random) * 0.5 * size;
      for (const double v : {value, std::floor(value) + 0.5, std::floor(value), std::nextafter(size, 0.0)})
        if (v < limit) values.push_back(v);
    }
  const std::size_t n = values.size();
  for (std::size_t i = 0; i < n; ++i) values.push_back(-values[i]);
  while (values.size() % lane_width != 0) values.push_back(0.0);
  return values;
}

template <class Round>
void expect_nearest(double limit, const Round& round) {
  const std::vector<double> values = samples(limit);
  alignas(64) double in[lane_width];
  alignas(64) std::int64_t out[lane_width];
  for (std::size_t i = 0; i < values.size(); i += lane_width) {
    std::copy_n(&values[i], lane_width, in);
    each_piece([&](int lane) { store_lanes(out + lane, round(load_lanes(in + lane))); });
    for (int l = 0; l < lane_width; ++l) EXPECT_EQ(out[l], std::llrint(in[l])) << in[l];
  }
}

TEST(Lanes, round_to_the_nearest_whole_number_ties_to_even) {
  expect_nearest(0x1p62, [](Lanes v) { return round_to_int(v); });
}

TEST(Lanes, round_small_numbers_alike) {
  expect_nearest(small_limit, [](Lanes v) { return round_small_to_int(v); });
}

TEST(Lanes, mask_has_one_bit_per_lane) {
  for (unsigned bits = 0; bits <= all_lanes; ++bits) {
    alignas(64) double v[register_lanes];
    for (int l = 0; l < register_lanes; ++l) v[l] = (bits >> l & 1u) != 0 ? 1.0 : -1.0;
    EXPECT_EQ(mask_of(load_lanes(v) > 0.0), bits);
    EXPECT_EQ(mask_of(~(load_lanes(v) > 0.0)), ~bits & all_lanes);
  }
}

TEST(Lanes, magnitude_keeps_na_n_and_infinity) {
  const double nan = std::numeric_limits<double>::quiet_NaN(), infinity = std::numeric_limits<double>::infinity();
  EXPECT_TRUE(std::isnan(abs_of(lanes(nan))[0]));
  EXPECT_EQ(abs_of(lanes(-infinity))[0], infinity);
  EXPECT_EQ(abs_of(lanes(-2.5))[register_lanes - 1], 2.5);
  EXPECT_FALSE(std::signbit(abs_of(lanes(-0.0))[0]));
}

TEST(Lanes, root_is_that_of_each_lane) {
  alignas(64) double v[register_lanes];
  for (int l = 0; l < register_lanes; ++l) v[l] = 1.7 * (l + 1);
  for (int l = 0; l < register_lanes; ++l) EXPECT_EQ(sqrt_of(load_lanes(v))[l], std::sqrt(v[l]));
}

TEST(Lanes, gather_reads_three_components_of_each_node) {
  alignas(64) double nodal[4 * 20];
  for (int i = 0; i < 80; ++i) nodal[i] = 100.0 + i;
  const std::int32_t node[8] = {3, 17, 0, 3, 19, 8, 9, 1};
  Lanes x, y, z;
  gather_vector(nodal, node, x, y, z);
  for (int l = 0; l < register_lanes; ++l) {
    EXPECT_EQ(x[l], 100.0 + 4 * node[l]);
    EXPECT_EQ(y[l], 101.0 + 4 * node[l]);
    EXPECT_EQ(z[l], 102.0 + 4 * node[l]);
  }
}

TEST(Lanes, gather_reads_whole_rows) {
  alignas(64) double rows[4 * 20];
  for (int i = 0; i < 80; ++i) rows[i] = 100.0 + i;
  const std::int32_t number[8] = {19, 0, 7, 7, 3, 18, 2, 11};
  Lanes column[4];
  gather_rows(rows, number, column[0], column[1], column[2], column[3]);
  for (int c = 0; c < 4; ++c)
    for (int l = 0; l < register_lanes; ++l) EXPECT_EQ(column[c][l], 100.0 + 4 * number[l] + c);
}

TEST(Lanes, scatter_adds_lane_after_lane_where_lanes_share_a_node) {
  alignas(64) std::int64_t nodal[4 * 6], expected[4 * 6];
  for (int i = 0; i < 24; ++i) nodal[i] = expected[i] = 1000 + i;
  const std::int32_t node[8] = {2, 2, 5, 2, 0, 5, 5, 2};
  LanesInt v[3];
  for (int d = 0; d < 3; ++d)
    for (int l = 0; l < register_lanes; ++l) {
      v[d][l] = (std::int64_t{1} << 40) * (d + 1) + 7 * l;
      expected[4 * node[l] + d] += v[d][l];
    }
  scatter_add(nodal, node, v[0], v[1], v[2]);
  for (int i = 0; i < 24; ++i) EXPECT_EQ(nodal[i], expected[i]) << i;  // the fourth entries are left alone
}

TEST(Lanes, pieces_make_up_a_block) {
  int lanes_seen = 0;
  each_piece([&](int lane) {
    EXPECT_EQ(lane, lanes_seen);
    lanes_seen += register_lanes;
  });
  EXPECT_EQ(lanes_seen, lane_width);
}

TEST(SingleLanes, pieces_make_up_a_block) {
  int lanes_seen = 0;
  each_piece<float>([&](int lane) {
    EXPECT_EQ(lane, lanes_seen);
    lanes_seen += single_lanes;
  });
  EXPECT_EQ(lanes_seen, lane_width);
  EXPECT_EQ(n_wide<float> * register_lanes, single_lanes);
}

TEST(SingleLanes, mask_root_magnitude_and_extremes_are_those_of_each_lane) {
  for (unsigned bits = 0; bits <= all_lanes_of<float>; ++bits) {
    alignas(64) float v[single_lanes];
    for (int l = 0; l < single_lanes; ++l) v[l] = (bits >> l & 1u) != 0 ? 1.7f * (l + 1) : -1.0f;
    const SingleLanes all = load_lanes(v);
    EXPECT_EQ(mask_of(all > 0.0f), bits);
    for (int l = 0; l < single_lanes; ++l) {
      EXPECT_EQ(abs_of(all)[l], std::fabs(v[l]));
      EXPECT_EQ(sqrt_of(abs_of(all))[l], std::sqrt(std::fabs(v[l])));
      EXPECT_EQ(max_of(all, lanes(0.5f))[l], std::max(v[l], 0.5f));
      EXPECT_EQ(min_of(all, lanes(0.5f))[l], std::min(v[l], 0.5f));
    }
  }
  EXPECT_TRUE(std::isnan(abs_of(lanes(std::numeric_limits<float>::quiet_NaN()))[0]));
}

TEST(SingleLanes, go_from_doubles_and_back) {
  alignas(64) double in[lane_width], out[lane_width], sum[lane_width];
  for (int l = 0; l < lane_width; ++l) {
    in[l] = (l + 1) / 3.0;
    sum[l] = 1e12 + l;
  }
  each_piece<float>([&](int lane) {
    const SingleLanes v = load_lanes_as<float>(in + lane);
    store_lanes(out + lane, v);
    add_lanes(sum + lane, v);
    Lanes wide[n_wide<float>];
    wide[0] = widened<0>(v);
    if constexpr (n_wide<float> == 2) wide[1] = widened<1>(v);
    for (int l = 0; l < single_lanes; ++l) {
      EXPECT_EQ(v[l], static_cast<float>(in[lane + l]));
      EXPECT_EQ(wide[l / register_lanes][l % register_lanes], static_cast<double>(v[l]));
      EXPECT_EQ(narrowed(wide)[l], v[l]);
    }
  });
  for (int l = 0; l < lane_width; ++l) {
    EXPECT_EQ(out[l], static_cast<double>(static_cast<float>(in[l])));
    EXPECT_EQ(sum[l], 1e12 + l + static_cast<double>(static_cast<float>(in[l])));
  }
  each_piece([&](int lane) {
    const Lanes v = load_lanes_as<double>(in + lane);
    for (int l = 0; l < register_lanes; ++l) {
      EXPECT_EQ(v[l], in[lane + l]);
      EXPECT_EQ(widened<0>(v)[l], v[l]);
    }
  });
}

}  // namespace
