// Strength without plasticity: hypoelastic, and none at all.
#include <kerf/material.hpp>

namespace {

using namespace kerf;

/// Deviator grows with 2 G times the deviatoric strain increment.
struct Elastic final : PointwiseMaterial<Elastic> {
  double G = 0.0;  // [Pa]
  using State = NoVariables;
  static constexpr bool computes_in_single = true;

  static void describe(Schema<Elastic>& s) {
    s.real(&Elastic::G, "shear_modulus", "Pa", positive, "elastic shear modulus");
  }
  template <class Real>
  void update_point(const PointInputOf<Real>& in, SymTensorOf<Real>& stress, State&, Real& shear_modulus) const {
    stress = stress + static_cast<Real>(2.0 * G) * deviator(in.strain_increment);
    shear_modulus = static_cast<Real>(G);
  }
};

/// No deviator: fluids, and solids where the pressure is all that matters.
struct Hydrodynamic final : PointwiseMaterial<Hydrodynamic> {
  using State = NoVariables;
  static constexpr bool computes_in_single = true;

  static void describe(Schema<Hydrodynamic>&) {}
  template <class Real>
  void update_point(const PointInputOf<Real>&, SymTensorOf<Real>& stress, State&, Real& shear_modulus) const {
    stress = {};
    shear_modulus = 0;
  }
};

}  // namespace

KERF_REGISTER(KERF_TYPE(Elastic, "material", "elastic", "linear hypoelastic strength, never yields")
                  KERF_TYPE(Hydrodynamic, "material", "hydrodynamic", "no strength: the stress is the pressure alone"))
