// Rows of a block that a kernel of solid elements hands to materials and equations of state.
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

/// Asks the equation of state for pressure and bulk modulus.
template <class Real>
void evaluate_eos(ElementArrays<Real>& w, int block, SolidRows<Real>& rows) {
  alignas(64) double wide[lane_width];
  EosBatch e;
  e.reference_density = w.reference_density;
  e.density = rows.exact_density;
  e.specific_energy = widen(rows.energy, wide);
  e.state = entry_at(w.eos_state, w.n_eos_state, block, 0, 0);
  e.pressure = rows.pressure;
  e.bulk_modulus = rows.bulk;
  w.eos->evaluate(e);
}

/// Asks the material for the deviator and the shear modulus.
template <class Real>
void update_material(ElementArrays<Real>& w, int block, SolidRows<Real>& rows) {
  MaterialRows<Real> m;
  m.dt = w.dt;
  m.reference_density = w.reference_density;
  m.strain_increment = rows.step.strain;
  m.density = rows.density;
  m.specific_energy = rows.energy;
  m.pressure = entry_at(w.pressure, 1, block, 0, 0);
  m.deviator = rows.deviator;
  m.state = entry_at(w.material_state, w.n_material_state, block, 0, 0);
  m.shear_modulus = rows.modulus;
  if constexpr (std::is_same_v<Real, float>)
    w.material->update_single(m);
  else
    w.material->update(m);
}

}  // namespace kerf
