// Files about tables of yield stress over plastic strain.
#include "support/curves.hpp"

namespace kerf::test {

namespace {

bool fits(const Oracle& o) { return o.law() == "tabulated"; }

/// Tables as an input has them.
std::string curves(const Oracle& o) {
  const nlohmann::json &tables = o.parameters.at("curves"), &rates = o.parameters.at("rates");
  std::string text;
  for (std::size_t i = 0; i < tables.size(); ++i)
    text += (i > 0 ? ", " : "") + ("{plastic_strain_rate: " + rates.at(i).dump()) +
            ", plastic_strain: " + tables.at(i).at(0).dump() + ", yield_stress: " + tables.at(i).at(1).dump() + "}";
  return "curves: [" + text + "]";
}

std::vector<CurveResult> check(const Oracle& o) {
  PathCheck c;
  set_eos(o, c.laws);
  c.laws.strength = "tabulated_hardening";
  std::string text = o.text({{"shear_modulus", "G"}}) + ", " + curves(o);
  text += ", beyond: ";
  text += o.parameters.at("beyond") == "constant" ? "constant" : "last_slope";
  text += ", rate_interpolation: ";
  text += o.parameters.at("rate_interpolation") == "linear" ? "linear" : "logarithmic";
  if (o.parameters.at("cowper_symonds") != "none") text += ", " + o.text({{"C", "C"}, {"P", "P"}});
  c.laws.strength_parameters = "{" + text + "}";
  c.names = {{"effective_plastic_strain", "effective_plastic_strain"}};
  c.others = 2e-3;
  c.tolerances = {{"effective_plastic_strain", 1e-3}};
  c.rms = {{"von_mises_Pa", 1.5e-3}};
  if (o.path.at("kind") == "strain") c.tolerances["pressure_Pa"] = 1e-6;
  // Backward Euler: where the rate passes through zero, and where flow sets in again, the strength is a step late.
  c.steps = 2000;
  c.loose = rows_at_reversals(o, 4, 5);
  c.loose_tolerance = 2e-2;
  // In shear the stress turns by the angle of the step, while the normal stresses are a hundredth of the shear stress.
  if (o.path.at("kind") == "shear") {
    c.steps = 40000;
    c.loose.clear();
    c.tolerances["stress_xx_Pa"] = c.tolerances["stress_yy_Pa"] = 1e-2;
  }
  return path_results(o, c);
}

const RegisterCurves registered({"tabulated_hardening", fits, check});

}  // namespace

}  // namespace kerf::test
