// Files about the strength of Zerilli and Armstrong.
#include "support/curves.hpp"

namespace kerf::test {

namespace {

bool fits(const Oracle& o) { return o.law() == "zerilli_armstrong"; }

std::vector<CurveResult> check(const Oracle& o) {
  PathCheck c;
  set_eos(o, c.laws);
  c.laws.strength = "zerilli_armstrong";
  c.laws.strength_parameters = "{" +
                               o.text({{"shear_modulus", "G"},
                                       {"C0", "C0"},
                                       {"C1", "C1"},
                                       {"C2", "C2"},
                                       {"C3", "C3_1_K"},
                                       {"C4", "C4_1_K"},
                                       {"C5", "C5"},
                                       {"n", "n"},
                                       {"specific_heat", "specific_heat"},
                                       {"taylor_quinney", "taylor_quinney"},
                                       {"initial_temperature", "initial_temperature"}}) +
                               "}";
  c.names = {{"effective_plastic_strain", "effective_plastic_strain"}, {"temperature_K", "temperature"}};
  c.others = 2e-3;
  c.tolerances = {{"effective_plastic_strain", 1e-3}, {"temperature_K", 1e-3}};
  // In shear the pressure is that of heating alone, and has the stress's error.
  // Where the lateral stress is kept, it follows the axial stress. Else it is that of the equation of state, with the
  // energy's share of the stress's error.
  const std::string kind = o.path.at("kind");
  if (kind == "strain") c.tolerances["pressure_Pa"] = 2e-5;
  c.steps = 2000;
  c.rms = {{"von_mises_Pa", 1.5e-3}};
  // Backward Euler: a rate that passes through zero is a step late, in the rows about a reversal of the path.
  c.loose = rows_at_reversals(o, 1, 5);
  c.loose_tolerance = 2e-2;
  return path_results(o, c);
}

const RegisterCurves registered({"zerilli_armstrong", fits, check});

}  // namespace

}  // namespace kerf::test
