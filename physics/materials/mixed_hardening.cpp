// Elastic-plastic strength with isotropic and kinematic linear hardening.
//
// Sources: W. Prager, J. Appl. Mech. 23 (1956) 493-496, for the back stress; J.C. Simo & T.J.R. Hughes, Computational
// Inelasticity (1998), box 3.2 (radial return with mixed hardening).
#include <kerf/material.hpp>

namespace {

using namespace kerf;

/// Flow where the equivalent of s - a reaches Y0 + beta Ep ep; the back stress follows the plastic flow,
/// a' = 2/3 (1 - beta) Ep Dp, and rotates with the material.
struct MixedHardening final : PointwiseMaterial<MixedHardening> {
  double G = 0.0, Y0 = 0.0, Ep = 0.0, beta = 0.0;  // [Pa], [Pa], [Pa], [-]

  struct State {
    double effective_plastic_strain;
    SymTensor back_stress;
  };

  static void describe(Schema<MixedHardening>& s) {
    s.real(&MixedHardening::G, "shear_modulus", "Pa", positive, "elastic shear modulus");
    s.real(&MixedHardening::Y0, "yield_stress", "Pa", positive, "initial yield stress in uniaxial tension");
    s.real(&MixedHardening::Ep, "hardening_modulus", "Pa", non_negative, "slope of stress over plastic strain");
    s.real(&MixedHardening::beta, "isotropic_share", "-", fraction,
           "share of the hardening that widens the yield surface: 1 isotropic, 0 kinematic");
    s.state(&State::effective_plastic_strain, "effective_plastic_strain", "-", 0.0,
            "equivalent plastic strain, the time integral of sqrt(2/3 Dp:Dp)")
        .within(non_negative);
    s.state(&State::back_stress, "back_stress", "Pa", "centre of the yield surface");
  }

  void update_point(const PointInput& in, SymTensor& stress, State& state, double& shear_modulus) const {
    const double isotropic = beta * Ep, kinematic = (1.0 - beta) * Ep;
    const SymTensor trial = stress + (2.0 * G) * deviator(in.strain_increment),
                    reduced = trial - deviator(state.back_stress);
    const double q = von_mises(reduced);
    const double over = q - (Y0 + isotropic * state.effective_plastic_strain);
    const double d = max_of(over, 0.0) / (3.0 * G + kinematic + isotropic);
    // The direction of flow times 3/2 is that of the reduced stress over its equivalent.
    const double per_q = d / (q + tiny<double>);
    stress = trial - (3.0 * G * per_q) * reduced;
    state.back_stress = state.back_stress + (kinematic * per_q) * reduced;
    state.effective_plastic_strain += d;
    shear_modulus = G;
  }
};

}  // namespace

KERF_MATERIAL(MixedHardening, "mixed_hardening", "J2 flow with isotropic and kinematic linear hardening")
