// Equations of state that keep a history: programmed burn, and the crushing of pores.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "support/eos_point.hpp"
#include "support/oracle.hpp"
#include "support/points.hpp"

namespace {

using namespace kerf;
using kerf::test::EosPoint;
using kerf::test::make_law;
using kerf::test::Oracle;

const std::string tnt = "A: 371.2e9, B: 3.231e9, R1: 4.15, R2: 0.95, omega: 0.3, initial_energy: 7e9";

TEST(Jwl, products_have_the_pressure_and_the_modulus_of_the_points) {
  const Oracle o("eos_jwl_tnt_points");
  EosPoint point("jwl", "{" + tnt + "}", 1630.0);
  std::size_t n = 0;
  for (std::size_t r = 0; r < o.n_rows(); ++r) {
    const double wanted = o.column("pressure_Pa")[r];
    if (wanted < 0.0) continue;  // products do not pull
    const EosOutput out = point.evaluate(o.column("density_kg_m3")[r], o.column("specific_energy_J_kg")[r], false);
    // Terms cancel to a thousandth where the products are cold and wide.
    EXPECT_NEAR(out.pressure, wanted, 1e-12 * std::max(std::fabs(wanted), 1e9)) << r;
    EXPECT_NEAR(out.bulk_modulus, o.column("bulk_modulus_Pa")[r],
                1e-12 * std::max(std::fabs(o.column("bulk_modulus_Pa")[r]), 1e9))
        << r;
    ++n;
  }
  EXPECT_GT(n, 10u);
}

TEST(Jwl, burns_as_time_and_compression_say) {
  const Oracle o("burn_fraction");
  for (const auto& [burn, column] : {std::pair("time", "F_time"), {"compression", "F_volume"}, {"both", "F_both"}})
    for (std::size_t r = 0; r < o.n_rows(); ++r) {
      EosPoint point("jwl",
                     "{" + tnt + ", detonation_velocity: 6930, cj_pressure: 21e9, burn: " + burn +
                         ", detonators: [{point: [0, 0, 0], time: 1e-5}]}",
                     1630.0);
      point.set_state(1, 1e-5);
      point.evaluate(1630.0 / o.column("relative_volume")[r], 0.0, true, 1e-5 + o.column("time_since_lighting_s")[r]);
      const double wanted = std::min(o.column(column)[r], 1.0);
      // Nine digits in the file; less than 1e-4 counts as nothing.
      EXPECT_NEAR(point.state(0), wanted < 1e-4 ? 0.0 : wanted, 1e-8) << burn << ", row " << r;
    }
}

TEST(Jwl, stays_burnt_but_does_not_keep_less) {
  EosPoint point("jwl", "{" + tnt + ", detonation_velocity: 6930, cj_pressure: 21e9, detonators: [{point: [1, 0, 0]}]}",
                 1630.0);
  point.evaluate(1.2 * 1630.0, 0.0, true);
  EXPECT_GT(point.state(0), 0.5);
  point.evaluate(1630.0, 0.0, true);
  EXPECT_EQ(point.state(0), 0.0);  // a share that was kept would let round-off light the explosive
  point.evaluate(1.5 * 1630.0, 0.0, true);
  point.evaluate(1630.0, 0.0, true);
  EXPECT_EQ(point.state(0), 1.0);
}

TEST(Jwl, evaluations_that_are_not_the_last_leave_no_trace) {
  EosPoint point("jwl", "{" + tnt + ", detonation_velocity: 6930, cj_pressure: 21e9, detonators: [{point: [1, 0, 0]}]}",
                 1630.0);
  point.evaluate(1.5 * 1630.0, 0.0, false);
  EXPECT_EQ(point.state(0), 0.0);
}

TEST(Jwl, lights_in_straight_lines_from_the_detonators) {
  const Oracle o("lighting_time_open");
  for (std::size_t r = 0; r < o.n_rows(); ++r) {
    const EosPoint point("jwl",
                         "{" + tnt +
                             ", detonation_velocity: 6930, cj_pressure: 21e9, detonators: [{point: [0, 0, 0]}, "
                             "{point: [80 mm, 10 mm, 0], time: 2 us}]}",
                         1630.0, {o.column("x_m")[r], o.column("y_m")[r], o.column("z_m")[r]});
    EXPECT_NEAR(point.state(1), o.column("time_s")[r], 1e-11 * o.column("time_s")[r]);  // twelve digits in the file
  }
}

TEST(Jwl, unlit_explosive_has_the_wave_speed_of_the_detonation) {
  EosPoint point("jwl", "{" + tnt + ", detonation_velocity: 6930, cj_pressure: 21e9, detonators: [{point: [1, 0, 0]}]}",
                 1630.0);
  const EosOutput out = point.evaluate(1630.0, 0.0, true);
  EXPECT_EQ(out.pressure, 0.0);
  EXPECT_NEAR(std::sqrt(out.bulk_modulus / 1630.0), 6930.0, 1e-9);
}

/// The cycles of the file with `steps` steps between two rows, each with two evaluations as elements make them.
double worst_error(const Oracle& o, const std::string& parameters, int steps, bool of_distension) {
  EosPoint point("p_alpha", parameters, 1.0 / o.column("relative_volume")[0] * o.column("density_kg_m3")[0]);
  double energy = 0.0, volume = 1.0, pressure = 0.0, worst = 0.0, greatest = 0.0;
  const double rho0 = o.column("density_kg_m3")[0];
  for (std::size_t r = 1; r < o.n_rows(); ++r) {
    const double from = o.column("relative_volume")[r - 1], to = o.column("relative_volume")[r];
    for (int i = 1; i <= steps; ++i) {
      const double next = from + (to - from) * i / steps, change = (next - volume) / rho0;
      const double predicted = point.evaluate(rho0 / next, energy - pressure * change, false).pressure;
      const double centred = energy - 0.5 * (pressure + predicted) * change;
      const double now = point.evaluate(rho0 / next, centred, true).pressure;
      energy -= 0.5 * (pressure + now) * change;
      pressure = now;
      volume = next;
    }
    const double wanted = of_distension ? o.column("alpha")[r] : o.column("pressure_Pa")[r];
    greatest = std::max(greatest, std::fabs(wanted));
    worst = std::max(worst, std::fabs((of_distension ? point.state(0) : pressure) - wanted));
  }
  return worst / greatest;
}

TEST(PAlpha, follows_loading_unloading_and_compaction) {
  const Oracle o("eos_palpha_aluminium_cycles");
  const std::string parameters =
      "{solid_density: 2703, c0: 5240, s: 1.4, gamma0: 1.97, elastic_pressure: 50e6, solid_pressure: 1e9}";
  // The file's own error is 4e-7 of the energy; twenty steps per row leave the rest far below the tolerance.
  EXPECT_LT(worst_error(o, parameters, 20, false), 1e-4);
  EXPECT_LT(worst_error(o, parameters, 20, true), 1e-5);
}

TEST(PAlpha, never_opens_pores_again) {
  EosPoint point("p_alpha",
                 "{solid_density: 2703, c0: 5240, s: 1.4, gamma0: 1.97, elastic_pressure: 50e6, solid_pressure: 1e9}",
                 2703.0 / 1.3);
  point.evaluate(2703.0 / 1.2, 0.0, true);
  const double crushed = point.state(0);
  EXPECT_LT(crushed, 1.3);
  point.evaluate(2703.0 / 1.3, 0.0, true);
  EXPECT_EQ(point.state(0), crushed);
}

}  // namespace
