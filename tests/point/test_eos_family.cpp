// Equations of state: what files of curves do not show. Tension limits, ends of formulas, energies at the start, and
// what the input refuses.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>

#include "support/curves.hpp"
#include "support/eos_point.hpp"
#include "support/points.hpp"

namespace {

using namespace kerf;
using kerf::test::EosPoint;
using kerf::test::evaluate;
using kerf::test::make_law;
using kerf::test::refusal;
using testing::HasSubstr;

const std::string lead = "c0: 2006, s: 1.429, s2: 0.8506, s3: -1.64, gamma0: 2.74, gamma_slope: 2.2";
const std::string basalt =
    "a: 0.5, b: 1.5, A: 26.7e9, B: 26.7e9, E0: 487e6, alpha: 5, beta: 5, incipient_vaporisation_energy: 4.72e6, "
    "complete_vaporisation_energy: 18.2e6";
const std::string sand = "compactions: [0, 0.1, 0.2], pressures: [0, 10e6, 100e6], unloading_moduli: 2e9";

struct Case {
  const char* law;
  std::string parameters;
  double density;
};
std::vector<Case> laws() {
  return {{"linear", "bulk_modulus: 100e9", 8000.0},
          {"logarithmic", "bulk_modulus: 100e9", 8000.0},
          {"linear_polynomial", "C1: 2.2e9, C2: 9e9, C4: 0.5", 1000.0},
          {"mie_gruneisen", lead, 11340.0},
          {"stiffened_gas", "gamma: 4.4, stiffness: 600e6", 1000.0},
          {"tillotson", basalt, 2700.0},
          {"murnaghan", "bulk_modulus: 2.2e9, pressure_derivative: 7.15", 1000.0},
          {"birch_murnaghan", "bulk_modulus: 138e9, pressure_derivative: 4.96", 8930.0},
          {"tabulated_compaction", sand, 1800.0}};
}

TEST(EveryEos, cuts_off_tension_at_its_limit_and_comes_back_along_the_same_curve) {
  for (const Case& c : laws()) {
    EosPoint limited(c.law, "{" + c.parameters + ", tension_limit: 1e5}", c.density);
    EosPoint free(c.law, "{" + c.parameters + "}", c.density);
    EXPECT_LT(free.evaluate(0.98 * c.density, 0.0, true).pressure, -1e6) << c.law;
    EXPECT_EQ(limited.evaluate(0.98 * c.density, 0.0, true).pressure, -1e5) << c.law;
    for (const double ratio : {1.05, 1.2})
      EXPECT_EQ(limited.evaluate(ratio * c.density, 0.0, true).pressure,
                free.evaluate(ratio * c.density, 0.0, true).pressure)
          << c.law;
  }
}

TEST(EveryEos, is_as_stiff_where_tension_is_cut_off) {
  // Else a wave would stand still in cavitated material, and nothing would bound its time step until it closes.
  for (const Case& c : laws()) {
    EosPoint limited(c.law, "{" + c.parameters + ", tension_limit: 1e5}", c.density);
    EosPoint free(c.law, "{" + c.parameters + "}", c.density);
    for (const double ratio : {0.95, 0.8, 0.5})
      EXPECT_GE(limited.evaluate(ratio * c.density, 0.0, false).bulk_modulus,
                free.evaluate(ratio * c.density, 0.0, false).bulk_modulus)
          << c.law << " " << ratio;
  }
  EosPoint copper("mie_gruneisen", "{c0: 3940, s: 1.489, gamma0: 1.99, gamma_slope: 0.47, tension_limit: 1e8}", 8960.0);
  const double whole = 8960.0 * 3940.0 * 3940.0;
  // The density's share of it, and 0.4 GPa of the limited pressure's work.
  EXPECT_NEAR(copper.evaluate(0.5 * 8960.0, 0.0, false).bulk_modulus, 0.5 * whole, 0.005 * whole);
}

TEST(EveryEos, shows_what_is_not_a_number) {
  for (const Case& c : laws()) {
    EosPoint point(c.law, "{" + c.parameters + ", tension_limit: 1e5}", c.density);
    EXPECT_TRUE(std::isnan(point.evaluate(std::nan(""), 0.0, false).pressure)) << c.law;
  }
  EosPoint air("ideal_gas", "{gamma: 1.4, initial_pressure: 1e5}", 1.2);
  EXPECT_TRUE(std::isnan(air.evaluate(std::nan(""), 0.0, false).pressure));
}

TEST(EveryEos, starts_without_pressure_and_never_has_a_negative_modulus) {
  for (const Case& c : laws()) {
    EosPoint point(c.law, "{" + c.parameters + "}", c.density);
    EXPECT_EQ(point.evaluate(c.density, 0.0, false).pressure, 0.0) << c.law;
    for (const double ratio : {0.01, 0.2, 0.7, 0.999, 1.0, 1.3, 4.0, 30.0})
      for (const double e : {-1e6, 0.0, 1e5, 1e7, 1e9}) {
        const EosOutput out = point.evaluate(ratio * c.density, e, false);
        EXPECT_TRUE(std::isfinite(out.pressure)) << c.law << " " << ratio << " " << e;
        EXPECT_TRUE(out.bulk_modulus >= 0.0 && std::isfinite(out.bulk_modulus)) << c.law << " " << ratio << " " << e;
      }
  }
}

/// Error of the energy at the end of the isentrope of a file, with `factor` times the usual steps.
double isentrope_error(const std::string& file, double factor) {
  const kerf::test::FinerSteps finer(factor);
  const kerf::test::Oracle oracle(file);
  for (const auto& r : kerf::test::family_of(oracle)->check(oracle))
    if (r.column == "specific_energy_J_kg") return r.error;
  return 0.0;
}

TEST(EveryEos, converges_with_second_order_along_isentropes) {
  for (const char* file : {"eos_gruneisen_cubic_lead_isentrope", "eos_tillotson_basalt_isentrope",
                           "eos_stiffened_water_isentrope", "eos_ideal_air_isentrope"}) {
    // A quarter with half the step; steps between rows are whole numbers, which makes it 0.257 for one.
    const double ratio = isentrope_error(file, 1.0) / isentrope_error(file, 0.5);
    EXPECT_GT(ratio, 0.23) << file;
    EXPECT_LT(ratio, 0.27) << file;
  }
}

TEST(LogarithmicEos, has_equal_pressures_for_equal_logarithmic_strains) {
  EosPoint point("logarithmic", "{bulk_modulus: 100e9}", 8000.0);
  for (const double strain : {-0.5, -1e-3, 1e-3, 0.5}) {
    const EosOutput out = point.evaluate(8000.0 * std::exp(strain), 0.0, false);
    EXPECT_NEAR(out.pressure / (100e9 * strain), 1.0, 1e-12) << strain;  // round-off of the density over the strain
    EXPECT_EQ(out.bulk_modulus, 100e9);
  }
}

/// rho dp/drho + p/rho dp/de by central differences; good to about 1e-6.
double modulus_by_differences(EosPoint& point, double rho, double e) {
  const double h = 1e-6 * rho, g = 1e-6 * (std::fabs(e) + 1e5);
  const double by_density =
      (point.evaluate(rho + h, e, false).pressure - point.evaluate(rho - h, e, false).pressure) / (2 * h);
  const double by_energy =
      (point.evaluate(rho, e + g, false).pressure - point.evaluate(rho, e - g, false).pressure) / (2 * g);
  return rho * by_density + point.evaluate(rho, e, false).pressure / rho * by_energy;
}

TEST(MieGruneisenEos, modulus_beyond_the_end_of_a_linear_hugoniot_is_that_of_the_pressure) {
  EosPoint point("mie_gruneisen", "{c0: 3940, s: 1.489, gamma0: 1}", 8930.0);
  const double pole = 8930.0 * 1.489 / 0.489;
  for (const double ratio : {0.95, 0.97, 1.0, 1.2})  // 1 - s eta is 0.026 at the first
    EXPECT_NEAR(
        point.evaluate(ratio * pole, 0.0, false).bulk_modulus / modulus_by_differences(point, ratio * pole, 0.0), 1.0,
        1e-5)
        << ratio;
}

TEST(MieGruneisenEos, a_cubic_hugoniot_that_would_fall_rises_without_a_jump_or_a_kink) {
  // No energy term, so that the pressure is that of the Hugoniot alone. Its denominator is least at eta = 0.7388.
  EosPoint point("mie_gruneisen", "{c0: 2006, s: 1.429, s2: 0.8506, s3: -1.64, gamma0: 0}", 11340.0);
  double last = 0.0;
  for (double eta = 0.01; eta < 0.98; eta += 0.01) {
    const double rho = 11340.0 / (1.0 - eta);
    const EosOutput out = point.evaluate(rho, 0.0, false);
    EXPECT_GT(out.pressure, last) << eta;
    EXPECT_NEAR(out.bulk_modulus / modulus_by_differences(point, rho, 0.0), 1.0, 1e-5) << eta;
    last = out.pressure;
  }
  const double end = (0.8506 + std::sqrt(0.8506 * 0.8506 + 3 * 1.429 * 1.64)) / (3 * 1.64);
  const EosOutput before = point.evaluate(11340.0 / (1.0 - end * (1 - 1e-9)), 0.0, false),
                  after = point.evaluate(11340.0 / (1.0 - end * (1 + 1e-9)), 0.0, false);
  // Both sides differ by 1e-9 times what the pressure does over its own size, some ten times.
  EXPECT_NEAR(before.pressure / after.pressure, 1.0, 1e-7);
  EXPECT_NEAR(before.bulk_modulus / after.bulk_modulus, 1.0, 1e-7);
}

TEST(MieGruneisenEos, a_cubic_hugoniot_that_rises_to_the_end_is_left_as_it_is) {
  // The denominator is least at eta = 0.52, but the Hugoniot rises on.
  EosPoint point("mie_gruneisen", "{c0: 2000, s: 0.1, s2: 0.1, s3: -0.25, gamma0: 0}", 1000.0);
  for (const double eta : {0.3, 0.7, 0.8, 0.9}) {
    const double left = 1.0 - 0.1 * eta - 0.1 * eta * eta + 0.25 * eta * eta * eta;
    EXPECT_NEAR(point.evaluate(1000.0 / (1.0 - eta), 0.0, false).pressure / (4e9 * eta / (left * left)), 1.0, 1e-12)
        << eta;
  }
}

TEST(GasEos, takes_the_pressure_or_the_energy_at_the_start) {
  EosPoint by_pressure("ideal_gas", "{gamma: 1.4, initial_pressure: 1e5}", 1.2),
      by_energy("ideal_gas", "{gamma: 1.4, initial_energy: 2.5e5}", 1.2);
  for (const double ratio : {0.5, 1.0, 2.0})
    EXPECT_NEAR(
        by_pressure.evaluate(1.2 * ratio, 1e4, false).pressure / by_energy.evaluate(1.2 * ratio, 1e4, false).pressure,
        1.0, 1e-14);
  EXPECT_NEAR(by_pressure.evaluate(1.2, 0.0, false).pressure, 1e5, 1e-9);
  EosPoint water("stiffened_gas", "{gamma: 4.4, stiffness: 600e6, initial_pressure: 1e5}", 1000.0);
  EXPECT_NEAR(water.evaluate(1000.0, 0.0, false).pressure, 1e5, 1e-6);  // round-off of 2.64e9
}

TEST(GasEos, counts_as_energy_at_the_start_what_an_expansion_gives) {
  EXPECT_NEAR(make_law<Eos>("eos", "ideal_gas", "{gamma: 1.4, initial_pressure: 1e5}")->initial_energy_density(), 2.5e5,
              1e-8);
  const auto none = make_law<Eos>("eos", "stiffened_gas", "{gamma: 1.4, stiffness: 0, initial_pressure: 1e5}");
  EXPECT_NEAR(none->initial_energy_density(), 2.5e5, 1e-8);
  // The work of the isentrope from 1 GPa to no pressure, by Simpson's rule.
  const double g = 4.4, P = 600e6, p0 = 1e9, widest = std::pow((p0 + P) / P, 1.0 / g);
  double work = 0.0;
  const int n = 1000;
  for (int i = 0; i <= n; ++i) {
    const double V = 1.0 + (widest - 1.0) * i / n, p = (p0 + P) * std::pow(V, -g) - P;
    work += p * (i == 0 || i == n ? 1.0 : i % 2 == 1 ? 4.0 : 2.0) * (widest - 1.0) / (3.0 * n);
  }
  const auto water = make_law<Eos>("eos", "stiffened_gas", "{gamma: 4.4, stiffness: 600e6, initial_pressure: 1e9}");
  EXPECT_NEAR(water->initial_energy_density() / work, 1.0, 1e-10);  // Simpson's rule: 1e-13
}

TEST(TabulatedCompactionEos, adds_the_pressure_of_the_energy) {
  EosPoint point("tabulated_compaction", "{" + sand + ", gamma: 0.5, thermal_factors: [1, 2, 4], initial_energy: 1e6}",
                 1800.0);
  const double x = 0.15, E = 1800.0 * 1e4 + 1e6, table = 55e6;
  EXPECT_NEAR(point.evaluate(1800.0 * std::exp(x), 1e4, true).pressure / (table + 0.5 * 3.0 * E), 1.0, 1e-12);
  EXPECT_NEAR(point.state(0), 0.15, 1e-15);
  // Unloaded by the modulus of 2 GPa; T goes by where the point is, not by where it has been.
  const double back = table - 2e9 * 0.01 + 0.5 * 2.8 * E;
  EXPECT_NEAR(point.evaluate(1800.0 * std::exp(0.14), 1e4, true).pressure / back, 1.0, 1e-12);
  EXPECT_NEAR(point.evaluate(1800.0 * std::exp(0.14), 1e4, true).bulk_modulus /
                  modulus_by_differences(point, 1800.0 * std::exp(0.14), 1e4),
              1.0, 1e-6);
}

TEST(TabulatedCompactionEos, goes_on_with_the_last_slope) {
  EosPoint point("tabulated_compaction", "{" + sand + "}", 1800.0);
  EXPECT_NEAR(point.evaluate(1800.0 * std::exp(0.3), 0.0, true).pressure, 190e6, 1.0);
}

TEST(EosInput, refuses_what_contradicts_itself) {
  EXPECT_THAT(refusal("eos", "ideal_gas", "{gamma: 1.4}"), HasSubstr("either initial_pressure or initial_energy"));
  EXPECT_THAT(refusal("eos", "ideal_gas", "{gamma: 1.4, initial_pressure: 1e5, initial_energy: 2.5e5}"),
              HasSubstr("either initial_pressure or initial_energy"));
  EXPECT_THAT(refusal("eos", "stiffened_gas", "{gamma: 4.4, stiffness: 1e8, initial_pressure: -2e8}"),
              HasSubstr("does not resist compression"));
  EXPECT_THAT(
      refusal("eos", "stiffened_gas", "{gamma: 4.4, stiffness: 1e8, initial_pressure: 1e5, initial_energy: 1e9}"),
      HasSubstr("not both"));
  EXPECT_THAT(refusal("eos", "tillotson",
                      "{a: 0.5, b: 1.5, A: 26.7e9, B: 26.7e9, E0: 487e6, alpha: 5, beta: 5, "
                      "incipient_vaporisation_energy: 5e6, complete_vaporisation_energy: 4e6}"),
              HasSubstr("must be above incipient"));
  EXPECT_THAT(refusal("eos", "tabulated_compaction", "{" + sand + ", thermal_factors: [1, 2]}"),
              HasSubstr("as many values as compactions"));
  EXPECT_THAT(refusal("eos", "tabulated_compaction",
                      "{compactions: [0, 0.1, 0.2], pressures: [0, 10e6, 100e6], unloading_moduli: 5e8}"),
              HasSubstr("above the slope"));
}

}  // namespace
