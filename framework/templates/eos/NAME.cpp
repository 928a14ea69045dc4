// Liquids: Tait's equation, in which the compression grows with the logarithm of the pressure.
//
// Source: J.H. Dymond & R. Malhotra, "The Tait equation: 100 years on", Int. J. Thermophys. 9 (1988) 941-951, eq. 3;
// there with the decadic logarithm, whose coefficient is ln 10 times ours.
#include <kerf/eos.hpp>
#include <kerf/tension_limit.hpp>

namespace {

using namespace kerf;

/// 1 - v = C ln(1 + p/B) with v the volume over the undeformed one: p = B (exp((1 - v)/C) - 1), not below the tension
/// limit. Hence rho dp/drho = -v dp/dv = v B/C exp((1 - v)/C). It does not depend on the energy.
struct @TYPE@ final : PointwiseEos<@TYPE@>, TensionLimit {
  double B = 0.0, C = 0.0;  // [Pa], [-]
  using State = NoVariables;

  static void describe(Schema<@TYPE@>& s) {
    s.real(&@TYPE@::B, "B", "Pa", positive, "pressure scale; the bulk modulus without pressure is B / C");
    s.real(&@TYPE@::C, "C", "-", Range{0.0, 1.0, true, false}, "compression per logarithm (to base e) of 1 + p / B");
    describe_tension_limit(s);
  }
  bool uses_energy() const override { return false; }

  EosOutput evaluate_point(const EosInput& in, const State&) const {
    const double v = in.volume_ratio(), exponent = (1.0 - v) / C;
    // Near the undeformed state the exponential is one: expm1 loses no digits there.
    const double above = B * kerf::expm1(exponent);
    return {limited(above), v * (B + above) / C};
  }
};

}  // namespace

KERF_EOS(@TYPE@, "@NAME@", "Tait's equation of liquids: compression over the logarithm of the pressure")
