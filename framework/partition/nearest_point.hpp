// Finds the nearest of some points.
#pragma once

#include <array>
#include <cstddef>
#include <limits>
#include <vector>

#include "kerf/math.hpp"

namespace kerf {

/// The smallest box, along the axes, that holds some points.
struct PointBounds {
  static constexpr double unbounded = std::numeric_limits<double>::max();
  std::array<double, 3> low{unbounded, unbounded, unbounded}, high{-unbounded, -unbounded, -unbounded};
  void take(Vec3 x);
  /// 0 where all points are one.
  double longest_edge() const;
};

/// A grid of boxes with about one point each, which is searched ring by ring.
class NearestPoint {
 public:
  /// Three coordinates per point. Pre: there are points, all in `bounds`, which have a longest edge. `points` must
  /// outlive this.
  NearestPoint(const std::vector<double>& points, const PointBounds& bounds);

  /// The number of the nearest point; of equally near points the first.
  std::size_t find(Vec3 x) const;

 private:
  using Cell = std::array<int, 3>;
  struct Best {
    std::size_t point = 0;
    double square = PointBounds::unbounded;  // of its distance
  };
  Vec3 point(std::size_t i) const { return {points_[3 * i], points_[3 * i + 1], points_[3 * i + 2]}; }
  Cell cell_of(Vec3 x) const;
  std::size_t box_of(const Cell& c) const { return (static_cast<std::size_t>(c[2]) * n_[1] + c[1]) * n_[0] + c[0]; }
  void look_in_ring(const Cell& home, int ring, Vec3 x, Best& best) const;
  void look_in_box(const Cell& cell, Vec3 x, Best& best) const;

  const std::vector<double>& points_;
  std::array<double, 3> low_;
  Cell n_{};
  double edge_ = 1.0;
  std::vector<std::vector<std::size_t>> boxes_;
};

}  // namespace kerf
