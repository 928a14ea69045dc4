// The search for the nearest point finds what looking at every point finds.
#include <gtest/gtest.h>

#include <cstddef>
#include <random>
#include <vector>

#include "partition/nearest_point.hpp"

using namespace kerf;

namespace {

std::size_t nearest_of_all(const std::vector<double>& points, Vec3 x) {
  std::size_t best = 0;
  double least = PointBounds::unbounded;
  for (std::size_t i = 0; i < points.size() / 3; ++i) {
    const Vec3 way = Vec3{points[3 * i], points[3 * i + 1], points[3 * i + 2]} - x;
    if (dot(way, way) < least) {
      least = dot(way, way);
      best = i;
    }
  }
  return best;
}

/// Asks for places inside and outside of the cloud, and for the points themselves.
void expect_nearest(const std::vector<double>& points, Vec3 size) {
  PointBounds bounds;
  for (std::size_t i = 0; i < points.size(); i += 3) bounds.take({points[i], points[i + 1], points[i + 2]});
  const NearestPoint nearest(points, bounds);
  std::mt19937 random(7);
  std::uniform_real_distribution<double> share(-0.5, 1.5);
  for (int k = 0; k < 300; ++k) {
    const Vec3 x{size.x * share(random), size.y * share(random), size.z * share(random)};
    ASSERT_EQ(nearest.find(x), nearest_of_all(points, x)) << x.x << " " << x.y << " " << x.z;
  }
  for (std::size_t i = 0; i < points.size(); i += 30) {
    const Vec3 x{points[i], points[i + 1], points[i + 2]};
    ASSERT_EQ(nearest.find(x), nearest_of_all(points, x));
  }
}

std::vector<double> cloud(int n, Vec3 size, double power) {
  std::mt19937 random(3);
  std::uniform_real_distribution<double> share(0.0, 1.0);
  std::vector<double> points;
  for (int i = 0; i < n; ++i) {
    double crowded = share(random);  // towards x = 0
    for (int k = 1; k < power; ++k) crowded *= share(random);
    points.insert(points.end(), {size.x * crowded, size.y * share(random), size.z * share(random)});
  }
  return points;
}

}  // namespace

TEST(NearestPoint, among_points_everywhere) { expect_nearest(cloud(1000, {1, 1, 1}, 1), {1, 1, 1}); }
TEST(NearestPoint, in_a_long_thin_cloud) { expect_nearest(cloud(1000, {0.01, 0.02, 5}, 1), {0.01, 0.02, 5}); }
TEST(NearestPoint, where_points_are_crowded) { expect_nearest(cloud(2000, {1, 1, 0.3}, 4), {1, 1, 0.3}); }
TEST(NearestPoint, in_a_plane) { expect_nearest(cloud(500, {1, 2, 0}, 1), {1, 2, 1}); }
TEST(NearestPoint, of_two) { expect_nearest({0, 0, 0, 1, 0, 0}, {1, 1, 1}); }

TEST(NearestPoint, of_equally_near_points_the_first) {
  const std::vector<double> points{1, 0, 0, -1, 0, 0, 0, 1, 0, 0, -1, 0, -1, 0, 0};
  PointBounds bounds;
  for (std::size_t i = 0; i < points.size(); i += 3) bounds.take({points[i], points[i + 1], points[i + 2]});
  const NearestPoint nearest(points, bounds);
  EXPECT_EQ(nearest.find({0, 0, 0}), 0u);
  EXPECT_EQ(nearest.find({-2, 0, 0}), 1u);
}
