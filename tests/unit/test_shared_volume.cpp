// The volume that two cells share: exact for bricks and turned cubes, nothing for what just touches.
#include <gtest/gtest.h>

#include <cmath>
#include <random>

#include "mesh/shared_volume.hpp"

namespace {

using namespace kerf;

constexpr double tolerance = 1e-6;  // a millionth of cells of length one
/// What the tolerance may take off the volume of cells whose surface is about ten.
constexpr double loss = 10.0 * tolerance;

Cell brick(Vec3 low, Vec3 high) {
  return {&hexahedron,
          {Vec3{low.x, low.y, low.z},
           {high.x, low.y, low.z},
           {high.x, high.y, low.z},
           {low.x, high.y, low.z},
           Vec3{low.x, low.y, high.z},
           {high.x, low.y, high.z},
           {high.x, high.y, high.z},
           {low.x, high.y, high.z}}};
}

Cell turned(Cell x, double angle, Vec3 about) {
  const double c = std::cos(angle), s = std::sin(angle);
  for (Vec3& p : x.x) {
    const Vec3 d = p - about;
    p = Vec3{c * d.x - s * d.y, s * d.x + c * d.y, d.z} + about;
  }
  return x;
}

double shared(const Cell& a, const Cell& b) {
  return shared_volume(a, FacePlanes(a), b, FacePlanes(b), tolerance).volume;
}

TEST(SharedVolume, of_bricks_is_their_common_box) {
  const Cell a = brick({0, 0, 0}, {1, 1, 1}), b = brick({0.7, -0.5, 0.25}, {1.5, 0.5, 0.75});
  const SharedVolume s = shared_volume(a, FacePlanes(a), b, FacePlanes(b), tolerance);
  EXPECT_NEAR(s.volume, 0.3 * 0.5 * 0.5, loss);
  EXPECT_NEAR(s.low.x, 0.7, 2 * tolerance);
  EXPECT_NEAR(s.high.z, 0.75, 2 * tolerance);
  EXPECT_NEAR(shared(b, a), s.volume, loss);
}

TEST(SharedVolume, of_a_cell_with_itself_is_all_of_it) {
  EXPECT_NEAR(shared(brick({0, 0, 0}, {1, 1, 1}), brick({0, 0, 0}, {1, 1, 1})), 1.0, loss);
}

TEST(SharedVolume, of_a_small_cell_inside_a_large_one) {
  EXPECT_NEAR(shared(brick({0, 0, 0}, {1, 1, 1}), brick({0.4, 0.4, 0.4}, {0.5, 0.5, 0.5})), 1e-3, loss);
  EXPECT_NEAR(shared(brick({0.4, 0.4, 0.4}, {0.5, 0.5, 0.5}), brick({0, 0, 0}, {1, 1, 1})), 1e-3, loss);
}

/// Neither has a corner in the other.
TEST(SharedVolume, of_bars_that_cross) {
  EXPECT_NEAR(shared(brick({0, 0, 0}, {10, 1, 1}), brick({4, -5, 0.5}, {5, 5, 1.5})), 0.5, 10.0 * loss);
}

TEST(SharedVolume, of_squares_turned_by_an_eighth_is_an_octagon) {
  const Cell a = brick({0, 0, 0}, {1, 1, 1}), b = turned(a, std::atan(1.0), {0.5, 0.5, 0.0});
  EXPECT_NEAR(shared(a, b), 2.0 * (std::sqrt(2.0) - 1.0), loss);
}

TEST(SharedVolume, is_nothing_where_cells_touch_or_are_apart) {
  const Cell a = brick({0, 0, 0}, {1, 1, 1});
  for (const Cell& b :
       {brick({1, 0, 0}, {2, 1, 1}), brick({1, 1, 0}, {2, 2, 1}), brick({1, 1, 1}, {2, 2, 2}),
        brick({1, -3, -3}, {4, 3, 3}), brick({1 - 0.5 * tolerance, 0, 0}, {2, 1, 1}), brick({1.1, 0, 0}, {2, 1, 1})}) {
    EXPECT_EQ(shared(a, b), 0.0);
    EXPECT_EQ(shared(b, a), 0.0);
  }
}

/// Ten times deeper than the tolerance: the edge of a turned cube in a face.
TEST(SharedVolume, sees_an_edge_that_is_hardly_inside) {
  const Cell a = brick({0, 0, 0}, {1, 1, 1});
  const double half = std::sqrt(0.5);
  const Cell b = turned(brick({0, 0, 0}, {1, 1, 1}), std::atan(1.0), {0.5, 0.5, 0.0});
  Cell near = b, apart = b;
  for (Vec3& p : near.x) p = p + Vec3{0.5 + half - 10.0 * tolerance, 0, 0};
  for (Vec3& p : apart.x) p = p + Vec3{0.5 + half, 0, 0};
  EXPECT_GT(shared(a, near), 0.0);
  EXPECT_GT(shared(near, a), 0.0);
  EXPECT_EQ(shared(a, apart), 0.0);
}

/// A turned cube against many points: volumes agree within the scatter of counting.
TEST(SharedVolume, agrees_with_counting_points) {
  std::mt19937 random(7);
  std::uniform_real_distribution<double> in(-0.6, 0.6), turn(0.0, 6.0);
  for (int round = 0; round < 20; ++round) {
    const Cell a = brick({0, 0, 0}, {1, 1, 1});
    const Vec3 shift{in(random), in(random), in(random)};
    const Cell b = turned(brick(shift, shift + Vec3{1, 1, 1}), turn(random), {0.5, 0.5, 0.5});
    const FacePlanes planes(b);
    constexpr int n = 40;
    int inside = 0;
    for (int i = 0; i < n * n * n; ++i) {
      const Vec3 x{(i % n + 0.5) / n, (i / n % n + 0.5) / n, (i / n / n + 0.5) / n};
      bool is_inside = true;
      for (std::size_t f = 0; f < 6; ++f) is_inside = is_inside && dot(planes.normal[f], x) < planes.offset[f];
      inside += is_inside ? 1 : 0;
    }
    // Points stand 1/40 apart: a face of area below two moves the count by a fraction of a layer.
    EXPECT_NEAR(shared(a, b), static_cast<double>(inside) / (n * n * n), 0.02) << round;
  }
}

}  // namespace
