// What explosives are made of: Chapman-Jouguet states, detonators, ways round obstacles, and two phases in equilibrium.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <fstream>
#include <sstream>

#include "kerf/law_use.hpp"
#include "model/eikonal.hpp"
#include "model/sight.hpp"
#include "support/eos_point.hpp"
#include "support/oracle.hpp"
#include "support/points.hpp"

namespace {

using namespace kerf;
using kerf::test::EosPoint;
using kerf::test::key_and_number;

const std::string tnt = "A: 371.2e9, B: 3.231e9, R1: 4.15, R2: 0.95, omega: 0.3, initial_energy: 7e9";

double velocity_of(const EosPoint& point, double density) {
  return dynamic_cast<const FrontLaw&>(point.law()).front_speed(density);
}

TEST(Detonation, follows_from_the_constants_of_every_consistent_set) {
  std::ifstream file(std::string(KERF_SOURCE_DIR) + "/tests/data/jwl_sets.csv");
  int n_sets = 0;
  for (std::string line; std::getline(file, line);) {
    if (line.starts_with("#") || line.starts_with("name,") || line.starts_with("HMX")) continue;  // the last: no set
    std::vector<double> v;
    std::string word;
    std::istringstream words(line);
    std::getline(words, word, ',');
    while (v.size() < 12 && std::getline(words, word, ',')) v.push_back(std::stod(word));
    const double density = v[0] * 1e3, D_measured = v[1] * 1e3, D = v[9] * 1e3, p = v[10] * 1e9;
    EosPoint point("jwl",
                   "{" + key_and_number("A", v[3] * 1e9) + ", " + key_and_number("B", v[4] * 1e9) + ", " +
                       key_and_number("R1", v[5]) + ", " + key_and_number("R2", v[6]) + ", " +
                       key_and_number("omega", v[7]) + ", " + key_and_number("initial_energy", v[8] * 1e9) +
                       ", burn: compression}",
                   density);
    // Seven digits in the file; the sets themselves agree with the measured velocity to 0.3 %.
    EXPECT_NEAR(velocity_of(point, density), D, 1e-6 * D) << line;
    EXPECT_NEAR(velocity_of(point, density), D_measured, 3e-3 * D_measured) << line;
    // The share that is burnt at a compression tells 1 - V_CJ = p/(rho0 D^2).
    point.evaluate(density / 0.95, 0.0, true);
    EXPECT_NEAR(0.05 / point.state(0), p / (density * D * D), 3e-6) << line;
    ++n_sets;
  }
  EXPECT_EQ(n_sets, 33);
}

TEST(Detonation, of_an_ideal_gas_has_its_closed_form) {
  // D^2 = 2 (gamma^2 - 1) E0/rho0, p_CJ = rho0 D^2/(gamma + 1).
  const double density = 1630.0, D = 6930.0, E0 = density * D * D / 16.0;
  EosPoint point(
      "jwl", "{A: 0, B: 0, R1: 1, R2: 1, omega: 2, burn: compression, " + key_and_number("initial_energy", E0) + "}",
      density);
  EXPECT_NEAR(velocity_of(point, density), D, 1e-11 * D);
  point.evaluate(density / 0.95, 0.0, true);
  EXPECT_NEAR(0.05 / point.state(0), 0.25, 1e-9);
}

TEST(Detonation, needs_constants_that_have_one) {
  EXPECT_ANY_THROW(EosPoint("jwl",
                            "{A: 1e-3, B: -1e12, R1: 5, R2: 1, omega: 0.01, initial_energy: 1, burn: "
                            "compression}",
                            1000.0));
}

double lighting_time(const std::string& detonators, Vec3 place) {
  return EosPoint("jwl", "{" + tnt + ", detonation_velocity: 7000, detonators: [" + detonators + "]}", 1630.0, place)
      .state(1);
}

TEST(Detonators, light_along_a_line) {
  const std::string line = "{point: [0, 0, 0], end: [0.1, 0, 0], time: 1e-6}";
  EXPECT_DOUBLE_EQ(lighting_time(line, {0.05, 0.03, 0.04}), 1e-6 + 0.05 / 7000);
  EXPECT_DOUBLE_EQ(lighting_time(line, {0.13, 0.0, 0.04}), 1e-6 + 0.05 / 7000);  // from the end
}

TEST(Detonators, light_over_a_plane_to_both_sides) {
  const std::string plane = "{point: [0.02, 5, 7], normal: [3, 0, 0]}";
  EXPECT_DOUBLE_EQ(lighting_time(plane, {0.09, -1.0, 2.0}), 0.07 / 7000);
  EXPECT_DOUBLE_EQ(lighting_time(plane, {-0.05, 1.0, 2.0}), 0.07 / 7000);
}

TEST(Detonators, the_earliest_arrival_counts) {
  const std::string two = "{point: [0, 0, 0]}, {point: [0.1, 0, 0], normal: [1, 0, 0], time: 5e-6}";
  EXPECT_DOUBLE_EQ(lighting_time(two, {0.06, 0.0, 0.0}), 0.06 / 7000);
  EXPECT_DOUBLE_EQ(lighting_time(two, {0.09, 0.0, 0.0}), 5e-6 + 0.01 / 7000);
}

TEST(Detonators, are_lines_or_planes) {
  EXPECT_THAT(kerf::test::refusal("eos", "jwl",
                                  "{" + tnt +
                                      ", detonators: [{point: [0, 0, 0], end: [1, 0, 0], "
                                      "normal: [1, 0, 0]}]}"),
              testing::HasSubstr("not both"));
  EXPECT_THAT(kerf::test::refusal("eos", "jwl", "{" + tnt + ", detonators: [{point: [0, 0, 0], normal: [0, 0, 0]}]}"),
              testing::HasSubstr("must not be zero"));
  EXPECT_THAT(kerf::test::refusal("eos", "jwl", "{" + tnt + ", burn: time}"), testing::HasSubstr("detonators"));
}

TEST(Burn, compression_alone_starts_unburnt) {
  EosPoint point("jwl", "{" + tnt + ", burn: compression}", 1630.0);
  EXPECT_EQ(point.evaluate(1630.0, 0.0, true, 1.0).pressure, 0.0);
  EXPECT_EQ(point.state(0), 0.0);
  point.evaluate(1630.0 / 0.7, 0.0, true);
  EXPECT_EQ(point.state(0), 1.0);
}

// ---- ways round obstacles
// --------------------------------------------------------------------------------------------

TEST(Eikonal, plane_front_is_exact) {
  const Vec3 slowness{0.3, -0.5, std::sqrt(1.0 - 0.34)};
  const auto at = [&](Vec3 x) { return eikonal::Known{x, 2.0 + dot(slowness, x)}; };
  // The way to x goes through the triangle, which is wide enough.
  const Vec3 x{0.3, 0.2, 0.25};
  EXPECT_NEAR(eikonal::from_triangle(x, at({-1.0, -1.0, 0.0}), at({2.0, -1.0, 0.1}), at({0.0, 2.0, 0.0}), 1.0),
              at(x).time, 1e-14);
  EXPECT_NEAR(eikonal::from_line({0.0, 0.4, 0.3}, {{-1.0, 0.0, 0.0}, 0.0}, {{1.0, 0.0, 0.0}, 0.0}, 1.0), 0.5, 1e-15);
}

TEST(Eikonal, ways_that_miss_a_triangle_are_left_to_its_edges) {
  const eikonal::Known a{{0.0, 0.0, 0.0}, 0.0}, b{{1.0, 0.0, 0.0}, 0.0}, c{{0.0, 1.0, 0.0}, 0.0};
  EXPECT_EQ(eikonal::from_triangle({2.0, 2.0, 1.0}, a, b, c, 1.0), eikonal::never);
  EXPECT_EQ(eikonal::from_line({2.0, 0.0, 1.0}, a, b, 1.0), eikonal::never);
  // A time that rises faster than the front runs comes from elsewhere.
  EXPECT_EQ(eikonal::from_line({0.5, 0.5, 0.0}, a, {{1.0, 0.0, 0.0}, 1.5}, 1.0), eikonal::never);
}

TEST(Sight, ends_at_facets_but_not_along_them) {
  const Sight sight({{Vec3{1, -1, -1}, Vec3{1, 1, -1}, Vec3{1, 1, 1}, Vec3{1, -1, 1}}});
  EXPECT_FALSE(sight.is_free({0, 0, 0}, {2, 0, 0}));
  EXPECT_FALSE(sight.is_free({0, 0, 0}, {2, 2, 0}));  // through an edge
  EXPECT_TRUE(sight.is_free({0, 0, 0}, {2, 2.1, 0}));
  EXPECT_TRUE(sight.is_free({0, 0, 0}, {1, 0, 0}));  // to a point of the facet
  EXPECT_TRUE(sight.is_free({1, 0, 0}, {2, 0, 0}));  // from one
  EXPECT_TRUE(sight.is_free({1, -3, 0}, {1, 3, 0}));  // along it
}

// ---- ignition and growth
// ----------------------------------------------------------------------------------------------

const std::string pbx9404 =
    "{unreacted: {A: 6.969e12, B: -1.727e11, R1: 7.8, R2: 3.9, omega: 0.8578, heat_capacity: 2.505e6}, products: {A: "
    "8.545e11, B: 2.0493e10, R1: 4.6, R2: 1.35, omega: 0.25, heat_capacity: 1e6}, initial_energy: 1.02e10, I: 44e6, b: "
    "0.2222, x: 4, G1: 2e8, c: 0.2222, d: 0.6667, y: 1.6}";

TEST(IgnitionAndGrowth, the_undeformed_explosive_is_at_rest) {
  EosPoint point("ignition_and_growth", pbx9404, 1842.0);
  point.set_step(1e-6);
  const EosOutput out = point.evaluate(1842.0, 0.0, true);
  EXPECT_LT(out.pressure, 1e4);  // of the set's own rounding; the modulus is 10 GPa
  EXPECT_EQ(point.state(0), 0.0);
  EXPECT_NEAR(point.state(1), 298.0, 1e-9);
}

TEST(IgnitionAndGrowth, equilibrium_is_found_everywhere) {
  // From the least share to the whole, in strong compression and in wide expansion, cold and hot, and whatever the last
  // state was: pressure and modulus are finite, and the pressure does not depend on the guess.
  for (const double F : {2e-8, 1e-6, 1e-3, 0.1, 0.5, 0.9, 0.999, 1.0 - 2e-8})
    for (const double V : {0.45, 0.6, 0.8, 0.95, 1.0, 1.2, 2.0, 10.0})
      for (const double E : {0.0, 1e9, 5e9, 2e10}) {
        double pressure[2];
        for (int k = 0; k < 2; ++k) {
          EosPoint point("ignition_and_growth", pbx9404, 1842.0);
          point.set_state(0, F);
          point.set_state(2, k == 0 ? 1.0 : 0.3);
          const EosOutput out = point.evaluate(1842.0 / V, E / 1842.0, true);
          pressure[k] = out.pressure;
          EXPECT_TRUE(std::isfinite(out.pressure) && std::isfinite(out.bulk_modulus)) << F << " " << V << " " << E;
          EXPECT_GE(out.bulk_modulus, 0.0);
        }
        EXPECT_NEAR(pressure[0], pressure[1], 1e-9 * std::max(pressure[0], 1e9)) << F << " " << V << " " << E;
      }
}

TEST(IgnitionAndGrowth, modulus_is_that_of_the_isentrope) {
  for (const double F : {0.0, 0.2, 0.7, 1.0})
    for (const double V : {0.7, 0.85}) {
      const double E = 4e9, dV = 1e-5;
      const auto pressure = [&](double volume, double energy) {
        EosPoint point("ignition_and_growth", pbx9404, 1842.0);
        point.set_state(0, F);
        return point.evaluate(1842.0 / volume, energy / 1842.0, false);
      };
      const EosOutput here = pressure(V, E);
      const double wider = pressure(V + dV, E - here.pressure * dV).pressure,
                   closer = pressure(V - dV, E + here.pressure * dV).pressure;
      EXPECT_NEAR(-V * (wider - closer) / (2.0 * dV), here.bulk_modulus, 1e-6 * here.bulk_modulus) << F << " " << V;
    }
}

}  // namespace
