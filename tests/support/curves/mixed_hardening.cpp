// Files about J2 plasticity with linear hardening: isotropic, kinematic or mixed.
#include "support/curves.hpp"

namespace kerf::test {

namespace {

bool fits(const Oracle& o) { return o.law() == "J2" && o.parameters.value("cowper_symonds", "none") == "none"; }

std::vector<CurveResult> check(const Oracle& o) {
  PathCheck c;
  set_eos(o, c.laws);
  c.laws.strength = "mixed_hardening";
  c.laws.strength_parameters =
      "{" +
      o.text(
          {{"shear_modulus", "G"}, {"yield_stress", "Y0"}, {"hardening_modulus", "Ep"}, {"isotropic_share", "beta"}}) +
      "}";
  c.names = {{"effective_plastic_strain", "effective_plastic_strain"},
             {"back_stress_xx_Pa", "back_stress_xx"},
             {"back_stress_yy_Pa", "back_stress_yy"},
             {"back_stress_xy_Pa", "back_stress_xy"}};
  // Radial return is exact where the direction of the strain stays; the energy has the error of the trapezoidal rule.
  c.others = 1e-5;
  c.tolerances = {{"back_stress_xx_Pa", 1e-4}, {"specific_energy_J_kg", 1e-4}};
  const std::string kind = o.path.at("kind");
  // On a path of kept stress, the pressure has the error of the strain that was solved for.
  if (kind == "strain") c.tolerances["pressure_Pa"] = 1e-9;
  // In shear the stress turns by the angle of the step. To a shear of 8, with steps of 0.001. The normal stresses are a
  // small share of the shear stress, so that the error that comes from it is a larger share of them.
  if (kind == "shear") {
    c.steps = 8000;
    c.others = 1e-3;
    c.tolerances = {{"stress_xx_Pa", 1e-2}, {"stress_yy_Pa", 1e-2}};
  }
  return path_results(o, c);
}

const RegisterCurves registered({"mixed_hardening", fits, check});

}  // namespace

}  // namespace kerf::test
