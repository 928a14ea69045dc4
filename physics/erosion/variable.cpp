// Erosion at a limit of a state variable that the user names.
#include <kerf/erosion.hpp>

namespace {

using namespace kerf;

/// Fails a point where a variable of its laws reaches a limit, from below or from above.
struct VariableLimit final : PointwiseErosion<VariableLimit> {
  std::string variable, side;
  double limit = 0.0;  // in the unit of the variable
  using State = NoVariables;
  struct Reads {
    double value;
  };

  static void describe(Schema<VariableLimit>& s) {
    s.text(&VariableLimit::variable, "variable",
           "state variable of a law of the material, or pressure, volume, mass, internal_energy, viscous_energy");
    s.real(&VariableLimit::limit, "limit", "-", any_value, "limit, in the variable's SI unit");
    s.choice(&VariableLimit::side, "fails", {"above", "below"}, "on which side of the limit a point fails")
        .by_default("above");
    describe_interval(s);
    s.reads(&Reads::value, &VariableLimit::variable, "the variable that the user names");
  }
  Verdict judge_point(const ErosionInputPoint&, const Reads& reads, State&) const {
    const bool failed = side == "above" ? reads.value >= limit : reads.value <= limit;
    return {reads.value, select(failed, 1.0, 0.0)};
  }
};

}  // namespace

KERF_EROSION(VariableLimit, "variable", "a state variable that the user names reaches a limit")
