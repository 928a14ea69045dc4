// Tuler-Butcher: dynamic fracture by the time that tension lasts.
//
// Source: F.R. Tuler & B.M. Butcher, "A criterion for the time dependence of dynamic fracture", Int. J. Fract. Mech. 4
// (1968) 431-437.
#include <kerf/erosion.hpp>

namespace {

using namespace kerf;

/// Fails a point where the integral over time of max(sigma_1 - threshold, 0)^exponent reaches the limit.
struct TulerButcher final : PointwiseErosion<TulerButcher> {
  double threshold_stress = 0.0, exponent = 2.0;  // [Pa], [-]
  double limit = 0.0;  // [Pa^exponent s]
  using Reads = NoVariables;
  struct State {
    double impulse;
  };

  static void describe(Schema<TulerButcher>& s) {
    s.real(&TulerButcher::threshold_stress, "threshold_stress", "Pa", non_negative,
           "largest principal stress that does no harm however long it lasts");
    s.real(&TulerButcher::exponent, "exponent", "-", Range{0.0, 20.0, true, false}, "exponent of the excess stress")
        .by_default("2");
    s.real(&TulerButcher::limit, "limit", "-", positive,
           "integral at failure, a bare number in SI units: Pa to the exponent, times s");
    describe_interval(s);
    s.state(&State::impulse, "tuler_butcher_impulse", "-", 0.0,
            "integral of the excess stress, raised to the exponent, over time, in SI units")
        .within(non_negative);
  }
  Verdict judge_point(const ErosionInputPoint& in, const Reads&, State& state) const {
    const double excess = max_of(largest_principal(in.stress) - threshold_stress, 0.0);
    const bool any = excess > 0.0;
    state.impulse += in.dt * select(any, positive_power(select(any, excess, 1.0), exponent), 0.0);
    return {state.impulse, select(state.impulse >= limit, 1.0, 0.0)};
  }
};

}  // namespace

KERF_EROSION(TulerButcher, "tuler_butcher", "tension above a threshold has lasted long enough to break the point")
