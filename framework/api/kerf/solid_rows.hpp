// Rows of a block that a kernel of solid elements hands to its laws.
#pragma once

#include "kerf/solid_blocks.hpp"
#include "kerf/solid_motion.hpp"

namespace kerf {

/// Rows of a block, for laws and criteria.
template <class Real>
struct SolidRows {
  StepStrain<Real> step;
  alignas(64) Real deviator[6][lane_width], density[lane_width], energy[lane_width], modulus[lane_width];
  alignas(64) double exact_density[lane_width], pressure[lane_width], bulk[lane_width];  // for the EOS, and from it
  alignas(64) Real length[lane_width];  // of the stable step [m]
};

/// The row itself, or its copy in double precision.
[[gnu::always_inline]] inline const double* widen(const double* row, double*) { return row; }
[[gnu::always_inline]] inline const double* widen(const float* row, double* wide) {
  for (int lane = 0; lane < lane_width; lane += single_lanes) store_lanes(wide + lane, load_lanes(row + lane));
  return wide;
}
/// The step as criteria see it.
template <class Real>
[[gnu::always_inline]] inline const StepStrain<double>& widen(const StepStrain<Real>& step, StepStrain<double>& wide) {
  if constexpr (std::is_same_v<Real, double>) {
    return step;
  } else {
    for (int i = 0; i < 6; ++i) widen(step.strain[i], wide.strain[i]);
    for (int i = 0; i < 9; ++i) widen(step.rotation[i], wide.rotation[i]);
    for (int i = 0; i < 9; i += 4)
      for (int l = 0; l < lane_width; ++l) wide.rotation[i][l] += 1.0;
    return wide;
  }
}

/// Vectors of doubles in the precision of the kernel.
template <class Real>
[[gnu::always_inline]] inline LanesOf<Real> joined(const Lanes (&v)[n_wide<Real>]) {
  if constexpr (std::is_same_v<Real, float>)
    return narrowed(v);
  else
    return v[0];
}

/// The step before the first one: no strain, no rotation.
template <class Real>
void stand_still(StepStrain<Real>& step) {
  step = {};
  for (const int i : {0, 4, 8}) std::fill_n(step.rotation[i], lane_width, diagonal<Real>);
}

}  // namespace kerf
