// Files about the concrete of Holmquist, Johnson and Cook.
#include "support/curves.hpp"

namespace kerf::test {

namespace {

bool fits(const Oracle& o) { return o.law() == "holmquist_johnson_cook"; }

std::vector<CurveResult> check(const Oracle& o) {
  PathCheck c;
  c.laws.density = o.parameter("density");
  c.laws.solid = "holmquist_johnson_cook";
  const bool sum = o.parameters.at("tension_strength") == "A(1-D)+A p/T";
  const bool damaged = o.parameters.at("pressure_cutoff") == "-T(1-D)";
  c.laws.solid_parameters = "{" +
                            o.text({{"shear_modulus", "G"},
                                    {"A", "A"},
                                    {"B", "B"},
                                    {"N", "N"},
                                    {"C", "C"},
                                    {"compressive_strength", "fc"},
                                    {"tensile_strength", "T"},
                                    {"reference_rate", "reference_rate"},
                                    {"most_strength", "SFMAX"},
                                    {"least_failure_strain", "EFMIN"},
                                    {"crush_pressure", "P_crush"},
                                    {"crush_mu", "mu_crush"},
                                    {"lock_pressure", "P_lock"},
                                    {"lock_mu", "mu_lock"},
                                    {"K1", "K1"},
                                    {"K2", "K2"},
                                    {"K3", "K3"},
                                    {"D1", "D1"},
                                    {"D2", "D2"}}) +
                            ", tension_strength: " + (sum ? "sum" : "product") +
                            ", tension_limit: " + (damaged ? "damaged" : "intact") + "}";
  c.names = {{"effective_plastic_strain", "effective_plastic_strain"},
             {"damage", "damage"},
             {"mu_max", "greatest_mu"},
             {"mu_plastic", "plastic_mu"}};
  // Tolerances of section "recommended tolerances" for some 1000 steps; the law is integrated to first order.
  c.steps = 1000;
  c.others = 5e-3;
  c.tolerances = {{"pressure_Pa", 1e-4}, {"damage", 1e-2}, {"mu_max", 1e-6}, {"mu_plastic", 1e-6}};
  c.rms = {{"von_mises_Pa", 5e-3}};
  return path_results(o, c);
}

const RegisterCurves registered({"holmquist_johnson_cook", fits, check});

}  // namespace

}  // namespace kerf::test
