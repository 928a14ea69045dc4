// Erosion at a limit of the largest principal stress.
#include <kerf/erosion.hpp>

namespace {

using namespace kerf;

/// Fails a point whose largest principal Cauchy stress (tension positive) reaches the limit.
struct TensileStress final : PointwiseErosion<TensileStress> {
  double limit = 0.0;  // [Pa]
  using State = NoVariables;
  using Reads = NoVariables;

  static void describe(Schema<TensileStress>& s) {
    s.real(&TensileStress::limit, "limit", "Pa", positive, "largest principal stress at failure");
    describe_interval(s);
  }
  Verdict judge_point(const ErosionInputPoint& in, const Reads&, State&) const {
    const double stress = largest_principal(in.stress);
    return {stress, select(stress >= limit, 1.0, 0.0)};
  }
};

}  // namespace

KERF_EROSION(TensileStress, "tensile_stress", "largest principal stress reaches a limit")
