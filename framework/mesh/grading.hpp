// Positions of mesh lines along one axis: uniform, geometric, refined in an interval.
#pragma once

#include <cstdint>
#include <vector>

namespace kerf {

/// n cells between two ends, each a constant factor larger than the one before; `ratio` = last / first size.
/// The ends are met exactly. Pre: n >= 1, ratio > 0.
std::vector<double> graded_lines(double start, double end, std::int64_t n, double ratio);

/// What refined_lines is asked for.
struct RefinedInterval {
  double from = 0.0, to = 0.0;  // interval of fine cells [m]
  double size = 0.0;  // cell size within [m]
  double growth = 1.15;  // largest ratio of neighbouring cells outside
  double coarse = 0.0;  // cell size far away [m]
};

/// Lines on [0, length]: fine cells of equal size within the interval, outside growing geometrically up to
/// the coarse size. Pre: 0 <= from < to <= length, 0 < size <= coarse, growth > 1.
std::vector<double> refined_lines(double length, const RefinedInterval& zone);

/// Whole number of cells nearest to length / size, at least one.
std::int64_t cells_along(double length, double size);

}  // namespace kerf
