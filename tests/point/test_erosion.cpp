// Erosion criteria at a point.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <numbers>
#include <random>

#include "support/oracle.hpp"
#include "support/points.hpp"

namespace {

using namespace kerf;
using kerf::test::ErosionPoint;
using kerf::test::make_law;

ErosionPoint make_point(const std::string& name, const std::string& parameters) {
  return ErosionPoint(make_law<ErosionCriterion>("erosion", name, parameters));
}

Rotation about_z(double angle) {
  const double c = std::cos(angle), s = std::sin(angle);
  return {c, -s, 0.0, s, c, 0.0, 0.0, 0.0, 1.0};
}
Rotation about_x(double angle) {
  const double c = std::cos(angle), s = std::sin(angle);
  return {1.0, 0.0, 0.0, 0.0, c, -s, 0.0, s, c};
}

TEST(LargestPrincipal, is_exact_for_principal_stresses_in_any_frame) {
  std::mt19937 random(7);
  std::uniform_real_distribution<double> u(-1.0, 1.0);
  for (int i = 0; i < 2000; ++i) {
    const double a = u(random), b = u(random), c = u(random);
    const SymTensor t = rotate(rotate({a, b, c, 0.0, 0.0, 0.0}, about_z(3.0 * u(random))), about_x(3.0 * u(random)));
    EXPECT_NEAR(largest_principal(t), std::max({a, b, c}), 1e-7);  // square root of round-off where two coincide
  }
}

TEST(LargestPrincipal, is_exact_where_eigenvalues_coincide) {
  EXPECT_EQ(largest_principal({}), 0.0);
  EXPECT_NEAR(largest_principal({5e9, 5e9, 5e9, 0.0, 0.0, 0.0}), 5e9, 1.0);
  EXPECT_NEAR(largest_principal({3e9, 3e9, 0.0, 0.0, 0.0, 0.0}) / 3e9, 1.0, 1e-7);  // equibiaxial tension
  EXPECT_NEAR(largest_principal({0.0, 0.0, -3e9, 0.0, 0.0, 0.0}) / 3e9, 0.0, 1e-7);  // uniaxial compression
  EXPECT_NEAR(largest_principal({3e9, 0.0, 0.0, 0.0, 0.0, 0.0}) / 3e9, 1.0, 1e-15);  // uniaxial tension
  EXPECT_NEAR(largest_principal({0.0, 0.0, 0.0, 2e9, 0.0, 0.0}) / 2e9, 1.0, 1e-15);  // shear
  EXPECT_NEAR(largest_principal({-1.0, -2.0, -4.0, 0.0, 0.0, 0.0}), -1.0, 1e-14);  // all compressive
}

TEST(PlasticStrainErosion, fails_at_the_limit) {
  auto point = make_point("plastic_strain", "{limit: 0.85}");
  EXPECT_EQ(point.judge({}, 0.8499).failed, 0.0);
  EXPECT_EQ(point.judge({}, 0.85).failed, 1.0);
  EXPECT_EQ(point.judge({}, 0.9).value, 0.9);
}

TEST(PlasticStrainErosion, reads_the_variable_of_the_materials) {
  const Description* d = kerf::test::builtin_plugins().find("erosion", "plastic_strain");
  ASSERT_EQ(d->reads.size(), 1u);
  for (const char* material : {"elastic_plastic", "johnson_cook"})
    EXPECT_EQ(kerf::test::builtin_plugins().find("material", material)->state.at(0).name, d->reads[0].name);
}

TEST(TensileStressErosion, looks_at_tension_only) {
  auto point = make_point("tensile_stress", "{limit: 1 GPa}");
  ErosionInputPoint in;
  in.stress = {-5e9, -5e9, -5e9, 0.0, 0.0, 0.0};
  EXPECT_EQ(point.judge(in).failed, 0.0);
  in.stress = {0.0, 0.0, 0.0, 1.01e9, 0.0, 0.0};
  EXPECT_EQ(point.judge(in).failed, 1.0);
  EXPECT_NEAR(point.judge(in).value, 1.01e9, 1.0);
}

TEST(InversionErosion, fails_without_volume) {
  auto point = make_point("inversion", "{}");
  ErosionInputPoint in;
  in.volume_ratio = 1e-3;
  EXPECT_EQ(point.judge(in).failed, 0.0);
  in.volume_ratio = 0.0;
  EXPECT_EQ(point.judge(in).failed, 1.0);
  in.volume_ratio = -0.5;
  EXPECT_EQ(point.judge(in).failed, 1.0);
}

TEST(MinimumTimeStepErosion, fails_below_the_limit) {
  auto point = make_point("minimum_time_step", "{limit: 1 ns}");
  ErosionInputPoint in;
  in.time_step = 1.01e-9;
  EXPECT_EQ(point.judge(in).failed, 0.0);
  in.time_step = 0.99e-9;
  EXPECT_EQ(point.judge(in).failed, 1.0);
}

TEST(GeometricStrainErosion, adds_up_and_comes_back) {
  auto point = make_point("geometric_strain", "{limit: 0.5}");
  ErosionInputPoint in;
  in.strain_increment = {0.01, -0.005, -0.005, 0.0, 0.0, 0.0};
  Verdict v;
  for (int i = 0; i < 60; ++i) v = point.judge(in);
  EXPECT_NEAR(v.value, 0.6, 1e-13);  // isochoric stretch: the axial strain
  EXPECT_EQ(v.failed, 1.0);
  in.strain_increment = -1.0 * in.strain_increment;
  for (int i = 0; i < 60; ++i) v = point.judge(in);
  EXPECT_NEAR(v.value, 0.0, 1e-13);
}

TEST(GeometricStrainErosion, turns_with_the_material) {
  auto point = make_point("geometric_strain", "{limit: 1.0}");
  ErosionInputPoint stretch, turn, shrink;
  stretch.strain_increment = {0.2, -0.1, -0.1, 0.0, 0.0, 0.0};
  turn.rotation = about_z(0.5 * std::numbers::pi);
  shrink.strain_increment = {0.1, -0.2, 0.1, 0.0, 0.0, 0.0};  // undoes the stretch, which now is along y
  point.judge(stretch);
  EXPECT_NEAR(point.judge(turn).value, 0.2, 1e-15);
  EXPECT_NEAR(point.judge(shrink).value, 0.0, 1e-15);
}

/// Damage along a path whose plastic strain, rate, temperature and mean stress are given, against the file's own sum.
double worst_damage(const std::string& name) {
  const kerf::test::Oracle o(name);
  auto point = make_point("johnson_cook_damage",
                          "{D1: 0.05, D2: 3.44, D3: -2.12, D4: 0.002, D5: 0.61, melting_temperature: 1793 K}");
  double worst = 0.0, last = 0.0;
  point.judge({}, {0.0, 293.15});  // what the point starts with has done no damage
  for (std::size_t r = 1; r < o.n_rows(); ++r) {
    const double q = o.column("von_mises_Pa")[r], mean = o.column("mean_stress_Pa")[r];
    const double strain = o.column("effective_plastic_strain")[r], rate = o.column("plastic_strain_rate_1_s")[r];
    ErosionInputPoint in;
    in.pressure = -mean;
    in.stress = {mean + q * 2.0 / 3.0, mean - q / 3.0, mean - q / 3.0, 0.0, 0.0, 0.0};
    // The law finds the rate of the plastic strain itself: the step has to be the one that gives the file's.
    in.dt = rate > 0.0 ? (strain - last) / rate : 1.0;
    last = strain;
    worst = std::max(worst, std::fabs(point.judge(in, {strain, o.column("temperature_K")[r]}).value -
                                      std::min(o.column("johnson_cook_damage")[r], 1.0)));
  }
  return worst;
}

TEST(JohnsonCookDamage, adds_up_along_a_path) {
  // Rows are coarse: the failure strain at the end of each stands for its mean, which makes an error of half a row.
  EXPECT_LT(worst_damage("failure_shear"), 5e-3);
  EXPECT_LT(worst_damage("failure_uniaxial_tension"), 5e-3);
}

TEST(JohnsonCookDamage, softens_beyond_the_critical_damage) {
  const std::string law = "{D1: 0.5, D2: 0, D3: 0, softening: stress, critical_damage: 0.2, softening_exponent: 2}";
  EXPECT_TRUE(make_law<ErosionCriterion>("erosion", "johnson_cook_damage", law)->softens());
  auto point = make_point("johnson_cook_damage", law);
  ErosionInputPoint in;
  in.dt = 1e-6;
  point.judge(in, {0.0, 0.0});  // what the point starts with has done no damage
  for (const double strain : {0.05, 0.1, 0.2, 0.4, 0.5}) {
    const Verdict v = point.judge(in, {strain, 0.0});
    const double d = strain / 0.5, share = std::max(d - 0.2, 0.0) / 0.8;
    EXPECT_NEAR(v.value, d, 1e-15);
    EXPECT_NEAR(v.strength, 1.0 - share * share, 1e-14);
    EXPECT_EQ(v.tension, v.strength);
    EXPECT_EQ(v.failed, strain == 0.5 ? 1.0 : 0.0);
  }
}

TEST(JohnsonCookDamage, leaves_the_stress_alone_unless_asked_and_does_not_heal) {
  EXPECT_FALSE(make_law<ErosionCriterion>("erosion", "johnson_cook_damage", "{D1: 1, D2: 0, D3: 0}")->softens());
  auto point = make_point("johnson_cook_damage", "{D1: 1, D2: 0, D3: 0}");
  ErosionInputPoint in;
  in.dt = 1e-6;
  point.judge(in, {0.0, 0.0});
  for (const double strain : {0.4, 0.4, 0.3}) {
    const Verdict v = point.judge(in, {strain, 0.0});
    EXPECT_NEAR(v.value, 0.4, 1e-15);
    EXPECT_EQ(v.strength, 1.0);
  }
}

TEST(MaximumShear, is_of_the_tensor_or_twice_that) {
  ErosionInputPoint in;
  in.strain_increment = {0.0, 0.0, 0.0, 0.05, 0.0, 0.0};  // an angle that changes by 0.1
  auto tensor = make_point("maximum_shear", "{limit: 0.05, measure: tensor}");
  auto engineering = make_point("maximum_shear", "{limit: 0.1001, measure: engineering}");
  EXPECT_NEAR(tensor.judge(in).value, 0.05, 1e-9);  // square root of round-off where two principal values coincide
  EXPECT_NEAR(engineering.judge(in).value, 0.1, 1e-9);
  EXPECT_EQ(engineering.judge(in).failed, 1.0);
}

TEST(PrincipalStrain, has_a_limit_on_either_side) {
  ErosionInputPoint in;
  in.strain_increment = {0.02, -0.03, 0.001, 0.0, 0.0, 0.0};
  auto both = make_point("principal_strain", "{maximum: 0.0801, minimum: -0.15}");
  auto maximum = make_point("principal_strain", "{maximum: 0.1}");
  auto minimum = make_point("principal_strain", "{minimum: -0.15}");
  for (int i = 1; i <= 5; ++i) {
    const Verdict v = both.judge(in), over = maximum.judge(in), under = minimum.judge(in);
    EXPECT_NEAR(over.value, 0.02 * i, 1e-15);
    EXPECT_NEAR(under.value, -0.03 * i, 1e-15);
    EXPECT_NEAR(v.value, 0.02 * i, 1e-15);  // 0.02/0.0801 is more than 0.03/0.15
    EXPECT_EQ(v.failed, i > 4 ? 1.0 : 0.0);
    if (i < 5) EXPECT_EQ(over.failed + under.failed, 0.0);
    EXPECT_NEAR(both.state("largest_principal_strain"), 0.02 * i, 1e-15);
    EXPECT_NEAR(both.state("smallest_principal_strain"), -0.03 * i, 1e-15);
  }
  in.strain_increment = {1e-9, -1e-9, 0.0, 0.0, 0.0, 0.0};
  EXPECT_EQ(maximum.judge(in).failed, 1.0);
  EXPECT_EQ(minimum.judge(in).failed, 1.0);
}

TEST(PrincipalStrain, a_limit_that_is_not_given_fails_nothing) {
  ErosionInputPoint in;
  in.strain_increment = {5.0, -5.0, 0.0, 0.0, 0.0, 0.0};
  EXPECT_EQ(make_point("principal_strain", "{maximum: 6}").judge(in).failed, 0.0);
  EXPECT_EQ(make_point("principal_strain", "{minimum: -6}").judge(in).failed, 0.0);
  EXPECT_EQ(make_point("principal_strain", "{maximum: 6, minimum: -4}").judge(in).value, -5.0);
}

TEST(PrincipalStrain, is_of_the_tensor_and_turns_with_the_material) {
  auto point = make_point("principal_strain", "{maximum: 1}");
  ErosionInputPoint shear, turn, back;
  shear.strain_increment = {0.0, 0.0, 0.0, 0.05, 0.0, 0.0};  // an angle that changes by 0.1
  turn.rotation = about_z(0.5 * std::numbers::pi);
  back.strain_increment = {0.0, 0.0, 0.0, 0.05, 0.0, 0.0};  // a quarter of a turn later it undoes the first one
  EXPECT_NEAR(point.judge(shear).value, 0.05, 1e-15);
  EXPECT_NEAR(point.state("smallest_principal_strain"), -0.05, 1e-15);
  EXPECT_NEAR(point.judge(turn).value, 0.05, 1e-15);
  EXPECT_NEAR(point.judge(back).value, 0.0, 1e-15);
}

TEST(PrincipalStrain, needs_a_limit_of_the_right_sign) {
  const auto refusal = [](const std::string& keys) { return kerf::test::refusal("erosion", "principal_strain", keys); };
  EXPECT_THAT(refusal("{}"), testing::HasSubstr("expected a maximum, a minimum, or both"));
  EXPECT_THAT(refusal("{maximum: -0.1}"), testing::HasSubstr("maximum"));
  EXPECT_THAT(refusal("{minimum: 0.1}"), testing::HasSubstr("minimum"));
  EXPECT_EQ(refusal("{minimum: -0.1, maximum: 0.1}"), "");
}

TEST(VolumetricStrain, has_a_limit_on_either_side) {
  auto point = make_point("volumetric_strain", "{tension_limit: 0.1, compression_limit: 0.2}");
  ErosionInputPoint in;
  const auto failed = [&](double ratio) {
    in.volume_ratio = ratio;
    return point.judge(in).failed;
  };
  EXPECT_EQ(failed(std::exp(0.0999)), 0.0);
  EXPECT_EQ(failed(std::exp(0.1001)), 1.0);
  EXPECT_EQ(failed(std::exp(-0.1999)), 0.0);
  EXPECT_EQ(failed(std::exp(-0.2001)), 1.0);
  EXPECT_EQ(failed(-1.0), 1.0);
  auto tension = make_point("volumetric_strain", "{tension_limit: 0.1}");
  in.volume_ratio = 0.01;
  EXPECT_EQ(tension.judge(in).failed, 0.0);
  EXPECT_THAT(kerf::test::refusal("erosion", "volumetric_strain", "{}"),
              testing::HasSubstr("expected a tension_limit, a compression_limit, or both"));
}

TEST(MinimumPressure, fails_below_a_negative_limit) {
  auto point = make_point("minimum_pressure", "{limit: -1 GPa}");
  ErosionInputPoint in;
  in.pressure = -1e9;
  EXPECT_EQ(point.judge(in).failed, 0.0);
  in.pressure = -1.0000001e9;
  EXPECT_EQ(point.judge(in).failed, 1.0);
  EXPECT_NE(kerf::test::refusal("erosion", "minimum_pressure", "{limit: 1 GPa}"), "");
}

TEST(Melt, compares_with_the_user_or_with_a_law) {
  auto given = make_point("melt", "{melting_temperature: 1356 K}");
  EXPECT_EQ(given.judge({}, {1355.9, 100.0}).failed, 0.0);
  EXPECT_EQ(given.judge({}, {1356.0, 9000.0}).failed, 1.0);
  auto read = make_point("melt", "{}");
  EXPECT_EQ(read.judge({}, {1500.0, 1600.0}).failed, 0.0);
  EXPECT_EQ(read.judge({}, {1600.0, 1600.0}).failed, 1.0);
  const auto reads = [](const std::string& parameters) {
    return make_law<ErosionCriterion>("erosion", "melt", parameters)->reads();
  };
  ASSERT_EQ(reads("{}").size(), 2u);  // without a law that keeps it the input is refused
  EXPECT_EQ(reads("{}")[1].name, "melting_temperature");
  EXPECT_EQ(reads("{melting_temperature: 1356 K}")[1].name, "temperature");
}

TEST(TulerButcher, counts_time_above_the_threshold) {
  auto point = make_point("tuler_butcher", "{threshold_stress: 1 GPa, exponent: 2, limit: 1.0e+12}");
  ErosionInputPoint in;
  in.dt = 1e-7;
  in.stress = {0.9e9, 0.0, 0.0, 0.0, 0.0, 0.0};
  EXPECT_EQ(point.judge(in).value, 0.0);
  in.stress.xx = 3e9;  // 4e18 Pa2
  EXPECT_NEAR(point.judge(in).value, 4e11, 1e3);
  EXPECT_EQ(point.judge(in).failed, 0.0);
  EXPECT_EQ(point.judge(in).failed, 1.0);
}

TEST(AccumulatedDamage, begins_to_soften_within_a_step) {
  // One step over the onset: 0.04 of the plastic strain come after it.
  auto point = make_point("ductile_damage", "{failure_strain: 0.1, softening: linear, fracture_energy: 10 kJ/m2}");
  ErosionInputPoint in;
  in.dt = 1e-6;
  in.stress = {0.0, 0.0, 0.0, 500e6 / std::sqrt(3.0), 0.0, 0.0};
  EXPECT_EQ(point.judge(in, 0.0).strength, 1.0);
  const Verdict v = point.judge(in, 0.14);
  EXPECT_NEAR(v.value, 500e6 * 1e-3 * 0.04 / (2.0 * 10e3), 1e-12);
  EXPECT_NEAR(v.strength, 1.0 - v.value, 1e-15);
  EXPECT_EQ(v.compression, 1.0);
  EXPECT_EQ(point.judge(in, 0.1 + 0.989 * 0.04).failed, 0.0);
  EXPECT_EQ(point.judge(in, 0.1 + 0.9901 * 0.04).failed, 1.0);
}

TEST(AccumulatedDamage, keys_without_effect_are_refused) {
  const auto refusal = [](const std::string& keys) {
    return kerf::test::refusal("erosion", "johnson_cook_damage", "{D1: 1, D2: 0, D3: 0, " + keys + "}");
  };
  EXPECT_EQ(refusal("softening: stress, critical_damage: 0.5"), "");
  EXPECT_THAT(refusal("critical_damage: 0"), testing::HasSubstr("acts with `softening: stress` only"));
  EXPECT_THAT(refusal("softening_exponent: 1"), testing::HasSubstr("acts with `softening: stress` only"));
  EXPECT_THAT(refusal("softening: linear"), testing::HasSubstr("go together"));
  EXPECT_THAT(refusal("fracture_energy: 1 J/m2"), testing::HasSubstr("go together"));
  EXPECT_THAT(refusal("nonlocal_weight: bell"), testing::HasSubstr("with nonlocal_radius only"));
  EXPECT_THAT(refusal("element_lengths: [1 mm]"), testing::HasSubstr("equal number"));
  EXPECT_THAT(refusal("softening_at_deletion: 0.9"), testing::HasSubstr("only"));
}

TEST(DuctileDamage, finds_the_failure_strain_between_triaxialities) {
  auto point = make_point("ductile_damage", "{triaxialities: [0, 0.5, 1], failure_strain: [1, 0.5, 0.1]}");
  ErosionInputPoint in;
  in.dt = 1e-6;
  in.stress = {3e8, 0.0, 0.0, 0.0, 0.0, 0.0};
  const auto damage_at = [&](double eta, double strain) {
    in.pressure = -eta * 3e8;
    return point.judge(in, strain).value;
  };
  damage_at(0.25, 0.0);
  EXPECT_NEAR(damage_at(0.25, 0.1), 0.1 / 0.75, 1e-14);
  damage_at(0.75, 0.1);  // the state of stress changes, and nothing flows
  EXPECT_NEAR(damage_at(0.75, 0.13), 0.1 / 0.75 + 0.03 / 0.3, 1e-14);
  damage_at(5.0, 0.13);
  EXPECT_NEAR(damage_at(5.0, 0.15), 0.1 / 0.75 + 0.03 / 0.3 + 0.02 / 0.1, 1e-14);
}

TEST(ModifiedJohnsonCookDamage, waits_for_its_threshold_and_speeds_itself_up) {
  // Failure strain 0.5: with D' = 0.6 p' / (0.5 - 0.1) beyond p = 0.1 and p' = r' / (1 - D), (1 - D)^2 = 1 - 3 (r -
  // 0.1).
  auto point = make_point("modified_johnson_cook_damage",
                          "{D1: 0.5, D2: 0, D3: 0, critical_damage: 0.6, threshold_strain: 0.1, reference_rate: 1}");
  ErosionInputPoint in;
  in.dt = 1.0;
  point.judge(in, {0.0, 0.0});
  EXPECT_EQ(point.judge(in, {0.09, 0.0}).value, 0.0);
  for (const double r : {0.15, 0.2, 0.3}) {
    const Verdict v = point.judge(in, {r, 0.0});
    EXPECT_NEAR(v.value, 1.0 - std::sqrt(1.0 - 3.0 * (r - 0.1)), 1e-14);
    EXPECT_EQ(v.strength, 1.0 - v.value);
    EXPECT_EQ(v.compression, v.strength);
    EXPECT_EQ(v.failed, 0.0);
    EXPECT_NEAR(point.state("damaged_plastic_strain"), 0.1 + v.value / 1.5, 1e-14);
  }
  EXPECT_EQ(point.judge(in, {0.4, 0.0}).failed, 1.0);
}

}  // namespace
