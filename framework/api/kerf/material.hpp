// The contract of materials: laws of the stress deviator, written for one point, run over blocks of points.
#pragma once

#include <cstring>
#include <type_traits>

#include "kerf/law.hpp"
#include "kerf/math.hpp"
#include "kerf/plugin.hpp"

namespace kerf {

/// What a material may know of a point in one step.
template <class Real>
struct PointInputOf {
  SymTensorOf<Real> strain_increment;  // midpoint, tensor components [-]
  Real dt = 0;  // [s]
  Real density = 0;  // at the end of the step [kg/m3]
  Real reference_density = 0;  // [kg/m3]
  Real specific_energy = 0;  // internal energy per mass at the start of the step [J/kg]
  Real pressure = 0;  // at the start of the step, positive in compression [Pa]
  double time = 0;  // at the end of the step [s]

  /// Volume over undeformed volume, at the end of the step [-].
  Real volume_ratio() const { return reference_density / density; }
};
using PointInput = PointInputOf<double>;
/// With what a law has asked for: `PointInputWith<inputs>`, see Inputs.
template <unsigned inputs, class Real = double>
struct PointInputWith : PointInputOf<Real>, detail::AskedInputs<inputs> {};

/// One block of `lane_width` points, whose element computes with numbers of type `Real`. Rows have `lane_width`
/// entries; none overlaps another. State is kept in double precision always.
template <class Real>
struct MaterialRows : LawRows {
  double reference_density = 0.0;
  const Real (*strain_increment)[lane_width] = nullptr;  // [6][lane]
  const Real *density = nullptr, *specific_energy = nullptr, *pressure = nullptr;
  Real (*deviator)[lane_width] = nullptr;  // [6][lane] in: rotated to the end of the step; out: updated [Pa]
  double* state = nullptr;  // [variable][lane]
  Real* shear_modulus = nullptr;  // [lane] out: tangent elastic modulus, for the wave speed [Pa]
};
using MaterialBatch = MaterialRows<double>;
using SingleMaterialBatch = MaterialRows<float>;

class Material : public Law {
 public:
  virtual void update(const MaterialBatch& batch) const = 0;
  /// The same for elements of a model with `precision: single`. By default the rows are converted, and update() called.
  [[gnu::noinline]] virtual void update_single(const SingleMaterialBatch& b) const {
    alignas(64) double strain[6][lane_width], deviator[6][lane_width], density[lane_width], energy[lane_width],
        pressure[lane_width], modulus[lane_width];
    for (int l = 0; l < lane_width; ++l) {
      for (int k = 0; k < 6; ++k) strain[k][l] = b.strain_increment[k][l];
      for (int k = 0; k < 6; ++k) deviator[k][l] = b.deviator[k][l];
      density[l] = b.density[l];
      energy[l] = b.specific_energy[l];
      pressure[l] = b.pressure[l];
    }
    MaterialBatch wide;
    static_cast<LawRows&>(wide) = b;
    wide.reference_density = b.reference_density;
    wide.strain_increment = strain;
    wide.density = density;
    wide.specific_energy = energy;
    wide.pressure = pressure;
    wide.deviator = deviator;
    wide.state = b.state;
    wide.shear_modulus = modulus;
    update(wide);
    for (int l = 0; l < lane_width; ++l) {
      for (int k = 0; k < 6; ++k) b.deviator[k][l] = static_cast<float>(deviator[k][l]);
      b.shear_modulus[l] = static_cast<float>(modulus[l]);
    }
  }
  /// Greatest dynamic viscosity of the deviator, for the stable step, where the law is that of a fluid [Pa s].
  virtual double viscosity() const { return 0.0; }
};

/// A material whose law is `void update_point(const PointInput&, SymTensor& deviator, State&, double& shear_modulus)
/// const`; with a `struct Reads`, `update_point(const PointInput&, const Reads&, SymTensor&, State&, double&) const`.
/// `LawType` derives from it and declares `struct State` (doubles and symmetric tensors) and `describe`.
///
/// The law must be free of side effects. Without calls that cannot be inlined, and with choices written so that
/// both sides may be computed, the loop over the points vectorises.
///
/// A law that is a template, `template <class Real> void update_point(const PointInputOf<Real>&, SymTensorOf<Real>&,
/// State&, Real&) const`, and declares `static constexpr bool computes_in_single = true`, computes with floats where
/// the elements do. All others compute in double precision.
template <class LawType>
class PointwiseMaterial : public detail::PointwiseLaw<LawType, Material> {
 public:
  void update(const MaterialBatch& b) const final { update_rows<double>(b); }
  void update_single(const SingleMaterialBatch& b) const final {
    constexpr bool in_single = requires { requires LawType::computes_in_single; };
    update_rows<std::conditional_t<in_single, float, double>>(b);
  }

