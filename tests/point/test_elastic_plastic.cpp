// Strength laws at a point against closed forms.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "support/points.hpp"

namespace {

using namespace kerf;
using kerf::test::make_law;
using kerf::test::MaterialPoint;
using kerf::test::refusal;

constexpr double G = 80.19e9, K = 163.3e9, Y = 2.586e9, Et = 0.1e9;  // reference rod
constexpr double E = 9.0 * K * G / (3.0 * K + G), Ep = E * Et / (E - Et);
constexpr double round_off = 1e-12;  // a few hundred operations in double precision

const char* const rod =
    "{shear_modulus: 80.19 GPa, yield_stress: 2.586 GPa, tangent_modulus: 0.1 GPa, bulk_modulus: 163.3 GPa}";

MaterialPoint rod_point() { return MaterialPoint(make_law<Material>("material", "elastic_plastic", rod)); }

SymTensor shear(double xy) { return {0.0, 0.0, 0.0, xy, 0.0, 0.0}; }
SymTensor axial(double xx) { return {xx, 0.0, 0.0, 0.0, 0.0, 0.0}; }

TEST(ElasticPlastic, simple_shear_is_elastic_up_to_yield) {
  auto point = rod_point();
  const double yield_strain = Y / std::sqrt(3.0) / (2.0 * G);
  for (int i = 0; i < 10; ++i) point.step(shear(0.0999 * yield_strain));
  EXPECT_NEAR(point.deviator().xy / (2.0 * G * 0.999 * yield_strain), 1.0, round_off);
  EXPECT_EQ(point.state("effective_plastic_strain"), 0.0);
  EXPECT_EQ(point.shear_modulus(), G);
}

TEST(ElasticPlastic, simple_shear_hardens_with_the_plastic_modulus) {
  auto point = rod_point();
  const double strain = 0.2;  // tensor component
  for (int i = 0; i < 1000; ++i) point.step(shear(strain / 1000));
  // q = sqrt(3) tau = Y + Ep ep, and 2 strain / sqrt(3) = q / 3G + ep
  const double ep = (2.0 * strain / std::sqrt(3.0) - Y / (3.0 * G)) / (1.0 + Ep / (3.0 * G));
  EXPECT_NEAR(point.state("effective_plastic_strain") / ep, 1.0, round_off);
  EXPECT_NEAR(std::sqrt(3.0) * point.deviator().xy / (Y + Ep * ep), 1.0, round_off);
}

TEST(ElasticPlastic, result_does_not_depend_on_the_number_of_steps_of_a_proportional_path) {
  auto once = rod_point(), often = rod_point();
  once.step(shear(0.1));
  for (int i = 0; i < 777; ++i) often.step(shear(0.1 / 777));
  EXPECT_NEAR(once.deviator().xy / often.deviator().xy, 1.0, round_off);
}

TEST(ElasticPlastic, uniaxial_strain_yields_at_the_hugoniot_elastic_limit) {
  auto point = rod_point();
  const double at_yield = Y / (2.0 * G);  // s_xx - s_yy = 2 G e = Y
  point.step(axial(-at_yield * (1.0 - 1e-9)));
  EXPECT_EQ(point.state("effective_plastic_strain"), 0.0);
  const double stress = -point.deviator().xx + K * at_yield;
  EXPECT_NEAR(stress / 4.35708e9, 1.0, 2e-6);  // as many digits as reference-data.md prints
  point.step(axial(-at_yield * 1e-6));
  EXPECT_GT(point.state("effective_plastic_strain"), 0.0);
}

TEST(ElasticPlastic, uniaxial_tension_beyond_yield_has_the_tangent_modulus) {
  auto point = rod_point();
  // The lateral strain that keeps the lateral stress at zero, found by secant in every step.
  double mean_strain = 0.0, before = 0.0, lateral_guess = -0.3;
  for (int i = 0; i < 200; ++i) {
    const double dx = 1e-3;
    const auto lateral_stress = [&](double ratio) {
      auto trial = point;
      const double dy = ratio * dx, volume = mean_strain + dx + 2.0 * dy;
      return trial.step({dx, dy, dy, 0.0, 0.0, 0.0}).yy + K * volume;
    };
    double a = lateral_guess, b = a - 0.1, fa = lateral_stress(a), fb = lateral_stress(b);
    for (int n = 0; n < 30 && std::fabs(fb) > 1.0 && fa != fb; ++n) {
      const double c = b - fb * (b - a) / (fb - fa);
      a = b, fa = fb, b = c, fb = lateral_stress(c);
    }
    lateral_guess = b;
    point.step({dx, b * dx, b * dx, 0.0, 0.0, 0.0});
    mean_strain += dx * (1.0 + 2.0 * b);
    const double stress = point.deviator().xx + K * mean_strain;
    if (i == 5) {
      EXPECT_NEAR((stress - before) / dx / E, 1.0, 1e-6);
    } else if (i > 100) {
      EXPECT_NEAR((stress - before) / dx / Et, 1.0, 1e-4);  // the secant stops at 1 Pa, the steps are 1e5 Pa
    }
    before = stress;
  }
}

TEST(ElasticPlastic, unloads_elastically_and_yields_again_at_the_hardened_stress) {
  auto point = rod_point();
  for (int i = 0; i < 100; ++i) point.step(shear(1e-3));
  const double tau = point.deviator().xy, ep = point.state("effective_plastic_strain");
  point.step(shear(-0.9999 * tau / G));  // to just short of the opposite yield: isotropic hardening
  EXPECT_NEAR(point.deviator().xy / -tau, 0.9998, 1e-9);
  EXPECT_EQ(point.state("effective_plastic_strain"), ep);
  point.step(shear(-0.01));
  EXPECT_GT(point.state("effective_plastic_strain"), ep);
}

TEST(ElasticPlastic, hydrostatic_strain_makes_no_deviator) {
  auto point = rod_point();
  const SymTensor s = point.step({-0.1, -0.1, -0.1, 0.0, 0.0, 0.0});
  EXPECT_LE(std::sqrt(double_dot(s, s)), 1e-15 * G);
  EXPECT_EQ(point.state("effective_plastic_strain"), 0.0);
}

TEST(ElasticPlastic, not_a_number_stays_visible) {
  auto point = rod_point();
  EXPECT_TRUE(std::isnan(point.step(shear(std::nan(""))).xy));
}

TEST(ElasticPlastic, hardening_modulus_and_tangent_modulus_agree) {
  MaterialPoint direct(make_law<Material>(
      "material", "elastic_plastic",
      "{shear_modulus: 80.19e9, yield_stress: 2.586e9, hardening_modulus: " + std::to_string(Ep) + "}"));
  MaterialPoint young(make_law<Material>("material", "elastic_plastic",
                                         "{shear_modulus: 80.19e9, yield_stress: 2.586e9, tangent_modulus: 1.0e8, "
                                         "youngs_modulus: " +
                                             std::to_string(E) + "}"));
  auto bulk = rod_point();
  for (MaterialPoint* p : {&direct, &young, &bulk}) p->step(shear(0.3));
  EXPECT_NEAR(direct.deviator().xy / bulk.deviator().xy, 1.0, 1e-12);
  EXPECT_NEAR(young.deviator().xy / bulk.deviator().xy, 1.0, 1e-12);
}

TEST(ElasticPlastic, is_perfectly_plastic_without_modulus) {
  MaterialPoint point(
      make_law<Material>("material", "elastic_plastic", "{shear_modulus: 80 GPa, yield_stress: 1 GPa}"));
  for (int i = 0; i < 50; ++i) point.step({0.01, -0.01, 0.0, 0.003, 0.0, 0.002});
  EXPECT_NEAR(von_mises(point.deviator()) / 1e9, 1.0, round_off);
}

TEST(ElasticPlastic, refuses_ambiguous_moduli) {
  using ::testing::HasSubstr;
  const auto says = [](const std::string& more) {
    return refusal("material", "elastic_plastic", "{shear_modulus: 80 GPa, yield_stress: 1 GPa, " + more + "}");
  };
  EXPECT_THAT(says("tangent_modulus: 1 GPa"), HasSubstr("needs either bulk_modulus or youngs_modulus"));
  EXPECT_THAT(says("tangent_modulus: 1 GPa, bulk_modulus: 160 GPa, youngs_modulus: 200 GPa"), HasSubstr("not both"));
  EXPECT_THAT(says("tangent_modulus: 1 GPa, bulk_modulus: 160 GPa, hardening_modulus: 1 GPa"), HasSubstr("not both"));
  EXPECT_THAT(says("bulk_modulus: 160 GPa"), HasSubstr("only together with tangent_modulus"));
  EXPECT_THAT(says("tangent_modulus: 300 GPa, bulk_modulus: 160 GPa"), HasSubstr("less than Young's modulus"));
  EXPECT_THAT(says("tangent_modulus: 1 GPa, youngs_modulus: 240 GPa"), HasSubstr("three times shear_modulus"));
  EXPECT_EQ(says("tangent_modulus: 0 GPa, bulk_modulus: 160 GPa"), "");
}

TEST(Elastic, grows_linearly_with_the_deviatoric_strain) {
  MaterialPoint point(make_law<Material>("material", "elastic", "{shear_modulus: 10 GPa}"));
  const SymTensor s = point.step({0.03, 0.0, 0.0, 0.01, 0.0, -0.02});
  EXPECT_DOUBLE_EQ(s.xx, 4e8);
  EXPECT_DOUBLE_EQ(s.yy, -2e8);
  EXPECT_DOUBLE_EQ(s.xy, 2e8);
  EXPECT_DOUBLE_EQ(s.zx, -4e8);
  EXPECT_EQ(point.shear_modulus(), 10e9);
}

TEST(Hydrodynamic, has_no_strength) {
  MaterialPoint point(make_law<Material>("material", "hydrodynamic"));
  point.set_deviator({1e9, -1e9, 0.0, 1e9, 0.0, 0.0});
  const SymTensor s = point.step(shear(0.1));
  EXPECT_EQ(double_dot(s, s), 0.0);
  EXPECT_EQ(point.shear_modulus(), 0.0);
}

}  // namespace
