// Files about soils: tabulated compaction and strength over pressure.
#include "support/curves.hpp"

namespace kerf::test {

namespace {

bool fits(const Oracle& o) { return o.law() == "soil"; }

std::vector<CurveResult> check(const Oracle& o) {
  PathCheck c;
  c.laws.density = o.parameter("density");
  c.laws.solid = "drucker_prager";
  const nlohmann::json& eos = o.parameters.at("eos");
  std::string text = o.text({{"shear_modulus", "G"}, {"zero_strength_pressure", "zero_strength_at_or_below"}});
  if (o.parameters.contains("a0"))
    text += ", yield: quadratic, " + o.text({{"a0", "a0"}, {"a1", "a1"}, {"a2", "a2"}});
  else
    text += ", yield: linear, " + o.text({{"strength_at_no_pressure", "c"}, {"slope", "tan_b"}});
  if (o.parameters.contains("cap") && o.parameter("cap") < 1e20) text += ", " + o.text({{"most_strength", "cap"}});
  text += ", compactions: " + eos.at("x").dump() + ", pressures: " + eos.at("p").dump() +
          ", unloading_moduli: " + eos.at("unloading_modulus").dump() +
          ", compaction_measure: " + (eos.at("abscissa") == "mu" ? "mu" : "logarithmic") + ", " +
          key_and_number("tension_limit", -eos.at("pressure_cutoff").get<double>());
  c.laws.solid_parameters = "{" + text + "}";
  c.names = {{"effective_plastic_strain", "effective_plastic_strain"}, {"mu_max", "greatest_compaction"}};
  // Tolerances of section "recommended tolerances" for some 1000 steps; the law is integrated to first order.
  c.steps = 1000;
  c.others = 2e-3;
  c.tolerances = {{"pressure_Pa", 1e-6}, {"mu_max", 1e-9}};
  return path_results(o, c);
}

const RegisterCurves registered({"drucker_prager", fits, check});

}  // namespace

}  // namespace kerf::test
