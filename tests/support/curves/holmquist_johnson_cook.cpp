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
  // The law is integrated to first order. In this many steps no error is above half of what is allowed below.
  c.steps = 2000;
  c.others = 5e-3;
  c.tolerances = {{"pressure_Pa", 1e-4}, {"damage", 1e-2}, {"mu_max", 1e-6}, {"mu_plastic", 1e-6}};
  c.rms = {{"von_mises_Pa", 5e-3}};
  const std::string kind = o.path.at("kind");
  // Normal stresses in shear are a thousandth of the shear stress, and follow it with a delay of strength/(3 G ep'),
  // seven steps of a thousand: backward Euler errs by half a step in that.
  if (kind == "shear") c.tolerances["stress_xx_Pa"] = c.tolerances["stress_yy_Pa"] = 5e-2;
  // Where a lateral stress is given, the pressure is a third of the strength and errs like it, and where the volume
  // turns within a step at the first yield, up to half a step's growth of the greatest mu is not seen.
  if (kind == "stress" || kind == "triax") {
    c.tolerances["pressure_Pa"] = c.others;
    c.tolerances["mu_max"] = c.tolerances["mu_plastic"] = 2e-3;
  }
  return path_results(o, c);
}

const RegisterCurves registered({"holmquist_johnson_cook", fits, check});

}  // namespace

}  // namespace kerf::test
