// Murnaghan equation of state: a bulk modulus that is linear in the pressure. Liquids too, by the name of Tait.
//
// Source: F.D. Murnaghan, "The compressibility of media under extreme pressures", Proc. Natl. Acad. Sci. 30 (1944)
// 244-247.
#include <kerf/eos.hpp>
#include <kerf/tension_limit.hpp>

namespace {

using namespace kerf;

/// p = K/K' [(rho/rho0)^K' - 1], not below the tension limit. It does not depend on the energy.
struct Murnaghan final : PointwiseEos<Murnaghan>, TensionLimit {
  double K = 0.0, slope = 0.0;  // [Pa], [-]
  using State = NoVariables;

  static void describe(Schema<Murnaghan>& s) {
    s.real(&Murnaghan::K, "bulk_modulus", "Pa", positive, "bulk modulus at no pressure");
    s.real(&Murnaghan::slope, "pressure_derivative", "-", Range{0.0, 20.0, true, false},
           "derivative of the bulk modulus by the pressure, K'");
    describe_tension_limit(s);
  }
  bool uses_energy() const override { return false; }

  EosOutput evaluate_point(const EosInput& in, const State&) const {
    // Near the reference density the power is one, and the difference is small: no digits are lost with expm1.
    const double exponent = slope * kerf::log(in.density / in.reference_density);
    return {limited(K / slope * kerf::expm1(exponent)), K * kerf::exp(exponent)};
  }
};

}  // namespace

KERF_EOS(Murnaghan, "murnaghan", "bulk modulus linear in the pressure, for solids and liquids")
