// Ductile failure by a sum of damage: plastic strain counts the more, the more tension there is in it.
//
// Source: M. Oyane, T. Sato, K. Okimoto & S. Shima, "Criteria for ductile fracture and their applications", J. Mech.
// Work. Technol. 4 (1980) 65-81.
#include <kerf/erosion.hpp>

namespace {

using namespace kerf;

/// D = integral of max(1 + eta/A, 0) over the equivalent plastic strain, with eta the mean stress over the von Mises
/// stress; D = `limit` is failure.
struct @TYPE@ final : PointwiseErosion<@TYPE@> {
  double A = 0.0, limit = 0.0;  // [-]

  struct State {
    double damage, last_strain;
  };
  struct Reads {
    double effective_plastic_strain;
  };

  static void describe(Schema<@TYPE@>& s) {
    s.real(&@TYPE@::limit, "limit", "-", positive,
           "sum of damage at failure: the plastic strain at failure in pure shear");
    s.real(&@TYPE@::A, "A", "-", positive, "triaxiality at which plastic strain does twice the damage of pure shear");
    describe_interval(s);
    s.state(&State::damage, "@NAME@_damage", "-", 0.0, "sum of damage so far").within(non_negative);
    s.state(&State::last_strain, "@NAME@_strain", "-", -1.0, "plastic strain at the last look; negative before it");
    s.reads(&Reads::effective_plastic_strain, "effective_plastic_strain", "plastic strain of the material");
  }

  Verdict judge_point(const ErosionInputPoint& in, const Reads& reads, State& state) const {
    const double q = von_mises(deviator(in.stress));
    // Without a deviator nothing flows, so what the quotient is then does not matter; it has to be finite.
    const double eta = select(q > 0.0, -in.pressure / (q + tiny<double>), 0.0);
    // Strain from before the run does no damage.
    const bool has_looked = state.last_strain >= 0.0;
    const double grown = select(has_looked, max_of(reads.effective_plastic_strain - state.last_strain, 0.0), 0.0);
    state.damage += max_of(1.0 + eta / A, 0.0) * grown;
    state.last_strain = reads.effective_plastic_strain;
    return {state.damage, select(state.damage >= limit, 1.0, 0.0)};
  }
};

}  // namespace

KERF_EROSION(@TYPE@, "@NAME@", "plastic strain, weighted with the triaxiality, reaches a limit")
