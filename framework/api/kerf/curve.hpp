// Named curves of the input: piecewise linear functions of time that plugins take as factors.
#pragma once

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <utility>
#include <vector>

#include "kerf/sizes.hpp"

namespace kerf {

/// A piecewise linear function of time without a unit. Outside of its points it is constant, or repeats itself. A
/// plugin has a member `const Curve* curve = nullptr` and declares it by Schema::curve; the engine keeps the curve
/// alive.
class Curve {
 public:
  /// Zero at all times.
  Curve() : Curve({0.0}, {0.0}) {}
  /// Pre: `times` [s] ascend strictly; as many values [-]; at least one of each. A positive `period` [s] is not less
  /// than last minus first time, and repeats the points for all times; from the last point the curve then runs straight
  /// to the first point of the next period.
  Curve(std::vector<double> times, std::vector<double> values, double period = 0.0)
      : times_(std::move(times)), values_(std::move(values)), period_(period) {}

  /// The value at a time [s].
  double at(double time) const {
    time = in_first_period(time);
    const auto next = static_cast<std::size_t>(std::upper_bound(times_.begin(), times_.end(), time) - times_.begin());
    if (next == 0) return values_.front();
    const std::size_t last = next - 1;
    if (next < times_.size()) return between(time, times_[last], times_[next], values_[last], values_[next]);
    const double end = times_.front() + period_;
    if (!(period_ > 0.0) || !(end > times_[last])) return values_[last];
    return between(time, times_[last], end, values_[last], values_.front());
  }
  /// The slope from a time [s] on [1/s].
  double slope_after(double time) const {
    time = in_first_period(time);
    const auto next = static_cast<std::size_t>(std::upper_bound(times_.begin(), times_.end(), time) - times_.begin());
    if (next == 0) return 0.0;
    const std::size_t last = next - 1;
    if (next < times_.size()) return (values_[next] - values_[last]) / (times_[next] - times_[last]);
    const double end = times_.front() + period_;
    if (!(period_ > 0.0) || !(end > times_[last])) return 0.0;
    return (values_.front() - values_[last]) / (end - times_[last]);
  }
  /// Upper bound of the magnitude at all times.
  double greatest() const {
    double most = 0.0;
    for (const double v : values_) most = std::max(most, std::fabs(v));
    return most;
  }

 private:
  /// The time at which a curve that repeats itself has the same value first.
  double in_first_period(double time) const {
    if (!(period_ > 0.0)) return time;
    // The remainder is exact, so that equal phases have equal values.
    const double phase = std::fmod(time - times_.front(), period_);
    return times_.front() + (phase < 0.0 ? phase + period_ : phase);
  }
  static double between(double time, double from, double to, double first, double second) {
    return first + (time - from) / (to - from) * (second - first);
  }

  std::vector<double> times_, values_;  // [s], [-]
  double period_;  // [s]; 0 where nothing repeats
};

/// The value of an optional curve: 1 where there is none.
inline double value_of(const Curve* curve, double time) { return curve != nullptr ? curve->at(time) : 1.0; }
/// Upper bound of the magnitude of an optional curve: 1 where there is none.
inline double greatest_of(const Curve* curve) { return curve != nullptr ? curve->greatest() : 1.0; }

}  // namespace kerf

KERF_SIZES(curve, KERF_SIZE(Curve))
