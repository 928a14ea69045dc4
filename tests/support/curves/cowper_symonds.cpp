// Files about J2 plasticity with the rate hardening of Cowper and Symonds.
#include "support/curves.hpp"

namespace kerf::test {

namespace {

bool fits(const Oracle& o) { return o.law() == "J2" && o.parameters.value("cowper_symonds", "none") != "none"; }

std::vector<CurveResult> check(const Oracle& o) {
  PathCheck c;
  set_eos(o, c.laws);
  c.laws.strength = "cowper_symonds";
  c.laws.strength_parameters = "{strain_rate: " + o.parameters.at("cowper_symonds").get<std::string>() + ", " +
                               o.text({{"shear_modulus", "G"},
                                       {"yield_stress", "Y0"},
                                       {"hardening_modulus", "Ep"},
                                       {"isotropic_share", "beta"},
                                       {"C", "C"},
                                       {"P", "P"}}) +
                               "}";
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

const RegisterCurves registered({"cowper_symonds", fits, check});

}  // namespace

}  // namespace kerf::test
