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
};

struct EosOutput {
  double pressure = 0.0;  // positive in compression [Pa]
  double bulk_modulus = 0.0;  // rho c^2 = rho dp/drho at constant e + p/rho dp/de [Pa]
};

/// One block of `lane_width` points; see MaterialBatch.
struct EosBatch {
  double reference_density = 0.0;
  const double *density = nullptr, *specific_energy = nullptr;
  const double* state = nullptr;
  double *pressure = nullptr, *bulk_modulus = nullptr;
};

class Eos : public Law {
 public:
  /// False where the pressure does not depend on energy: the energy equation then needs no second evaluation.
  virtual bool uses_energy() const { return true; }
  /// Internal energy per reference volume at the start, which `specific_energy` does not contain [J/m3]. The energy
  /// balance adds it to what elements have taken up since.
  virtual double initial_energy_density() const { return 0.0; }
  /// Must not change the state: the energy equation evaluates it more than once per step.
  virtual void evaluate(const EosBatch& batch) const = 0;
};

/// An EOS whose law is `EosOutput evaluate_point(const EosInput&, const State&) const`.
template <class LawType>
class PointwiseEos : public Eos {
 public:
  void evaluate(const EosBatch& b) const final {
    using State = typename LawType::State;
    alignas(64) double density[lane_width], energy[lane_width], pressure[lane_width], modulus[lane_width];
    detail::LaneVariables<State> state;
    for (int l = 0; l < lane_width; ++l) {
      density[l] = b.density[l];
      energy[l] = b.specific_energy[l];
    }
    state.read(b.state);
    const double reference_density = b.reference_density;
    const auto& law = static_cast<const LawType&>(*this);
    // A function of its own: locals of a simd loop's body whose address is taken would become arrays in memory.
    const auto one_point = [&](int l) __attribute__((always_inline)) {
      const EosInput in{density[l], reference_density, energy[l]};
      const EosOutput out = law.evaluate_point(in, state.at(l));
      pressure[l] = out.pressure;
      modulus[l] = out.bulk_modulus;
    };
#pragma omp simd
    for (int l = 0; l < lane_width; ++l) one_point(l);
    for (int l = 0; l < lane_width; ++l) {
      b.pressure[l] = pressure[l];
      b.bulk_modulus[l] = modulus[l];
    }
  }
};

}  // namespace kerf
