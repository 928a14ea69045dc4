// The contract of solids: laws of the whole stress, in place of a strength and an equation of state.
//
// It fits materials whose pressure and deviator share a state: concrete, ceramics, soils, and user materials that bring
// their own pressure.
#pragma once

#include "kerf/law.hpp"
#include "kerf/math.hpp"
#include "kerf/plugin.hpp"

namespace kerf {

/// What a solid may know of a point in one step.
struct SolidInput {
  SymTensor strain_increment;  // midpoint, tensor components [-]
  double dt = 0.0;  // [s]
  double time = 0.0;  // at the end of the step [s]
  double density = 0.0;  // at the end of the step [kg/m3]
  double reference_density = 0.0;  // [kg/m3]
  double specific_energy = 0.0;  // internal energy per mass at the start of the step [J/kg]

  /// Volume over undeformed volume, at the end of the step [-].
  double volume_ratio() const { return reference_density / density; }
};
/// With what a law has asked for: `SolidInputWith<inputs>`, see Inputs.
template <unsigned inputs>
struct SolidInputWith : SolidInput, detail::AskedInputs<inputs> {};

/// Tangent elastic moduli, for the wave speed [Pa].
struct SolidModuli {
  double shear = 0.0, bulk = 0.0;
};

/// One block of `lane_width` points; see MaterialBatch.
struct SolidBatch : LawRows {
  double reference_density = 0.0;
  const double (*strain_increment)[lane_width] = nullptr;  // [6][lane]
  const double *density = nullptr, *specific_energy = nullptr;
  double (*deviator)[lane_width] = nullptr;  // [6][lane] in: rotated to the end of the step; out: updated [Pa]
  double* pressure = nullptr;  // in: at the start of the step; out: at its end, positive in compression [Pa]
  double* state = nullptr;  // [variable][lane]
  double *shear_modulus = nullptr, *bulk_modulus = nullptr;  // out [Pa]
};

/// The element closes the energy equation with the mean of the old and the new stress.
class Solid : public Law {
 public:
  /// See Eos::initial_energy_density [J/m3].
  virtual double initial_energy_density() const { return 0.0; }
  /// Called once per step, and once with no strain before the first step, for the moduli and the initial stress.
  virtual void update(const SolidBatch& batch) const = 0;
};

/// A solid whose law is `void update_point(const SolidInput&, SymTensor& stress, State&, SolidModuli&) const`, with the
/// Cauchy stress, positive in tension [Pa]: in, as the step before left it, rotated to the end of this step; out,
/// updated. With a `struct Reads`, `update_point(const SolidInput&, const Reads&, SymTensor&, State&, SolidModuli&)`.
template <class LawType>
class PointwiseSolid : public detail::PointwiseLaw<LawType, Solid> {
 public:
  void update(const SolidBatch& b) const final {
    using State = typename LawType::State;
    using Reads = typename detail::ReadsOf<LawType>::type;
    constexpr unsigned inputs = detail::inputs_of<LawType>();
    const auto& law = static_cast<const LawType&>(*this);
    alignas(64) double deviator[6][lane_width], pressure[lane_width], shear[lane_width], bulk[lane_width];
    detail::LaneVariables<State> state;
    detail::LaneVariables<Reads> reads;
    state.read(b.state);
    if constexpr (n_doubles < Reads >> 0) reads.read(b.reads);
    detail::LaneErrors errors;
    // A function of its own: locals of a simd loop's body whose address is taken would become arrays in memory.
    const auto one_point = [&](int l) __attribute__((always_inline)) {
      SolidInputWith<inputs> in;
      in.strain_increment = detail::tensor_at(b.strain_increment, l);
      in.dt = b.dt;
      in.time = b.time;
      in.density = b.density[l];
      in.reference_density = b.reference_density;
      in.specific_energy = b.specific_energy[l];
      detail::set_asked<inputs>(in, b, l);
      SymTensor stress = detail::tensor_at(b.deviator, l);
      stress.xx -= b.pressure[l];
      stress.yy -= b.pressure[l];
      stress.zz -= b.pressure[l];
      State point = state.at(l);
      SolidModuli moduli;
      errors.guard(
          l, [&]() __attribute__((always_inline)) {
            if constexpr (n_doubles < Reads >> 0)
              law.update_point(in, reads.at(l), stress, point, moduli);
            else
              law.update_point(in, stress, point, moduli);
          });
      detail::set_tensor(deviator, l, kerf::deviator(stress));
      pressure[l] = -(1.0 / 3.0) * stress.trace();
      shear[l] = moduli.shear;
      bulk[l] = moduli.bulk;
      state.set(l, point);
    };
#pragma omp simd
    for (int l = 0; l < lane_width; ++l) one_point(l);
    errors.throw_first();
    for (int l = 0; l < lane_width; ++l) {
      for (int i = 0; i < 6; ++i) b.deviator[i][l] = deviator[i][l];
      b.pressure[l] = pressure[l];
      b.shear_modulus[l] = shear[l];
      b.bulk_modulus[l] = bulk[l];
    }
    state.write(b.state);
  }
};

}  // namespace kerf

KERF_SIZES(solid, KERF_SIZE(SolidInput), KERF_SIZE(SolidModuli), KERF_SIZE(SolidBatch), KERF_SIZE(Solid))
