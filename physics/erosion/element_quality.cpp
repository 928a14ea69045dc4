// Erosion of elements that have become too distorted to compute with: inverted, or with a tiny time step.
#include <kerf/erosion.hpp>

namespace {

using namespace kerf;

/// Fails an element whose volume over its initial volume is at or below the limit.
struct Inversion final : PointwiseErosion<Inversion> {
  double limit = 0.0;  // [-]
  using State = NoVariables;
  using Reads = NoVariables;

  static void describe(Schema<Inversion>& s) {
    s.real(&Inversion::limit, "limit", "-", between(0.0, 1.0), "volume over initial volume at failure").by_default("0");
    describe_interval(s);
  }
  bool can_fade() const override { return false; }
  Verdict judge_point(const ErosionInputPoint& in, const Reads&, State&) const {
    return {in.volume_ratio, select(in.volume_ratio <= limit, 1.0, 0.0)};
  }
};

/// Fails an element whose stable time step, before the safety factor, is below the limit.
struct MinimumTimeStep final : PointwiseErosion<MinimumTimeStep> {
  double limit = 0.0;  // [s]
  using State = NoVariables;
  using Reads = NoVariables;

  static void describe(Schema<MinimumTimeStep>& s) {
    s.real(&MinimumTimeStep::limit, "limit", "s", positive, "stable time step below which an element is eroded");
    describe_interval(s);
  }
  bool can_fade() const override { return false; }
  Verdict judge_point(const ErosionInputPoint& in, const Reads&, State&) const {
    return {in.time_step, select(in.time_step < limit, 1.0, 0.0)};
  }
};

}  // namespace

KERF_REGISTER(KERF_TYPE(Inversion, "erosion", "inversion", "the element has lost its volume")
                  KERF_TYPE(MinimumTimeStep, "erosion", "minimum_time_step",
                            "the stable time step falls below a limit"))
