// Positions of mesh lines along one axis: uniform, geometric, refined in an interval.
#pragma once

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <vector>

#include "kerf/functions.hpp"

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

// ---- how it is done

namespace detail {

// Total length of n cells that start at `first` * q and grow by q up to `coarse`.
inline double grown_length(double first, double q, double coarse, std::int64_t n) {
  double total = 0.0, size = first;
  for (std::int64_t i = 0; i < n; ++i) {
    size = std::min(size * q, coarse);
    total += size;
  }
  return total;
}

// Sizes of the cells outside the fine interval, from the inside outwards; they fill `length` exactly.
inline std::vector<double> outer_sizes(double length, double fine, double growth, double coarse) {
  std::int64_t n = 0;
  for (double total = 0.0, size = fine; total < length * (1.0 - 1e-12); ++n) {
    size = std::min(size * growth, coarse);
    total += size;
  }
  // Too short a stretch for any growth: cells as near to the fine size as the length allows.
  if (grown_length(fine, 1.0, coarse, n) >= length) {
    const std::int64_t cells = cells_along(length, fine);
    return std::vector<double>(static_cast<std::size_t>(cells), length / static_cast<double>(cells));
  }
  // n cells at full growth overshoot and without growth fall short; the growth in between that fits:
  double low = 1.0, high = growth;
  for (int i = 0; i < 100; ++i) {
    const double q = 0.5 * (low + high);
    (grown_length(fine, q, coarse, n) < length ? low : high) = q;
  }
  std::vector<double> sizes;
  double size = fine, total = 0.0;
  for (std::int64_t i = 0; i < n; ++i) {
    size = std::min(size * high, coarse);
    total += size;
    sizes.push_back(size);
  }
  for (double& s : sizes) s *= length / total;
  return sizes;
}

}  // namespace detail

inline std::int64_t cells_along(double length, double size) {
  return std::max<std::int64_t>(1, static_cast<std::int64_t>(std::llround(length / size)));
}

inline std::vector<double> graded_lines(double start, double end, std::int64_t n, double ratio) {
  std::vector<double> lines(static_cast<std::size_t>(n) + 1);
  // expm1 keeps the formula exact to rounding as q approaches one: x_i = (q^i - 1) / (q^n - 1).
  const double log_q = n > 1 ? kerf::log(ratio) / static_cast<double>(n - 1) : 0.0;
  const bool uniform = std::abs(log_q) * static_cast<double>(n) < 1e-12;
  for (std::int64_t i = 0; i <= n; ++i) {
    const double part = static_cast<double>(i) / static_cast<double>(n);
    const double t =
        uniform ? part : kerf::expm1(log_q * static_cast<double>(i)) / kerf::expm1(log_q * static_cast<double>(n));
    lines[static_cast<std::size_t>(i)] = start + (end - start) * t;
  }
  lines.back() = end;
  return lines;
}

inline std::vector<double> refined_lines(double length, const RefinedInterval& zone) {
  const double tiny = 1e-9 * length;
  std::vector<double> lines{0.0};
  if (zone.from > tiny) {
    const auto sizes = detail::outer_sizes(zone.from, zone.size, zone.growth, zone.coarse);
    for (auto s = sizes.rbegin(); s != sizes.rend(); ++s) lines.push_back(lines.back() + *s);
    lines.back() = zone.from;
  }
  const bool reaches_end = length - zone.to <= tiny;
  const double fine_start = lines.back(), fine_end = reaches_end ? length : zone.to;
  const auto fine = graded_lines(fine_start, fine_end, cells_along(fine_end - fine_start, zone.size), 1.0);
  lines.insert(lines.end(), fine.begin() + 1, fine.end());
  if (!reaches_end) {
    for (const double s : detail::outer_sizes(length - zone.to, zone.size, zone.growth, zone.coarse))
      lines.push_back(lines.back() + s);
    lines.back() = length;
  }
  return lines;
}

}  // namespace kerf
