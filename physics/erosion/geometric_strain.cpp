// Erosion at a limit of the strain itself, elastic and plastic, whatever the material keeps.
//
// The measure is known from Autodyn as "instantaneous geometric strain" and from LS-DYNA's *MAT_ADD_EROSION as
// effective strain (EFFEPS): it follows the strain back when a point is deformed back, unlike a plastic strain.
#include <kerf/erosion.hpp>

namespace {

using namespace kerf;

/// Fails a point where sqrt(2/3 e:e) of the accumulated strain tensor, volume change included, reaches the limit.
/// The tensor turns with the material: e <- R e R^T + de (Hughes & Winget 1980).
struct GeometricStrain final : PointwiseErosion<GeometricStrain> {
  double limit = 0.0;  // [-]
  using Reads = NoVariables;
  struct State {
    SymTensor strain;
    double effective;
  };

  static void describe(Schema<GeometricStrain>& s) {
    s.real(&GeometricStrain::limit, "limit", "-", positive, "effective geometric strain at failure");
    describe_interval(s);
    s.state(&State::strain, "strain", "-", "accumulated strain");
    s.state(&State::effective, "effective_geometric_strain", "-", 0.0, "sqrt(2/3 e:e) of the accumulated strain");
  }
  Verdict judge_point(const ErosionInputPoint& in, const Reads&, State& state) const {
    const SymTensor e = state.strain + in.strain_increment;
    const double effective = equivalent_strain(e);
    state = {e, effective};
    return {effective, select(effective >= limit, 1.0, 0.0)};
  }
};

}  // namespace

KERF_EROSION(GeometricStrain, "geometric_strain", "effective accumulated strain, elastic and plastic, reaches a limit")
