// Erosion at a limit of the largest shear strain, elastic and plastic.
//
// LS-DYNA's *MAT_ADD_EROSION calls the tensor shear strain EPSSH; half of all confusion is the factor of two between it
// and the engineering one, so the user has to say which is meant.
#include <kerf/erosion.hpp>

namespace {

using namespace kerf;

/// Fails a point where (e1 - e3)/2, or e1 - e3, of the accumulated strain tensor reaches the limit. The tensor turns
/// with the material: e <- R e R^T + de (Hughes & Winget 1980).
struct MaximumShear final : PointwiseErosion<MaximumShear> {
  double limit = 0.0;  // [-]
  std::string measure = "tensor";
  using Reads = NoVariables;
  struct State {
    SymTensor strain;
    double largest;
  };

  static void describe(Schema<MaximumShear>& s) {
    s.real(&MaximumShear::limit, "limit", "-", positive, "largest shear strain at failure");
    s.choice(&MaximumShear::measure, "measure", {"tensor", "engineering"},
             "which shear strain is meant: (e1 - e3)/2 of the tensor, or e1 - e3, twice that, the change of an angle");
    describe_interval(s);
    s.state(&State::strain, "shear_criterion_strain", "-", "accumulated strain");
    s.state(&State::largest, "maximum_shear_strain", "-", 0.0, "the measure that the criterion looks at");
  }
  Verdict judge_point(const ErosionInputPoint& in, const Reads&, State& state) const {
    const SymTensor e = state.strain + in.strain_increment;
    const double apart = largest_principal(e) + largest_principal(-1.0 * e);
    const double largest = apart * (measure.front() == 't' ? 0.5 : 1.0);
    state = {e, largest};
    return {largest, select(largest >= limit, 1.0, 0.0)};
  }
};

}  // namespace

KERF_EROSION(MaximumShear, "maximum_shear", "largest accumulated shear strain reaches a limit")
