// Laws against curves that an independent program has computed: one hexahedron, moved along the path of the curve.
#include <gtest/gtest.h>

#include "support/oracle.hpp"

namespace {

using namespace kerf;
using kerf::test::CurveError;
using kerf::test::follow;
using kerf::test::Oracle;
using kerf::test::PartLaws;

const std::string no_viscosity = "{linear_viscosity: 0, quadratic_viscosity: 0}";

/// Every column is within its own tolerance, else within that of the others; all over the column's greatest value.
void expect_close(const std::map<std::string, CurveError>& errors, double others,
                  const std::map<std::string, double>& own = {}) {
  EXPECT_FALSE(errors.empty());
  for (const auto& [column, error] : errors)
    EXPECT_LE(error.most, own.contains(column) ? own.at(column) : others) << column << ", row " << error.row;
}

/// With half the step, a law that is integrated to first order has half the error: between 0.4 and 0.6 of it.
void expect_first_order(const std::map<std::string, CurveError>& coarse, const std::map<std::string, CurveError>& fine,
                        const std::string& column) {
  const double ratio = fine.at(column).rms / coarse.at(column).rms;
  EXPECT_GT(ratio, 0.4) << column;
  EXPECT_LT(ratio, 0.6) << column;
}

PartLaws mixed_hardening(const Oracle& o) {
  PartLaws laws;
  laws.element = no_viscosity;
  laws.density = o.parameter("density");
  laws.strength = "mixed_hardening";
  laws.strength_parameters =
      "{" +
      o.text(
          {{"shear_modulus", "G"}, {"yield_stress", "Y0"}, {"hardening_modulus", "Ep"}, {"isotropic_share", "beta"}}) +
      "}";
  laws.eos_parameters = "{" + o.text({{"bulk_modulus", "K"}}) + "}";
  return laws;
}
const std::map<std::string, std::string> mixed_names = {{"effective_plastic_strain", "effective_plastic_strain"},
                                                        {"back_stress_xx_Pa", "back_stress_xx"},
                                                        {"back_stress_xy_Pa", "back_stress_xy"}};

TEST(MixedHardeningCurves, uniaxial_strain_cycles) {
  // Radial return is exact where the direction of the strain stays; what is left is the round-off of the volume.
  const Oracle o("j2_beta0p5_uniaxial_strain");
  expect_close(follow(o, mixed_hardening(o), 10, mixed_names), 1e-5);
}

TEST(MixedHardeningCurves, back_stress_turns_with_the_material) {
  // To a shear of 8: an element that did not rotate the back stress would be wrong by the stress itself. The errors
  // fall with the step; the normal stresses are small, so that theirs are a larger share of them.
  const Oracle o("j2_beta0p5_shear");
  expect_close(follow(o, mixed_hardening(o), 40, mixed_names), 1e-3, {{"stress_xx_Pa", 5e-3}, {"stress_yy_Pa", 5e-3}});
}

TEST(MixedHardeningCurves, reverse_shear) {
  const Oracle o("j2_beta0p5_reverse_shear");
  expect_close(follow(o, mixed_hardening(o), 40, mixed_names), 1e-3, {{"stress_xx_Pa", 5e-3}, {"stress_yy_Pa", 5e-3}});
}

PartLaws zerilli_armstrong(const Oracle& o) {
  PartLaws laws;
  laws.element = no_viscosity;
  laws.density = o.parameter("density");
  laws.strength = "zerilli_armstrong";
  laws.strength_parameters = "{" +
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
  const nlohmann::json& eos = o.parameters.at("eos");
  laws.eos = "mie_gruneisen";
  laws.eos_parameters =
      "{c0: " + eos.at("c0").dump() + ", s: " + eos.at("S1").dump() + ", gamma0: " + eos.at("gamma0").dump() + "}";
  return laws;
}

class ZerilliArmstrongCurves : public testing::TestWithParam<const char*> {};

TEST_P(ZerilliArmstrongCurves, stay_close) {
  const Oracle o(GetParam());
  // Backward Euler: a rate that passes through zero is a step late, in the rows about a reversal of the path.
  std::vector<std::size_t> reversals;
  const std::vector<double>& rate = o.column("plastic_strain_rate_1_s");
  for (std::size_t r = 1; r < rate.size(); ++r)
    if ((rate[r] > 0.0) != (rate[r - 1] > 0.0))
      for (std::size_t k = 0; k < 8; ++k) reversals.push_back(r + k - std::min<std::size_t>(r, 3));
  const auto errors =
      follow(o, zerilli_armstrong(o), 10,
             {{"effective_plastic_strain", "effective_plastic_strain"}, {"temperature_K", "temperature"}}, reversals);
  // In shear the pressure is that of heating alone, and has the stress's error.
  const double pressure = o.path.at("kind") == "shear" ? 2e-3 : 1e-5;
  expect_close(errors, 2e-3, {{"pressure_Pa", pressure}, {"effective_plastic_strain", 1e-3}, {"temperature_K", 1e-3}});
}

INSTANTIATE_TEST_SUITE_P(All, ZerilliArmstrongCurves,
                         testing::Values("zerilli_armstrong_bcc_iron_shear_1e5",
                                         "zerilli_armstrong_bcc_iron_uniaxial_strain",
                                         "zerilli_armstrong_fcc_copper_shear_1e5"));

PartLaws jh2(const Oracle& o) {
  PartLaws laws;
  laws.element = no_viscosity;
  laws.density = o.parameter("density");
  laws.solid = "johnson_holmquist_2";
  std::string text = o.text({{"shear_modulus", "G"},
                             {"A", "A"},
                             {"B", "B"},
                             {"C", "C"},
                             {"M", "M"},
                             {"N", "N"},
                             {"tensile_strength", "T"},
                             {"hugoniot_elastic_limit", "HEL"},
                             {"hugoniot_elastic_pressure", "PHEL"},
                             {"D1", "D1"},
                             {"D2", "D2"},
                             {"K1", "K1"},
                             {"K2", "K2"},
                             {"K3", "K3"},
                             {"bulking_share", "beta"},
                             {"reference_rate", "reference_rate"}});
  if (o.parameter("SFMAX") < 1e20) text += ", " + o.text({{"most_fractured_strength", "SFMAX"}});
  laws.solid_parameters = "{" + text + "}";
  return laws;
}
const std::map<std::string, std::string> jh2_names = {{"effective_plastic_strain", "effective_plastic_strain"},
                                                      {"damage", "damage"},
                                                      {"bulking_pressure_Pa", "bulking_pressure"}};
/// The law is integrated to first order. Where damage sets in, 40 steps per row keep the errors below these.
const std::map<std::string, double> jh2_tolerances = {
    {"pressure_Pa", 2e-3}, {"damage", 2e-2}, {"bulking_pressure_Pa", 1e-2}};

class Jh2Curves : public testing::TestWithParam<const char*> {};

TEST_P(Jh2Curves, stay_close) {
  const Oracle o(GetParam());
  // A row in which damage jumps by more than 0.3 of itself is not resolved.
  std::vector<std::size_t> jumps;
  for (std::size_t r = 1; o.has("damage") && r < o.n_rows(); ++r)
    if (o.column("damage")[r] - o.column("damage")[r - 1] > 0.3) jumps.push_back(r);
  expect_close(follow(o, jh2(o), 40, jh2_names, jumps), 1e-2, jh2_tolerances);
}

INSTANTIATE_TEST_SUITE_P(All, Jh2Curves,
                         testing::Values("jh2_alumina_uniaxial_strain", "jh2_alumina_uniaxial_strain_no_bulking",
                                         "jh2_alumina_isotropic", "jh2_alumina_case_A", "jh2_alumina_case_B",
                                         "jh2_alumina_case_C", "jh2_glass_uniaxial_strain_rate",
                                         "jh2_glass_pressure_shear"));

TEST(Jh2Curves, converge_with_first_order) {
  const Oracle o("jh2_alumina_uniaxial_strain");
  expect_first_order(follow(o, jh2(o), 10, jh2_names), follow(o, jh2(o), 20, jh2_names), "von_mises_Pa");
}

}  // namespace
