// Strength of a metal that hardens linearly and resists fast flow: viscoplasticity after Perzyna.
//
// Sources: P. Perzyna, "Fundamental problems in viscoplasticity", Adv. Appl. Mech. 9 (1966) 243-377; J.C. Simo &
// T.J.R. Hughes, Computational Inelasticity (1998), boxes 3.1 (radial return) and 3.2 (viscosity).
#include <kerf/material.hpp>

namespace {

using namespace kerf;

/// J2 flow with q = Y0 + H ep + eta ep' while it flows, q the von Mises stress and ep the equivalent plastic strain.
struct @TYPE@ final : PointwiseMaterial<@TYPE@> {
  double G = 0.0, Y0 = 0.0, H = 0.0;  // [Pa]
  double eta = 0.0;  // [Pa s]

  struct State {
    double effective_plastic_strain, plastic_strain_rate;
  };

  static void describe(Schema<@TYPE@>& s) {
    s.real(&@TYPE@::G, "shear_modulus", "Pa", positive, "elastic shear modulus");
    s.real(&@TYPE@::Y0, "yield_stress", "Pa", positive, "initial yield stress of slow deformation");
    s.real(&@TYPE@::H, "hardening_modulus", "Pa", non_negative, "slope of the yield stress over the plastic strain")
        .by_default("0 Pa");
    s.real(&@TYPE@::eta, "viscosity", "Pa s", non_negative, "overstress per plastic strain rate; 0 for none")
        .by_default("0 Pa s");
    s.rule("yield_stress", "yield_stress must be less than shear_modulus", [](const @TYPE@& m) { return m.Y0 < m.G; });
    s.state(&State::effective_plastic_strain, "effective_plastic_strain", "-", 0.0,
            "equivalent plastic strain, the time integral of sqrt(2/3 Dp:Dp)")
        .within(non_negative);
    s.state(&State::plastic_strain_rate, "plastic_strain_rate", "1/s", 0.0, "its rate in the last step")
        .within(non_negative);
  }

  void update_point(const PointInput& in, SymTensor& stress, State& state, double& shear_modulus) const {
    // (i) elastic predictor
    const SymTensor trial = stress + (2.0 * G) * deviator(in.strain_increment);
    const double q = von_mises(trial), per_dt = 1.0 / (in.dt + tiny<double>);
    // (ii) admissibility: a point within the yield surface has no plastic increment
    const double excess = max_of(q - (Y0 + H * state.effective_plastic_strain), 0.0);
    // (iii) plastic increment d with q - 3 G d = Y0 + H (ep + d) + eta d/dt, the rate being that of this very step
    const double d = excess / (3.0 * G + H + eta * per_dt);
    // (iv) radial return
    stress = (1.0 - 3.0 * G * d / (q + tiny<double>)) * trial;
    state.effective_plastic_strain += d;
    state.plastic_strain_rate = d * per_dt;
    shear_modulus = G;
  }
};

}  // namespace

KERF_MATERIAL(@TYPE@, "@NAME@", "J2 plasticity with linear hardening and an overstress in proportion to the rate")
