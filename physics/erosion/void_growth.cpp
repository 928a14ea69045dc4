// Ductile failure by the growth of voids, which the triaxiality drives: Rice-Tracey and Hancock-Mackenzie.
//
// Sources: J.R. Rice & D.M. Tracey, "On the ductile enlargement of voids in triaxial stress fields", J. Mech. Phys.
// Solids 17 (1969) 201-217; Y. Huang, J. Appl. Mech. 58 (1991) 1084-1086 for the coefficient 0.427; J.W. Hancock &
// A.C. Mackenzie, "On the mechanisms of ductile failure in high-strength steels subjected to multi-axial
// stress-states", J. Mech. Phys. Solids 24 (1976) 147-169.
#include "accumulated_damage.hpp"

namespace {

using namespace kerf;

/// (ln R/R0)' = a exp(1.5 eta) ep', the growth of a void of radius R. ln R/R0 = `limit` is failure, or where softening
/// begins.
struct RiceTracey final : AccumulatedDamage<RiceTracey> {
  double coefficient = 0.283, limit = 0.0;  // [-]
  using State = DamageState;
  using Reads = DamageReads;

  static void describe(Schema<RiceTracey>& s) {
    s.real(&RiceTracey::limit, "limit", "-", positive, "ln R/R0 at failure");
    s.real(&RiceTracey::coefficient, "coefficient", "-", positive,
           "growth at no triaxiality: 0.283 (Rice & Tracey), 0.427 (Huang)")
        .by_default("0.283");
    describe_damage(s, "void_growth", "-", "ln R/R0, logarithm of the growth of voids", "void_growth");
  }
  double amount_at_failure() const { return limit; }
  [[gnu::always_inline]] double pace(const Point& in, const Reads&, double) const {
    return coefficient * kerf::exp(1.5 * triaxiality(in));
  }
};

/// D' = ep' / ef with ef = nucleation_strain + growth_strain exp(-1.5 eta). D = 1 is failure, or where softening
/// begins.
struct HancockMackenzie final : AccumulatedDamage<HancockMackenzie> {
  double nucleation_strain = 0.0, growth_strain = 0.0;  // [-]
  using State = DamageState;
  using Reads = DamageReads;

  static void describe(Schema<HancockMackenzie>& s) {
    s.real(&HancockMackenzie::nucleation_strain, "nucleation_strain", "-", non_negative,
           "plastic strain that nucleates voids, whatever the triaxiality");
    s.real(&HancockMackenzie::growth_strain, "growth_strain", "-", positive,
           "strain until voids join where there is no triaxiality, often 1.65");
    describe_damage(s, "hancock_mackenzie_damage", "-", "accumulated plastic strain over failure strain",
                    "hancock_mackenzie");
  }
  double amount_at_failure() const { return 1.0; }
  [[gnu::always_inline]] double pace(const Point& in, const Reads&, double) const {
    return 1.0 / (nucleation_strain + growth_strain * kerf::exp(-1.5 * triaxiality(in)));
  }
};

}  // namespace

KERF_REGISTER(KERF_TYPE(RiceTracey, "erosion", "rice_tracey", "the growth of voids reaches a limit")
                  KERF_TYPE(HancockMackenzie, "erosion", "hancock_mackenzie",
                            "plastic strain over a failure strain that falls with triaxiality"))
