// Spall by pressure: failure below a limit, which is negative.
#include <kerf/erosion.hpp>

namespace {

using namespace kerf;

/// Fails a point whose pressure, positive in compression, is below the limit.
struct MinimumPressure final : PointwiseErosion<MinimumPressure> {
  double limit = 0.0;  // [Pa]
  using State = NoVariables;
  using Reads = NoVariables;

  static void describe(Schema<MinimumPressure>& s) {
    s.real(&MinimumPressure::limit, "limit", "Pa", Range{-infinity, 0.0, true, false},
           "pressure below which a point fails: negative, since it is positive in compression");
    describe_interval(s);
  }
  Verdict judge_point(const ErosionInputPoint& in, const Reads&, State&) const {
    return {in.pressure, select(in.pressure < limit, 1.0, 0.0)};
  }

 private:
  static constexpr double infinity = std::numeric_limits<double>::infinity();
};

}  // namespace

KERF_EROSION(MinimumPressure, "minimum_pressure", "the pressure falls below a limit: spall")
