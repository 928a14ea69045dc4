// Birch-Murnaghan equation of state of third order: finite strain in compressed solids.
//
// Source: F. Birch, "Finite elastic strain of cubic crystals", Phys. Rev. 71 (1947) 809-824.
#include <kerf/eos.hpp>
#include <kerf/tension_limit.hpp>

namespace {

using namespace kerf;

/// p = 3/2 K (x^(7/3) - x^(5/3)) [1 + 3/4 (K' - 4)(x^(2/3) - 1)] with x = rho/rho0, not below the tension limit. It
/// does not depend on the energy.
struct BirchMurnaghan final : PointwiseEos<BirchMurnaghan>, TensionLimit {
  double K = 0.0, slope = 0.0;  // [Pa], [-]
  using State = NoVariables;

  static void describe(Schema<BirchMurnaghan>& s) {
    s.real(&BirchMurnaghan::K, "bulk_modulus", "Pa", positive, "bulk modulus at no pressure");
    s.real(&BirchMurnaghan::slope, "pressure_derivative", "-", Range{0.0, 20.0, true, false},
           "derivative of the bulk modulus by the pressure, K'");
    describe_tension_limit(s);
  }
  bool uses_energy() const override { return false; }

  EosOutput evaluate_point(const EosInput& in, const State&) const {
    const double x = in.density / in.reference_density, third = kerf::log(x) / 3.0;
    const double two_thirds = kerf::exp(2.0 * third), strain = kerf::expm1(2.0 * third);  // x^(2/3), less one
    const double five_thirds = x * two_thirds, bend = 0.75 * (slope - 4.0);
    const double p = 1.5 * K * five_thirds * strain * (1.0 + bend * strain);
    // x dp/dx, term by term.
    const double modulus =
        0.5 * K * five_thirds * ((7.0 * two_thirds - 5.0) * (1.0 + bend * strain) + 2.0 * bend * strain * two_thirds);
    return {limited(p), max_of(0.0, modulus)};
  }
};

}  // namespace

KERF_EOS(BirchMurnaghan, "birch_murnaghan", "finite strain of third order, for compressed solids")
