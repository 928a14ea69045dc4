// Boxes that bound where nodes and facets may be until the next contact search.
#pragma once

#include <algorithm>
#include <cmath>

#include "kerf/math.hpp"

namespace kerf {

/// An axis-parallel box in single precision, rounded outwards; empty by default. No box that is made of lengths,
/// however large these are, meets an empty one.
struct Box {
  static constexpr float far = 3e38f, farthest = 1e38f;
  float low[3] = {far, far, far}, high[3] = {-far, -far, -far};  // [m]

  void include(const Box& other) {
    for (int d = 0; d < 3; ++d) {
      low[d] = std::min(low[d], other.low[d]);
      high[d] = std::max(high[d], other.high[d]);
    }
  }
  void inflate(double by) {
    for (int d = 0; d < 3; ++d) {
      low[d] = below(low[d] - by);
      high[d] = above(high[d] + by);
    }
  }
  /// Bitwise "and": six comparisons cost less than six branches that nobody can predict.
  bool meets(const Box& other) const {
    return (low[0] <= other.high[0]) & (high[0] >= other.low[0]) & (low[1] <= other.high[1]) &
           (high[1] >= other.low[1]) & (low[2] <= other.high[2]) & (high[2] >= other.low[2]);
  }
  bool operator==(const Box&) const = default;
  bool contains(const Box& other) const {
    return (low[0] <= other.low[0]) & (high[0] >= other.high[0]) & (low[1] <= other.low[1]) &
           (high[1] >= other.high[1]) & (low[2] <= other.low[2]) & (high[2] >= other.high[2]);
  }
  double centre(int d) const { return 0.5 * (static_cast<double>(low[d]) + high[d]); }

  /// Four units in the last place make up for the rounding of the conversion and of the subtraction.
  static float below(double x) {
    const auto f = static_cast<float>(x);
    return std::max(f - std::fabs(f) * 0x1p-22f, -farthest);
  }
  static float above(double x) {
    const auto f = static_cast<float>(x);
    return std::min(f + std::fabs(f) * 0x1p-22f, farthest);
  }
  /// The box of all points between `a` and `b`, and of those no farther off than `margin` along each axis.
  static Box spanned(Vec3 a, Vec3 b, double margin) {
    Box box;
    for (int d = 0; d < 3; ++d) {
      box.low[d] = below(std::min(a[d], b[d]) - margin);
      box.high[d] = above(std::max(a[d], b[d]) + margin);
    }
    return box;
  }
};

}  // namespace kerf
