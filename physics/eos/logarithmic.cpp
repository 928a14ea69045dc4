// Logarithmic equation of state: linear in the logarithmic (Hencky) strain of the volume.
//
// Source: H. Hencky, "Ueber die Form des Elastizitaetsgesetzes bei ideal elastischen Stoffen", Z. Techn. Phys. 9 (1928)
// 215-220.
#include <kerf/eos.hpp>
#include <kerf/tension_limit.hpp>

namespace {

using namespace kerf;

/// p = -K ln V with V = rho0/rho, not below the tension limit. The modulus is the same at all densities.
struct Logarithmic final : PointwiseEos<Logarithmic>, TensionLimit {
  double K = 0.0;  // [Pa]
  using State = NoVariables;

  static void describe(Schema<Logarithmic>& s) {
    s.real(&Logarithmic::K, "bulk_modulus", "Pa", positive, "bulk modulus");
    describe_tension_limit(s);
  }
  bool uses_energy() const override { return false; }

  EosOutput evaluate_point(const EosInput& in, const State&) const {
    return {limited(K * kerf::log(in.density / in.reference_density)), K};
  }
};

}  // namespace

KERF_EOS(Logarithmic, "logarithmic", "pressure proportional to the logarithm of the volume")
