// Strength without plasticity: hypoelastic, and none at all.
#include <kerf/material.hpp>

namespace {

using namespace kerf;

/// Deviator grows with 2 G times the deviatoric strain increment.
struct Elastic final : PointwiseMaterial<Elastic> {
  double G = 0.0;  // [Pa]
  using State = NoVariables;

  static void describe(Schema<Elastic>& s) {
    s.real(&Elastic::G, "shear_modulus", "Pa", positive, "elastic shear modulus");
  }
  void update_point(const PointInput& in, SymTensor& stress, State&, double& shear_modulus) const {
    stress = stress + (2.0 * G) * deviator(in.strain_increment);
    shear_modulus = G;
  }
};

/// No deviator: fluids, and solids where the pressure is all that matters.
struct Hydrodynamic final : PointwiseMaterial<Hydrodynamic> {
  using State = NoVariables;

  static void describe(Schema<Hydrodynamic>&) {}
  void update_point(const PointInput&, SymTensor& stress, State&, double& shear_modulus) const {
    stress = SymTensor{};
    shear_modulus = 0.0;
  }
};

}  // namespace

KERF_REGISTER(KERF_TYPE(Elastic, "material", "elastic", "linear hypoelastic strength, never yields")
                  KERF_TYPE(Hydrodynamic, "material", "hydrodynamic", "no strength: the stress is the pressure alone"))
