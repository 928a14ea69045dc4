// Soils and other bodies whose strength grows with the pressure: a cone of Drucker and Prager, with a tension cut-off.
//
// Source: D.C. Drucker & W. Prager, "Soil mechanics and plastic analysis or limit design", Q. Appl. Math. 10 (1952)
// 157-165. The flow changes no volume.
#include <kerf/solid.hpp>

namespace {

using namespace kerf;

/// q <= c + m p with the von Mises stress q and the pressure p = K ln(rho/rho0), which is not below -T.
struct @TYPE@ final : PointwiseSolid<@TYPE@> {
  double G = 0.0, K = 0.0;  // [Pa]
  double c = 0.0, m = 0.0, T = 0.0;  // [Pa], [-], [Pa]

  struct State {
    double effective_plastic_strain;
  };

  static void describe(Schema<@TYPE@>& s) {
    s.real(&@TYPE@::G, "shear_modulus", "Pa", positive, "elastic shear modulus");
    s.real(&@TYPE@::K, "bulk_modulus", "Pa", positive, "elastic bulk modulus");
    s.real(&@TYPE@::c, "cohesion", "Pa", non_negative, "von Mises stress at which it yields without pressure");
    s.real(&@TYPE@::m, "friction", "-", between(0.0, 3.0), "growth of the strength with the pressure");
    s.real(&@TYPE@::T, "tension_limit", "Pa", non_negative, "least pressure, with its sign changed").by_default("0 Pa");
    s.rule("tension_limit", "tension_limit must not be beyond the apex of the cone, cohesion / friction",
           [](const @TYPE@& law) { return law.m * law.T <= law.c; });
    s.state(&State::effective_plastic_strain, "effective_plastic_strain", "-", 0.0,
            "equivalent plastic strain, the time integral of sqrt(2/3 Dp:Dp)")
        .within(non_negative);
  }

  void update_point(const SolidInput& in, SymTensor& stress, State& state, SolidModuli& moduli) const {
    // (i) pressure, and elastic predictor of the deviator
    const double p = max_of(K * kerf::log(in.density / in.reference_density), -T);
    const SymTensor trial = deviator(stress) + (2.0 * G) * deviator(in.strain_increment);
    // (ii) radial return, at constant pressure, to the strength at this pressure
    const double q = von_mises(trial), held = min_of(q, max_of(c + m * p, 0.0));
    stress = (held / (q + tiny<double>)) * trial - SymTensor{p, p, p, 0.0, 0.0, 0.0};
    state.effective_plastic_strain += (q - held) / (3.0 * G);
    // (iii) an upper bound of both tangents, for the wave speed
    moduli = {G, K};
  }
};

}  // namespace

KERF_SOLID(@TYPE@, "@NAME@", "elastic up to a strength that grows with the pressure, with a tension cut-off")
