// The contract of equations of state: pressure and adiabatic bulk modulus from density and energy.
#pragma once

#include "kerf/law.hpp"
#include "kerf/math.hpp"
#include "kerf/plugin.hpp"

namespace kerf {

struct EosInput {
  double density = 0.0;  // [kg/m3]
  double reference_density = 0;  // [kg/m3]
  double specific_energy = 0.0;  // internal energy per mass [J/kg]
  double dt = 0.0;  // [s]
  double time = 0.0;  // at the end of the step [s]

  /// Volume over undeformed volume [-].
  double volume_ratio() const { return reference_density / density; }
};
/// With what a law has asked for: `EosInputWith<inputs>`, see Inputs.
template <unsigned inputs>
struct EosInputWith : EosInput, detail::AskedInputs<inputs> {};

struct EosOutput {
  double pressure = 0.0;  // positive in compression [Pa]
  double bulk_modulus = 0.0;  // rho c^2 = rho dp/drho at constant e + p/rho dp/de [Pa]
};

/// One block of `lane_width` points; see MaterialBatch.
struct EosBatch : LawRows {
  double reference_density = 0.0;
  const double *density = nullptr, *specific_energy = nullptr;
  const double* state = nullptr;  // [variable][lane] as the last step left it
  /// As this step leaves it; null where the evaluation is not the step's last. May be the same memory as `state`: read
  /// all of that before.
  double* new_state = nullptr;
  double *pressure = nullptr, *bulk_modulus = nullptr;
};

class Eos : public Law {
 public:
  /// False where the pressure does not depend on energy: the energy equation then needs no second evaluation.
  virtual bool uses_energy() const { return true; }
  /// Internal energy per reference volume at the start, which `specific_energy` does not contain [J/m3]. The energy
  /// balance adds it to what elements have taken up since.
  virtual double initial_energy_density() const { return 0.0; }
  /// The energy equation evaluates it more than once per step, each time from the state at the start of the step. Only
  /// the last evaluation of a step is asked for the new state.
  virtual void evaluate(const EosBatch& batch) const = 0;
};

/// An EOS whose law is `EosOutput evaluate_point(const EosInput&, const State&) const`. A law with history takes a
/// `State&` and changes it as the step does; what all evaluations but the last have made of it is forgotten. With a
/// `struct Reads`, `evaluate_point(const EosInput&, const Reads&, State&) const`.
template <class LawType>
class PointwiseEos : public detail::PointwiseLaw<LawType, Eos> {
 public:
  void evaluate(const EosBatch& b) const final {
    using State = typename LawType::State;
    using Reads = typename detail::ReadsOf<LawType>::type;
    constexpr unsigned inputs = detail::inputs_of<LawType>();
    constexpr bool leaves_state = requires(const LawType& law, const State& s) {
      law.evaluate_point(EosInputWith<inputs>{}, s);
    }
    || requires(const LawType& law, const State& s) { law.evaluate_point(EosInputWith<inputs>{}, Reads{}, s); };
    alignas(64) double density[lane_width], energy[lane_width], pressure[lane_width], modulus[lane_width];
    detail::LaneVariables<State> state;
    for (int l = 0; l < lane_width; ++l) {
      density[l] = b.density[l];
      energy[l] = b.specific_energy[l];
    }
    state.read(b.state);
    detail::LaneVariables<Reads> reads;
    if constexpr (n_doubles < Reads >> 0) reads.read(b.reads);
    const double reference_density = b.reference_density, dt = b.dt, time = b.time;
    const auto& law = static_cast<const LawType&>(*this);
    detail::LaneErrors errors;
    // A function of its own: locals of a simd loop's body whose address is taken would become arrays in memory.
    const auto one_point = [&](int l) __attribute__((always_inline)) {
      EosInputWith<inputs> in;
      in.density = density[l];
      in.reference_density = reference_density;
      in.specific_energy = energy[l];
      in.dt = dt;
      in.time = time;
      detail::set_asked<inputs>(in, b, l);
      State point = state.at(l);
      EosOutput out;
      errors.guard(
          l, [&]() __attribute__((always_inline)) {
            if constexpr (n_doubles < Reads >> 0)
              out = law.evaluate_point(in, reads.at(l), point);
            else
              out = law.evaluate_point(in, point);
          });
      if constexpr (!leaves_state) state.set(l, point);
      pressure[l] = out.pressure;
      modulus[l] = out.bulk_modulus;
    };
#pragma omp simd
    for (int l = 0; l < lane_width; ++l) one_point(l);
    errors.throw_first();
    for (int l = 0; l < lane_width; ++l) {
      b.pressure[l] = pressure[l];
      b.bulk_modulus[l] = modulus[l];
    }
    if constexpr (!leaves_state)
      if (b.new_state) state.write(b.new_state);
  }
};

}  // namespace kerf

KERF_SIZES(eos, KERF_SIZE(EosInput), KERF_SIZE(EosOutput), KERF_SIZE(EosBatch), KERF_SIZE(Eos))
