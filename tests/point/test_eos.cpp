// Equations of state at a point against closed forms and published values.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "support/points.hpp"

namespace {

using namespace kerf;
using kerf::test::evaluate;
using kerf::test::make_law;

/// rho dp/drho + p/rho dp/de by central differences; good to about 1e-6.
double modulus_by_differences(const Eos& eos, double rho0, double rho, double e) {
  const double h = 1e-5 * rho, g = 1e-5 * (std::fabs(e) + 1e4);
  const double by_density =
      (evaluate(eos, rho0, rho + h, e).pressure - evaluate(eos, rho0, rho - h, e).pressure) / (2 * h);
  const double by_energy =
      (evaluate(eos, rho0, rho, e + g).pressure - evaluate(eos, rho0, rho, e - g).pressure) / (2 * g);
  return rho * by_density + evaluate(eos, rho0, rho, e).pressure / rho * by_energy;
}

TEST(LinearEos, is_proportional_to_the_density_change) {
  const auto eos = make_law<Eos>("eos", "linear", "{bulk_modulus: 163.3 GPa}");
  EXPECT_FALSE(eos->uses_energy());
  EXPECT_NEAR(evaluate(*eos, 7805.0, 7805.0 * 1.1).pressure, 16.33e9, 1.0);
  EXPECT_NEAR(evaluate(*eos, 7805.0, 7805.0 * 0.9).pressure, -16.33e9, 1.0);
  EXPECT_EQ(evaluate(*eos, 7805.0, 7805.0).pressure, 0.0);
  EXPECT_NEAR(evaluate(*eos, 7805.0, 7805.0 * 1.1).bulk_modulus, 1.1 * 163.3e9, 1.0);
}

TEST(LinearEos, holds_its_tension_limit) {
  const auto eos = make_law<Eos>("eos", "linear", "{bulk_modulus: 100 GPa, tension_limit: 1 GPa}");
  EXPECT_EQ(evaluate(*eos, 1000.0, 900.0).pressure, -1e9);
  EXPECT_NEAR(evaluate(*eos, 1000.0, 995.0).pressure, -0.5e9, 1.0);
}

TEST(LinearEos, not_a_number_stays_visible) {
  const auto eos = make_law<Eos>("eos", "linear", "{bulk_modulus: 100 GPa, tension_limit: 1 GPa}");
  EXPECT_TRUE(std::isnan(evaluate(*eos, 1000.0, std::nan("")).pressure));
}

TEST(LinearPolynomialEos, is_an_ideal_gas_with_c4_and_c5) {
  const auto eos = make_law<Eos>("eos", "linear_polynomial", "{C4: 0.4, C5: 0.4, initial_energy: 2.5e5 J/m3}");
  EXPECT_TRUE(eos->uses_energy());
  const double rho = 1.9, e = 3e4, E0 = 2.5e5, rho0 = 1.2;
  const EosOutput out = evaluate(*eos, rho0, rho, e);
  EXPECT_NEAR(out.pressure / (0.4 * rho * (e + E0 / rho0)), 1.0, 1e-14);
  EXPECT_NEAR(out.bulk_modulus / (1.4 * out.pressure), 1.0, 1e-14);
  EXPECT_NEAR(evaluate(*eos, rho0, rho0, 0.0).pressure, 1e5, 1e-6);
}

TEST(LinearPolynomialEos, has_every_term_in_compression_and_drops_c2_and_c6_in_tension) {
  const auto eos = make_law<Eos>("eos", "linear_polynomial",
                                 "{C0: 1.0e5, C1: 2 GPa, C2: 9 GPa, C3: 11 GPa, C4: 0.4, C5: 0.3, C6: 0.2}");
  const double rho0 = 1000.0, e = 2e5, E = rho0 * e;
  for (const double mu : {0.1, 0.3, -0.05}) {
    const double on = mu > 0.0 ? 1.0 : 0.0;
    const double p =
        1e5 + 2e9 * mu + on * 9e9 * mu * mu + 11e9 * mu * mu * mu + (0.4 + 0.3 * mu + on * 0.2 * mu * mu) * E;
    EXPECT_NEAR(evaluate(*eos, rho0, rho0 * (1 + mu), e).pressure / p, 1.0, 1e-12) << mu;
    EXPECT_NEAR(
        evaluate(*eos, rho0, rho0 * (1 + mu), e).bulk_modulus / modulus_by_differences(*eos, rho0, rho0 * (1 + mu), e),
        1.0, 1e-6)
        << mu;
  }
}

TEST(LinearPolynomialEos, refuses_a_material_that_does_not_resist_compression) {
  EXPECT_THAT(kerf::test::refusal("eos", "linear_polynomial", "{C2: 1 GPa}"), ::testing::HasSubstr("C1 or C4"));
}

const char* const copper = "{c0: 3940 m/s, s: 1.489, gamma0: 2.02}";
constexpr double copper_density = 8930.0;

TEST(MieGruneisenEos, gives_the_hugoniot_of_its_shock_velocities) {
  const auto eos = make_law<Eos>("eos", "mie_gruneisen", copper);
  for (const double up : {50.0, 500.0, 1500.0, 3000.0}) {
    const double us = 3940.0 + 1.489 * up, p = copper_density * us * up, rho = copper_density * us / (us - up);
    EXPECT_NEAR(evaluate(*eos, copper_density, rho, 0.5 * up * up).pressure / p, 1.0, 1e-12) << up;
  }
  // reference-data.md, section 5: symmetric impact at 1 km/s
  EXPECT_NEAR(evaluate(*eos, copper_density, 9997.03, 0.5 * 500.0 * 500.0).pressure, 20.91629e9, 2e5);
}

TEST(MieGruneisenEos, agrees_with_singularity_eos) {
  const auto eos = make_law<Eos>("eos", "mie_gruneisen", "{c0: 3940 m/s, s: 1.489, gamma0: 2.02, gamma_slope: 0.47}");
  // [F: singularity-eos tests]; dyn/cm2 to Pa. Its Hugoniot starts at 1e6 dyn/cm2 rather than at zero.
  EXPECT_NEAR(evaluate(*eos, copper_density, 9000.0, 5e4).pressure, 1.998504088912181e9, 1.2e5);
  EXPECT_NEAR(evaluate(*eos, copper_density, 9500.0, 1e4).pressure, 9.595823319513451e9, 1.2e5);
}

TEST(MieGruneisenEos, bulk_modulus_is_the_adiabatic_one) {
  const auto eos = make_law<Eos>("eos", "mie_gruneisen", "{c0: 3940 m/s, s: 1.489, gamma0: 2.02, gamma_slope: 0.47}");
  for (const double ratio : {0.9, 0.99, 1.01, 1.2, 1.5})
    for (const double e : {0.0, 1e5, 1e6}) {
      const double rho = ratio * copper_density;
      EXPECT_NEAR(
          evaluate(*eos, copper_density, rho, e).bulk_modulus / modulus_by_differences(*eos, copper_density, rho, e),
          1.0, 1e-6)
          << ratio << " " << e;
    }
  EXPECT_NEAR(evaluate(*eos, copper_density, copper_density).bulk_modulus / (copper_density * 3940.0 * 3940.0), 1.0,
              1e-14);
}

TEST(MieGruneisenEos, holds_the_pressure_round_the_end_of_the_hugoniot) {
  const auto eos = make_law<Eos>("eos", "mie_gruneisen", copper);
  // 1 - s eta vanishes at the density rho0 s / (s - 1). From 0.02 on the law holds it, so that Hugoniot pressures are
  // 2500 times rho0 c0^2 eta, on either side of the pole and on the pole itself.
  const double pole = copper_density * 1.489 / 0.489;
  for (const double ratio : {0.999, 1.0 - 1e-12, 1.0, 1.0 + 1e-12, 1.001, 1.3}) {
    const double eta = 1.0 - copper_density / (ratio * pole);
    const double held = 2500.0 * copper_density * 3940.0 * 3940.0 * eta * (1.0 - 0.5 * 2.02 * eta);
    const EosOutput out = evaluate(*eos, copper_density, ratio * pole);
    EXPECT_NEAR(out.pressure / held, 1.0, 1e-12) << ratio;  // round-off of some operations
    EXPECT_TRUE(std::isfinite(out.bulk_modulus)) << ratio;
    EXPECT_GT(out.bulk_modulus, 0.0) << ratio;
  }
}

}  // namespace
