// How a kernel of solid elements calls its laws: the rows that a law has asked for, tensors that turn with the
// material, and stress that damage has softened.
#pragma once

#include <span>

#include "kerf/solid_rows.hpp"

namespace kerf {

namespace detail {

/// What a law has asked for, as rows of doubles.
struct AskedRows {
  alignas(64) double length[lane_width];
  StepStrain<double> step;
};

template <class Real>
[[gnu::noinline]] void fill_asked(const ElementArrays<Real>& w, int block, unsigned inputs, const SolidRows<Real>& rows,
                                  AskedRows& asked, LawRows& out) {
  if ((inputs & with_length) != 0) out.length = widen(rows.length, asked.length);
  if ((inputs & with_rotation) != 0) out.rotation = widen(rows.step, asked.step).rotation;
  if (!w.place) return;
  out.reference_position = reinterpret_cast<const double(*)[lane_width]>(entry_at(w.place, 4, block, 0, 0));
  out.initial_length = entry_at(w.place, 4, block, 3, 0);
}

/// Step, time, what the law reads, and what it has asked for.
template <class Real>
[[gnu::always_inline]] inline void fill_law_rows(const ElementArrays<Real>& w, int block, const LawAccess& access,
                                                 const SolidRows<Real>& rows, AskedRows& asked, LawRows& out) {
  out.dt = w.dt;
  out.time = w.time;
  if (!access.reads.empty()) out.reads = read_rows(access, block);
  if (access.inputs != 0) [[unlikely]]
    fill_asked(w, block, access.inputs, rows, asked, out);
}

/// Rotates the tensors of a law's state with the material. Pre: both arrays begin on boundaries of 64 bytes.
[[gnu::noinline]] inline void rotate_tensors(std::span<const int> tensors, const double (&rotation)[9][lane_width],
                                             double* state) {
  for (const int first : tensors)
    for (int lane = 0; lane < lane_width; lane += register_lanes) {
      Lanes t[6];
      for (int i = 0; i < 6; ++i) t[i] = load_lanes(state + (first + i) * lane_width + lane);
      rotate_rows<double>(rotation, lane, t);
      for (int i = 0; i < 6; ++i) store_lanes(state + (first + i) * lane_width + lane, t[i]);
    }
}
template <class Real>
void rotate_tensors(std::span<const int> tensors, const StepStrain<Real>& step, double* state) {
  StepStrain<double> in_doubles;
  rotate_tensors(tensors, widen(step, in_doubles).rotation, state);
}

/// Components of ElementArrays::softening.
enum : int {
  next_strength,
  next_tension,
  next_compression,
  strength_applied,
  tension_applied,
  compression_applied,
  n_softening
};
inline constexpr double least_factor = 1e-6;  // below it nothing is left of a stress that could be restored

/// The pressures of this step keep their share.
template <class Real>
void weaken_pressure(const ElementArrays<Real>& w, int block, SolidRows<Real>& rows) {
  const double* tension = entry_at(w.softening, n_softening, block, next_tension, 0);
  const double* compression = entry_at(w.softening, n_softening, block, next_compression, 0);
  for (int l = 0; l < lane_width; ++l) rows.pressure[l] *= select(rows.pressure[l] < 0.0, tension[l], compression[l]);
}

/// Laws see the stress as it would be without softening.
template <class Real>
[[gnu::noinline]] void restore_deviator(const ElementArrays<Real>& w, int block, SolidRows<Real>& rows) {
  const double* applied = entry_at(w.softening, n_softening, block, strength_applied, 0);
  for (int i = 0; i < 6; ++i)
    for (int l = 0; l < lane_width; ++l) rows.deviator[i][l] /= static_cast<Real>(max_of(applied[l], least_factor));
}

/// The pressure of the last step as it would be without softening.
template <class Real, class Number>
void restore_pressure(const ElementArrays<Real>& w, int block, const Real* pressure, Number* sound) {
  const double* tension = entry_at(w.softening, n_softening, block, tension_applied, 0);
  const double* compression = entry_at(w.softening, n_softening, block, compression_applied, 0);
  for (int l = 0; l < lane_width; ++l) {
    const double applied = select(pressure[l] < Real(0.0), tension[l], compression[l]);
    sound[l] = static_cast<Number>(pressure[l] / max_of(applied, least_factor));
  }
}

}  // namespace detail

/// Asks the equation of state for pressure and bulk modulus. The last evaluation of a step leaves the new state.
template <class Real>
void evaluate_eos(ElementArrays<Real>& w, int block, SolidRows<Real>& rows, bool is_last) {
  alignas(64) double wide[lane_width];
  detail::AskedRows asked;
  EosBatch e;
  detail::fill_law_rows(w, block, w.of_eos, rows, asked, e);
  e.reference_density = w.reference_density;
  e.density = rows.exact_density;
  e.specific_energy = widen(rows.energy, wide);
  double* state = entry_at(w.eos_state, w.n_eos_state, block, 0, 0);
  e.state = state;
  if (is_last) e.new_state = state;
  e.pressure = rows.pressure;
  e.bulk_modulus = rows.bulk;
  detail::in_block(*w.eos, block, [&] { w.eos->evaluate(e); });
  if (w.softening) [[unlikely]]
    detail::weaken_pressure(w, block, rows);
}

/// Asks the material for the deviator and the shear modulus.
template <class Real>
void update_material(ElementArrays<Real>& w, int block, SolidRows<Real>& rows) {
  detail::AskedRows asked;
  MaterialRows<Real> m;
  detail::fill_law_rows(w, block, w.of_material, rows, asked, m);
  m.reference_density = w.reference_density;
  m.strain_increment = rows.step.strain;
  m.density = rows.density;
  m.specific_energy = rows.energy;
  m.pressure = entry_at(w.pressure, 1, block, 0, 0);
  alignas(64) Real sound[lane_width];
  if (w.softening) [[unlikely]] {
    detail::restore_pressure(w, block, m.pressure, sound);
    m.pressure = sound;
  }
  m.deviator = rows.deviator;
  m.state = entry_at(w.material_state, w.n_material_state, block, 0, 0);
  m.shear_modulus = rows.modulus;
  if (!w.of_material.tensors.empty()) [[unlikely]]
    detail::rotate_tensors(w.of_material.tensors, rows.step, m.state);
  detail::in_block(*w.material, block, [&] {
    if constexpr (std::is_same_v<Real, float>)
      w.material->update_single(m);
    else
      w.material->update(m);
  });
}

/// Asks the solid for deviator, pressure and moduli, in double precision.
template <class Real>
[[gnu::noinline]] void update_solid(ElementArrays<Real>& w, int block, SolidRows<Real>& rows) {
  alignas(64) double strain[6][lane_width], deviator[6][lane_width], energy[lane_width], modulus[lane_width];
  detail::AskedRows asked;
  SolidBatch m;
  detail::fill_law_rows(w, block, w.of_material, rows, asked, m);
  m.state = entry_at(w.material_state, w.n_material_state, block, 0, 0);
  if (!w.of_material.tensors.empty()) detail::rotate_tensors(w.of_material.tensors, rows.step, m.state);
  const Real* pressure = entry_at(w.pressure, 1, block, 0, 0);
  for (int l = 0; l < lane_width; ++l) {
    for (int i = 0; i < 6; ++i) {
      strain[i][l] = rows.step.strain[i][l];
      deviator[i][l] = rows.deviator[i][l];
    }
    rows.pressure[l] = pressure[l];
  }
  if (w.softening) detail::restore_pressure(w, block, pressure, rows.pressure);
  m.reference_density = w.reference_density;
  m.strain_increment = strain;
  m.density = rows.exact_density;
  m.specific_energy = widen(rows.energy, energy);
  m.deviator = deviator;
  m.pressure = rows.pressure;
  m.shear_modulus = modulus;
  m.bulk_modulus = rows.bulk;
  detail::in_block(*w.solid, block, [&] { w.solid->update(m); });
  for (int l = 0; l < lane_width; ++l) {
    for (int i = 0; i < 6; ++i) rows.deviator[i][l] = static_cast<Real>(deviator[i][l]);
    rows.modulus[l] = static_cast<Real>(modulus[l]);
  }
  if (w.softening) detail::weaken_pressure(w, block, rows);
}

/// Asks whichever law the part has for the deviator: a solid finds the pressure too.
template <class Real>
[[gnu::always_inline]] inline void update_deviator(ElementArrays<Real>& w, int block, SolidRows<Real>& rows) {
  if (w.softening) [[unlikely]]
    detail::restore_deviator(w, block, rows);
  if (w.solid) [[unlikely]]
    update_solid(w, block, rows);
  else
    update_material(w, block, rows);
}

}  // namespace kerf
