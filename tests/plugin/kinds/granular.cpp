// A solid outside of Kerf's tree: sand, whose stiffness and strength both come from the pressure on it.
//
// Source: D.C. Drucker & W. Prager, Q. Appl. Math. 10 (1952) 157-165; the flow changes no volume.
#include <kerf/solid.hpp>

/// q <= m p, p' = -K tr(D), not below zero.
struct Granular final : kerf::PointwiseSolid<Granular> {
  double G = 0.0, K = 0.0, m = 0.0;  // [Pa], [Pa], [-]

  struct State {
    double effective_plastic_strain;
  };

  static void describe(kerf::Schema<Granular>& s) {
    s.real(&Granular::G, "shear_modulus", "Pa", kerf::positive, "elastic shear modulus");
    s.real(&Granular::K, "bulk_modulus", "Pa", kerf::positive, "elastic bulk modulus");
    s.real(&Granular::m, "friction", "-", kerf::positive, "von Mises stress that flows, over the pressure");
    s.state(&State::effective_plastic_strain, "effective_plastic_strain", "-", 0.0, "equivalent plastic strain");
  }
  void update_point(const kerf::SolidInput& in, kerf::SymTensor& stress, State& state,
                    kerf::SolidModuli& moduli) const {
    const double p = kerf::max_of(-stress.trace() / 3.0 - K * in.strain_increment.trace(), 0.0);
    const kerf::SymTensor trial = deviator(stress) + (2.0 * G) * deviator(in.strain_increment);
    const double q = von_mises(trial), held = kerf::min_of(q, m * p);
    stress = (held / (q + kerf::tiny<double>)) * trial - kerf::SymTensor{p, p, p, 0.0, 0.0, 0.0};
    state.effective_plastic_strain += (q - held) / (3.0 * G);
    moduli = {G, K};
  }
};

KERF_SOLID(Granular, "granular", "friction alone holds it together")
