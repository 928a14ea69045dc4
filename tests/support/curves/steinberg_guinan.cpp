// Files about the strength of Steinberg and Guinan.
#include "support/curves.hpp"

namespace kerf::test {

namespace {

bool fits(const Oracle& o) { return o.law() == "steinberg_guinan"; }

std::vector<CurveResult> check(const Oracle& o) {
  PathCheck c;
  set_eos(o, c.laws);
  c.laws.strength = "steinberg_guinan";
  c.laws.strength_parameters = "{" +
                               o.text({{"shear_modulus", "G0"},
                                       {"yield_stress", "Y0"},
                                       {"maximum_yield_stress", "Ymax"},
                                       {"beta", "beta"},
                                       {"n", "n"},
                                       {"initial_plastic_strain", "epi"},
                                       {"A", "A_1_Pa"},
                                       {"B", "B_1_K"},
                                       {"melting_temperature", "Tm0"},
                                       {"gamma0", "gamma0"},
                                       {"a", "a"},
                                       {"specific_heat", "cv"},
                                       {"initial_temperature", "T0"}}) +
                               ", " + key_and_number("gamma_slope", o.parameters.at("eos").value("a", 0.0)) + "}";
  c.names = {{"effective_plastic_strain", "effective_plastic_strain"},
             {"temperature_K", "temperature"},
             {"melting_temperature_K", "melting_temperature"},
             {"shear_modulus_Pa", "shear_modulus"}};
  c.others = 2e-3;
  c.tolerances = {
      {"effective_plastic_strain", 1e-3}, {"temperature_K", 1e-3}, {"shear_modulus_Pa", 1e-3}, {"pressure_Pa", 1e-4}};
  c.rms = {{"von_mises_Pa", 1.5e-3}};
  // The shear modulus is that of the pressure at the start of the step: first order.
  c.steps = 4000;
  // The pressure is that of heating alone in shear, and follows the axial stress where the lateral one is kept: it has
  // the stress's error.
  const std::string kind = o.path.at("kind");
  if (kind != "strain") c.tolerances["pressure_Pa"] = 2e-3;
  return path_results(o, c);
}

const RegisterCurves registered({"steinberg_guinan", fits, check});

}  // namespace

}  // namespace kerf::test
