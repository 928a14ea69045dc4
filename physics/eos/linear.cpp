// Linear equation of state.
#include <kerf/eos.hpp>
#include <kerf/tension_limit.hpp>

namespace {

using namespace kerf;

/// p = K (rho/rho0 - 1), not below the tension limit.
struct Linear final : PointwiseEos<Linear>, TensionLimit {
  double K = 0.0;  // [Pa]
  using State = NoVariables;

  static void describe(Schema<Linear>& s) {
    s.real(&Linear::K, "bulk_modulus", "Pa", positive, "bulk modulus");
    describe_tension_limit(s);
  }
  bool uses_energy() const override { return false; }

  EosOutput evaluate_point(const EosInput& in, const State&) const {
    const double ratio = in.density / in.reference_density;
    return {limited(K * (ratio - 1.0)), K * ratio};
  }
};

}  // namespace

KERF_EOS(Linear, "linear", "pressure proportional to the change of density")
