// Linear equation of state.
#include <kerf/eos.hpp>

#include <limits>

namespace {

using namespace kerf;

/// p = K (rho/rho0 - 1), not below the tension limit.
struct Linear final : PointwiseEos<Linear> {
  double K = 0.0;  // [Pa]
  double tension_limit = std::numeric_limits<double>::infinity();  // [Pa]
  using State = NoVariables;

  static void describe(Schema<Linear>& s) {
    s.real(&Linear::K, "bulk_modulus", "Pa", positive, "bulk modulus");
    s.real(&Linear::tension_limit, "tension_limit", "Pa", non_negative,
           "the pressure never falls below minus this; no limit where absent")
        .optional();
  }
  bool uses_energy() const override { return false; }

  EosOutput evaluate_point(const EosInput& in, const State&) const {
    const double ratio = in.density / in.reference_density;
    return {max_of(-tension_limit, K * (ratio - 1.0)), K * ratio};
  }
};

}  // namespace

KERF_EOS(Linear, "linear", "pressure proportional to the change of density")
