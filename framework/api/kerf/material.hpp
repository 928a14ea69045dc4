// The contract of materials: laws of the stress deviator, written for one point, run over blocks of points.
#pragma once

#include "kerf/law.hpp"
#include "kerf/math.hpp"
#include "kerf/plugin.hpp"

namespace kerf {

/// What a material may know of a point in one step.
struct PointInput {
  SymTensor strain_increment;  // midpoint, tensor components [-]
  double dt = 0.0;  // [s]
  double density = 0.0;  // at the end of the step [kg/m3]
  double reference_density = 0;  // [kg/m3]
  double specific_energy = 0.0;  // internal energy per mass at the start of the step [J/kg]
  double pressure = 0.0;  // at the start of the step, positive in compression [Pa]
};

/// One block of `lane_width` points. Rows have `lane_width` entries; none overlaps another.
struct MaterialBatch {
  double dt = 0.0, reference_density = 0.0;
  const double (*strain_increment)[lane_width] = nullptr;  // [6][lane]
  const double *density = nullptr, *specific_energy = nullptr, *pressure = nullptr;
  double (*deviator)[lane_width] = nullptr;  // [6][lane] in: rotated to the end of the step; out: updated [Pa]
  double* state = nullptr;  // [variable][lane]
  double* shear_modulus = nullptr;  // [lane] out: tangent elastic modulus, for the wave speed [Pa]
};

class Material : public Law {
 public:
  virtual void update(const MaterialBatch& batch) const = 0;
};

/// A material whose law is `void update_point(const PointInput&, SymTensor& deviator, State&, double& shear_modulus)
/// const`. `Law` derives from it and may declare `struct State` (doubles only) and `describe`.
///
/// The law must be free of side effects. Without calls that cannot be inlined, and with choices written so that
/// both sides may be computed, the loop over the points vectorises.
template <class LawType>
class PointwiseMaterial : public Material {
 public:
  void update(const MaterialBatch& b) const final {
    using State = typename LawType::State;
    // On boundaries of cache lines, so that no compiler peels lanes off the loop: those would be computed otherwise.
    alignas(64) double strain[6][lane_width], stress[6][lane_width], modulus[lane_width];
    alignas(64) double density[lane_width], energy[lane_width], pressure[lane_width];
    detail::LaneVariables<State> state;
    for (int k = 0; k < 6; ++k)
      for (int l = 0; l < lane_width; ++l) {
        strain[k][l] = b.strain_increment[k][l];
        stress[k][l] = b.deviator[k][l];
      }
    for (int l = 0; l < lane_width; ++l) {
      density[l] = b.density[l];
      energy[l] = b.specific_energy[l];
      pressure[l] = b.pressure[l];
    }
    state.read(b.state);
    const double dt = b.dt, reference_density = b.reference_density;
    const auto& law = static_cast<const LawType&>(*this);
    // A function of its own: locals of a simd loop's body whose address is taken would become arrays in memory.
    const auto one_point = [&](int l) __attribute__((always_inline)) {
      PointInput in;
      in.strain_increment = detail::tensor_at(strain, l);
      in.dt = dt;
      in.density = density[l];
      in.reference_density = reference_density;
      in.specific_energy = energy[l];
      in.pressure = pressure[l];
      SymTensor s = detail::tensor_at(stress, l);
      State point = state.at(l);
      double g = 0.0;
      law.update_point(in, s, point, g);
      detail::set_tensor(stress, l, s);
      state.set(l, point);
      modulus[l] = g;
    };
#pragma omp simd
    for (int l = 0; l < lane_width; ++l) one_point(l);
    for (int k = 0; k < 6; ++k)
      for (int l = 0; l < lane_width; ++l) b.deviator[k][l] = stress[k][l];
    for (int l = 0; l < lane_width; ++l) b.shear_modulus[l] = modulus[l];
    state.write(b.state);
  }
};

}  // namespace kerf
