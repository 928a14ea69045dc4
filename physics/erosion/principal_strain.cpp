// Erosion at limits of the principal strains, elastic and plastic.
//
// LS-DYNA's *MAT_ADD_EROSION calls the two limits MXEPS and MNEPS. The strain is that of geometric_strain.cpp: the sum
// of the increments, which turns with the material and which is the logarithmic strain where no rotation and shear
// combine.
#include <kerf/erosion.hpp>

#include <limits>

namespace {

using namespace kerf;

/// Fails a point where the largest principal value of the accumulated strain tensor reaches `maximum`, or the smallest
/// one comes down to `minimum`. The tensor turns with the material: e <- R e R^T + de (Hughes & Winget 1980).
struct PrincipalStrain final : PointwiseErosion<PrincipalStrain> {
  double maximum = 0.0, minimum = 0.0;  // [-]; zero where there is none
  using Reads = NoVariables;
  struct State {
    SymTensor strain;
    double largest, smallest;
  };

  static void describe(Schema<PrincipalStrain>& s) {
    using P = PrincipalStrain;
    s.real(&P::maximum, "maximum", "-", positive, "largest principal strain at failure").optional();
    s.real(&P::minimum, "minimum", "-", Range{-std::numeric_limits<double>::infinity(), 0.0, true, false},
           "smallest principal strain at failure: negative, a compression")
        .optional();
    describe_interval(s);
    s.rule("maximum", "expected a maximum, a minimum, or both",
           [](const P& p) { return p.maximum > 0.0 || p.minimum < 0.0; });
    s.state(&State::strain, "principal_criterion_strain", "-", "accumulated strain");
    s.state(&State::largest, "largest_principal_strain", "-", 0.0, "largest principal value of the accumulated strain");
    s.state(&State::smallest, "smallest_principal_strain", "-", 0.0, "its smallest principal value");
  }
  Verdict judge_point(const ErosionInputPoint& in, const Reads&, State& state) const {
    const SymTensor e = state.strain + in.strain_increment;
    const double largest = largest_principal(e), smallest = -largest_principal(-1.0 * e);
    state = {e, largest, smallest};
    const bool has_maximum = maximum > 0.0, has_minimum = minimum < 0.0;
    const bool torn = has_maximum & (largest >= maximum), crushed = has_minimum & (smallest <= minimum);
    // The value is the strain that is nearer to its limit, as a share of it.
    const bool by_smallest = has_minimum & (!has_maximum | (smallest * maximum < largest * minimum));
    return {select(by_smallest, smallest, largest), select(torn | crushed, 1.0, 0.0)};
  }
};

}  // namespace

KERF_EROSION(PrincipalStrain, "principal_strain", "largest or smallest principal accumulated strain reaches a limit")
