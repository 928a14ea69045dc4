// An equation of state outside of Kerf's tree: Tait's, of liquids.
//
// Source: R.H. Cole, "Underwater Explosions", Princeton 1948, section 2.3.
#include <kerf/eos.hpp>

/// p = B ((rho/rho0)^n - 1), not below the pressure at which the liquid boils.
struct Tait final : kerf::PointwiseEos<Tait> {
  double B = 0.0, n = 0.0, least = 0.0;  // [Pa], [-], [Pa]
  using State = kerf::NoVariables;

  static void describe(kerf::Schema<Tait>& s) {
    s.real(&Tait::B, "B", "Pa", kerf::positive, "pressure scale");
    s.real(&Tait::n, "n", "-", kerf::Range{1.0, 20.0, false, false}, "exponent");
    s.real(&Tait::least, "least_pressure", "Pa", kerf::any_value, "pressure at which the liquid boils")
        .by_default("0 Pa");
  }
  bool uses_energy() const override { return false; }
  kerf::EosOutput evaluate_point(const kerf::EosInput& in, const State&) const {
    const double grown = B * kerf::pow(in.density / in.reference_density, n);
    return {kerf::max_of(grown - B, least), n * grown};
  }
};

KERF_EOS(Tait, "tait", "pressure of liquids by Tait's law")
