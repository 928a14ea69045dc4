// Strength with Swift's power-law hardening, for sheet and other ductile metals. An example of a material that is
// built outside Kerf's tree.
//
// Source: H.W. Swift, "Plastic instability under plane stress", J. Mech. Phys. Solids 1 (1952) 1-18.
#include <kerf/material.hpp>

namespace {

using namespace kerf;

/// J2 flow with the flow stress Y(ep) = K (e0 + ep)^n of the equivalent plastic strain ep; radial return to it.
struct Swift final : PointwiseMaterial<Swift> {
  double G = 0.0, K = 0.0;  // [Pa]
  double e0 = 0.0, n = 0.0;  // [-]

  struct State {
    double effective_plastic_strain;
  };

  static void describe(Schema<Swift>& s) {
    s.real(&Swift::G, "shear_modulus", "Pa", positive, "elastic shear modulus");
    s.real(&Swift::K, "strength_coefficient", "Pa", positive, "flow stress where e0 + ep is one");
    s.real(&Swift::e0, "initial_strain", "-", Range{1e-6, 1.0, false, false},
           "strain e0 that fixes the initial yield stress K e0^n");
    s.real(&Swift::n, "hardening_exponent", "-", Range{0.0, 1.0, true, false}, "hardening exponent n");
    s.rule("strength_coefficient", "the initial yield stress K e0^n must be less than the shear modulus",
           [](const Swift& m) { return m.flow_stress(0.0) < m.G; });
    s.state(&State::effective_plastic_strain, "effective_plastic_strain", "-", 0.0,
            "equivalent plastic strain, the time integral of sqrt(2/3 Dp:Dp)");
  }

  void update_point(const PointInput& in, SymTensor& stress, State& state, double& shear_modulus) const {
    // (i) elastic predictor
    const SymTensor trial = stress + (2.0 * G) * deviator(in.strain_increment);
    const double q = von_mises(trial), old_strain = state.effective_plastic_strain;
    // (ii) admissibility: a point within the yield surface keeps d = 0
    const bool yields = q > flow_stress(old_strain);
    // (iii) plastic increment d with r(d) = 3 G d + Y(ep + d) - q = 0. r increases and is concave for n <= 1, so
    // Newton's method climbs from d = 0 to the root and never passes it. The fixed number of iterations keeps all
    // points of a block alike; one that has converged stays where it is.
    double d = 0.0;
    for (int i = 0; i < iterations; ++i) {
      const double total = e0 + old_strain + d, flow = K * kerf::pow(total, n);
      const double residual = q - 3.0 * G * d - flow;
      const bool moves = yields & (residual > 1e-14 * q);
      d += select(moves, residual / (3.0 * G + n * flow / total), 0.0);
    }
    // (iv) radial return
    stress = (1.0 - 3.0 * G * d / (q + 1e-300)) * trial;
    state.effective_plastic_strain = old_strain + d;
    shear_modulus = G;
  }

 private:
  static constexpr int iterations = 10;  // three in steady flow; up to nine where flow begins at a small e0

  double flow_stress(double plastic_strain) const { return K * kerf::pow(e0 + plastic_strain, n); }
};

}  // namespace

KERF_MATERIAL(Swift, "swift", "J2 plasticity with Swift's power-law hardening K (e0 + ep)^n")
