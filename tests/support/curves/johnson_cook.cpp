// Files about the strength of Johnson and Cook.
#include <algorithm>

#include "support/curves.hpp"

namespace kerf::test {

namespace {

bool fits(const Oracle& o) { return o.law() == "johnson_cook" && o.failure.is_null(); }

std::vector<CurveResult> check(const Oracle& o) {
  PathCheck c;
  set_eos(o, c.laws);
  c.laws.strength = "johnson_cook";
  c.laws.strength_parameters = "{" +
                               o.text({{"shear_modulus", "G"},
                                       {"A", "A"},
                                       {"B", "B"},
                                       {"n", "n"},
                                       {"C", "C"},
                                       {"m", "m"},
                                       {"reference_rate", "reference_rate"},
                                       {"reference_temperature", "reference_temperature"},
                                       {"melting_temperature", "melting_temperature"},
                                       {"initial_temperature", "initial_temperature"},
                                       {"specific_heat", "specific_heat"},
                                       {"taylor_quinney", "taylor_quinney"}}) +
                               "}";
  c.names = {{"effective_plastic_strain", "effective_plastic_strain"}, {"temperature_K", "temperature"}};
  c.steps = 4000;
  c.others = 2e-3;
  c.tolerances["effective_plastic_strain"] = 1e-3;
  // Of the rise of the temperature.
  if (o.has("temperature_K")) {
    const auto [least, most] = std::minmax_element(o.column("temperature_K").begin(), o.column("temperature_K").end());
    c.tolerances["temperature_K"] = 1e-3 * (*most - *least) / *most;
  }
  // In shear the pressure is that of heating alone, and where the lateral stress is kept it follows the axial stress:
  // it then has the stress's error. Else it is that of the equation of state, with the energy's share of that.
  if (o.path.at("kind") == "strain") c.tolerances["pressure_Pa"] = 2e-5;
  c.rms = {{"von_mises_Pa", 1.5e-3}};
  // Backward Euler: a rate that passes through zero is a step late, in the rows about a reversal of the path.
  c.loose = rows_at_reversals(o, 1, 5);
  c.loose_tolerance = 2e-2;
  return path_results(o, c);
}

const RegisterCurves registered({"johnson_cook", fits, check});

}  // namespace

}  // namespace kerf::test
