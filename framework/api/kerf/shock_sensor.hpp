// The sensor that says where the linear bulk viscosity of an element acts: at shocks and behind them.
#pragma once

#include "kerf/lanes.hpp"

namespace kerf {

/// The share of the linear viscosity that acts. Where a wave is smooth, the dilatation rate changes little while the
/// wave crosses an element. In a shock that is captured over a few elements, and in the oscillations behind it, it
/// changes by as much as it is. The sensor follows these changes at once and forgets them slowly. Fronts that have
/// widened to many elements do not show in it; if they are strong, they do in the jump of velocity per element.
/// `rate` is the dilatation rate, `c` the wave speed; the last two point to the state of the piece.
template <class Real>
[[gnu::always_inline]] inline LanesOf<Real> shock_share(LanesOf<Real> length, LanesOf<Real> c, LanesOf<Real> rate,
                                                        Real dt, Real per_dt, Real* last_rate, Real* sensor) {
  using V = LanesOf<Real>;
  // Of the square of the relative change of the dilatation rate per crossing of the element: its factor, its greatest
  // value, and what the sensor loses per crossing by a wave.
  constexpr Real sensor_factor = 2.0, most_sensed = 2.0, sensor_loss = 0.125;
  // Where the velocity jumps by 1/400 of the wave speed across an element, all of the linear viscosity acts anyway.
  constexpr Real jump_factor = 400.0;
  constexpr Real least_rate = 1e-20;  // below it, a dilatation rate counts as zero [1/s]
  const V length2 = length * length, size = abs_of(rate) + least_rate;
  const V inverse = Real(1.0) / (c * length * size);  // divisions are slow: one serves three quotients
  // Way of a wave in the step over the length of the element.
  const V crossed = dt * (c * c) * size * inverse;
  const V change = (rate - load_lanes(last_rate)) * (length2 * inverse) * per_dt;
  const V jump = -jump_factor * rate * length2 * (size * inverse);
  const V forgotten = load_lanes(sensor) - sensor_loss * crossed;
  const V sensed = min_of(max_of(forgotten, sensor_factor * change * change), lanes(most_sensed));
  store_lanes(last_rate, rate);
  store_lanes(sensor, sensed);
  return min_of(max_of(sensed, jump), lanes(Real(1.0)));
}

}  // namespace kerf
