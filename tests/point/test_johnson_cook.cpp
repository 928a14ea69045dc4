// Johnson-Cook strength at a point, against a scalar solution by bisection that shares no code with the law.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <random>

#include "support/points.hpp"

namespace {

using namespace kerf;
using kerf::test::make_law;
using kerf::test::MaterialPoint;

struct Constants {
  double G, A, B, n, C, m, Tref, Tmelt, cp, chi, rate0;
};
constexpr Constants steel{79.6e9, 806e6, 614e6, 0.168, 0.0089, 1.1, 293.15, 1813.15, 460.0, 0.9, 1.0};  // 42CrMo4
constexpr Constants copper{46e9, 90e6, 292e6, 0.31, 0.025, 1.09, 293.15, 1356.0, 383.0, 0.9, 1.0};

MaterialPoint make_point(const Constants& c, double density = 7830.0) {
  std::ostringstream text;
  text.precision(17);
  text << "{shear_modulus: " << c.G << ", A: " << c.A << ", B: " << c.B << ", n: " << c.n << ", C: " << c.C
       << ", m: " << c.m << ", reference_temperature: " << c.Tref << ", melting_temperature: " << c.Tmelt
       << ", specific_heat: " << c.cp << ", taylor_quinney: " << c.chi << ", reference_rate: " << c.rate0 << "}";
  return MaterialPoint(make_law<Material>("material", "johnson_cook", text.str()), density);
}

double flow_stress(const Constants& c, double ep, double rate, double T) {
  const double t = std::min(std::max((T - c.Tref) / (c.Tmelt - c.Tref), 0.0), 1.0);
  return (c.A + c.B * std::pow(ep, c.n)) * (1.0 + c.C * std::log(std::max(rate / c.rate0, 1.0))) *
         (1.0 - std::pow(t, c.m));
}

/// Plastic increment of a step with trial stress q, by bisection to the last bit.
double increment_by_bisection(const Constants& c, double q, double ep, double T, double dt) {
  if (q <= flow_stress(c, ep, 0.0, T)) return 0.0;
  double low = 0.0, high = q / (3.0 * c.G);
  for (int i = 0; i < 2000 && low < high; ++i) {
    const double middle = 0.5 * (low + high);
    if (middle == low || middle == high) break;
    (q - 3.0 * c.G * middle > flow_stress(c, ep + middle, middle / dt, T) ? low : high) = middle;
  }
  return 0.5 * (low + high);
}

/// Random steps over many decades of strain, rate, temperature and overstress.
void compare_with_bisection(const Constants& c, unsigned seed) {
  std::mt19937 random(seed);
  std::uniform_real_distribution<double> u(0.0, 1.0);
  for (int i = 0; i < 3000; ++i) {
    auto point = make_point(c);
    const double ep = u(random) < 0.2 ? 0.0 : std::pow(10.0, -6.0 + 7.0 * u(random));
    const double T = c.Tref + (c.Tmelt - c.Tref) * (1.1 * u(random) - 0.05);
    const double dt = std::pow(10.0, -10.0 + 5.0 * u(random));
    const double before = flow_stress(c, ep, 1.0 / dt * std::pow(10.0, -6.0 + 4.0 * u(random)), T) * u(random);
    const SymTensor s{2.0 / 3.0 * before, -before / 3.0, -before / 3.0, 0.0, 0.0, 0.0};
    const double de = std::pow(10.0, -7.0 + 5.5 * u(random));
    point.set_deviator(s);
    point.set_state("effective_plastic_strain", ep);
    point.set_state("temperature", T);
    const double q = before + 3.0 * c.G * de;
    const SymTensor out = point.step({de, -0.5 * de, -0.5 * de, 0.0, 0.0, 0.0}, dt);
    const double d = increment_by_bisection(c, q, ep, T, dt);
    // 1e-9 of the stress: four decades below the scatter of any measured flow curve
    EXPECT_NEAR(von_mises(out), q - 3.0 * c.G * d, 1e-9 * q)
        << "ep " << ep << " T " << T << " dt " << dt << " de " << de;
    EXPECT_NEAR(point.state("effective_plastic_strain"), ep + d, 1e-9 * (d + ep) + 1e-9 * q / (3.0 * c.G));
  }
}

TEST(JohnsonCook, agrees_with_bisection_for_steel) { compare_with_bisection(steel, 1); }
TEST(JohnsonCook, agrees_with_bisection_for_copper) { compare_with_bisection(copper, 2); }
TEST(JohnsonCook, agrees_with_bisection_for_extreme_constants) {
  compare_with_bisection({27e9, 1e6, 800e6, 0.05, 0.3, 0.5, 293.15, 900.0, 900.0, 0.9, 5e-4}, 3);
  compare_with_bisection({160e9, 1500e6, 0.0, 1.0, 0.0, 3.0, 293.15, 3695.0, 134.0, 1.0, 1.0}, 4);
}

TEST(JohnsonCook, steady_shear_follows_the_flow_curve_and_heats) {
  auto point = make_point(steel);
  const double rate = 1e4, dt = 1e-8, de = std::sqrt(3.0) / 2.0 * rate * dt;  // equivalent rate of 1e4 /s
  double work = 0.0, last = 0.0;
  for (int i = 0; i < 5000; ++i) {
    last = point.step({0.0, 0.0, 0.0, de, 0.0, 0.0}, dt).xy;
    work += 2.0 * last * de;
  }
  const double ep = point.state("effective_plastic_strain"), T = point.state("temperature");
  // Flow lags by the heat of one step and the elastic share of the rate: both below 1e-4.
  EXPECT_NEAR(std::sqrt(3.0) * last / flow_stress(steel, ep, rate, T), 1.0, 1e-4);
  EXPECT_NEAR(point.state("plastic_strain_rate") / rate, 1.0, 1e-3);
  const double elastic = last * last / (2.0 * steel.G);
  EXPECT_NEAR((T - steel.Tref) / (steel.chi * (work - elastic) / (7830.0 * steel.cp)), 1.0, 1e-3);
}

TEST(JohnsonCook, does_not_oscillate_under_a_constant_rate) {
  auto point = make_point(copper, 8960.0);
  double rate = 0.0;
  for (int i = 0; i < 400; ++i) {
    point.step({0.0, 0.0, 0.0, 1e-4, 0.0, 0.0}, 1e-8);
    const double now = point.state("plastic_strain_rate");
    if (i > 100) {
      EXPECT_NEAR(now / rate, 1.0, 1e-3) << "step " << i;
    }
    rate = now;
  }
}

TEST(JohnsonCook, has_no_strength_above_melting) {
  auto point = make_point(steel);
  point.set_state("temperature", 2000.0);
  EXPECT_LT(von_mises(point.step({0.01, -0.01, 0.0, 0.0, 0.0, 0.0})), 1e-6 * steel.A);
}

TEST(JohnsonCook, takes_a_step_of_no_time_and_no_strain) {
  auto point = make_point(steel);
  const SymTensor s = point.step({}, 0.0);
  EXPECT_EQ(double_dot(s, s), 0.0);
  EXPECT_EQ(point.state("plastic_strain_rate"), 0.0);
  EXPECT_EQ(point.state("temperature"), steel.Tref);
}

TEST(JohnsonCook, starts_at_its_initial_temperature) {
  const MaterialPoint point(
      make_law<Material>("material", "johnson_cook",
                         "{shear_modulus: 79 GPa, A: 806 MPa, B: 614 MPa, n: 0.168, C: 0.0089, m: 1.1, "
                         "melting_temperature: 1540 degC, initial_temperature: 400 K, specific_heat: 460}"));
  EXPECT_EQ(point.state("temperature"), 400.0);
}

TEST(JohnsonCook, refuses_to_melt_below_its_reference_temperature) {
  EXPECT_THAT(kerf::test::refusal("material", "johnson_cook",
                                  "{shear_modulus: 79 GPa, A: 806 MPa, B: 614 MPa, n: 0.168, C: 0.0089, m: 1.1, "
                                  "melting_temperature: 200 K, specific_heat: 460}"),
              ::testing::HasSubstr("above reference_temperature"));
}

}  // namespace
