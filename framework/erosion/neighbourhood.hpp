// Weighted averages over the neighbourhood of points, whose bits do not depend on the order or the owner of the points.
//
// Sources: G. Pijaudier-Cabot & Z.P. Bazant, J. Eng. Mech. 113 (1987) 1512-1533, for the bell; LS-DYNA, Keyword User's
// Manual, *MAT_NONLOCAL, for the plateau.
#pragma once

#include <cstdint>
#include <vector>

#include "kerf/erosion.hpp"
#include "kerf/math.hpp"

namespace kerf {

/// Which points count for which, and how much.
class Neighbourhood {
 public:
  struct Point {
    std::int64_t id = 0;
    Vec3 position;  // [m]
    double volume = 0.0;  // [m3]
  };
  Neighbourhood() = default;
  /// Averages are for the first `n_own` of the points.
  Neighbourhood(const std::vector<Point>& points, std::size_t n_own, const NonLocalAverage& law);
  /// The average for point `i` of values of all points. Terms are added in the order of the ids.
  double average(std::size_t i, const std::vector<double>& values) const;

 private:
  struct Term {
    std::int32_t point;
    double weight;  // times volume [m3]
  };
  std::vector<std::size_t> first_;  // term of every own point, and one past the last
  std::vector<Term> terms_;
  std::vector<double> sum_;  // of the weights [m3]
};

}  // namespace kerf