 private:
  /// Computes with numbers of type `Number`, whatever the rows hold.
  template <class Number, class Real>
  [[gnu::always_inline]] void update_rows(const MaterialRows<Real>& b) const {
    using State = typename LawType::State;
    const auto& law = static_cast<const LawType&>(*this);
    const auto dt = static_cast<Number>(b.dt), reference_density = static_cast<Number>(b.reference_density);
    const auto number = [](Real v) { return static_cast<Number>(v); };
    const auto real = [](Number v) { return static_cast<Real>(v); };
    const Real(*const strain)[lane_width] = b.strain_increment;
    const Real(*const old_stress)[lane_width] = b.deviator;
    const Real *const density = b.density, *const energy = b.specific_energy, *const pressure = b.pressure;
    const double* const old_state = b.state;
    using Reads = typename detail::ReadsOf<LawType>::type;
    constexpr unsigned inputs = detail::inputs_of<LawType>();
    detail::LaneVariables<Reads> reads;
    if constexpr (n_doubles < Reads >> 0) reads.read(b.reads);
    // Results go to local arrays first. Written straight to b, they could alias the law's constants, and the compiler
    // would recompute everything derived from the constants for each lane.
    alignas(64) Real stress[6][lane_width], modulus[lane_width];
    detail::LaneVariables<State> state;
    detail::LaneErrors errors;
    // A function of its own: locals of a simd loop's body whose address is taken would become arrays in memory.
    const auto one_point = [&](int l) __attribute__((always_inline)) {
      PointInputWith<inputs, Number> in;
      in.time = b.time;
      detail::set_asked<inputs>(in, b, l);
      in.strain_increment = {number(strain[0][l]), number(strain[1][l]), number(strain[2][l]),
                             number(strain[3][l]), number(strain[4][l]), number(strain[5][l])};
      in.dt = dt;
      in.density = number(density[l]);
      in.reference_density = reference_density;
      in.specific_energy = number(energy[l]);
      in.pressure = number(pressure[l]);
      SymTensorOf<Number> s = {number(old_stress[0][l]), number(old_stress[1][l]), number(old_stress[2][l]),
                               number(old_stress[3][l]), number(old_stress[4][l]), number(old_stress[5][l])};
      State point = detail::state_at<State>(old_state, l);
      Number g = 0;
      errors.guard(
          l, [&]() __attribute__((always_inline)) {
            if constexpr (n_doubles < Reads >> 0)
              law.update_point(in, reads.at(l), s, point, g);
            else
              law.update_point(in, s, point, g);
          });
      stress[0][l] = real(s.xx);
      stress[1][l] = real(s.yy);
      stress[2][l] = real(s.zz);
      stress[3][l] = real(s.xy);
      stress[4][l] = real(s.yz);
      stress[5][l] = real(s.zx);
      state.set(l, point);
      modulus[l] = real(g);
    };
#pragma omp simd
    for (int l = 0; l < lane_width; ++l) one_point(l);
    errors.throw_first();
    std::memcpy(b.deviator, stress, sizeof stress);
    std::memcpy(b.shear_modulus, modulus, sizeof modulus);
    state.write(b.state);
  }
};

}  // namespace kerf

KERF_SIZES(material, KERF_SIZE(PointInput), KERF_SIZE(MaterialBatch), KERF_SIZE(SingleMaterialBatch),
           KERF_SIZE(Material))
