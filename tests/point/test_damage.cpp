// Johnson-Cook damage at a point, against paths of an independent program and against its softening in closed form.
#include <gtest/gtest.h>

#include "support/oracle.hpp"
#include "support/points.hpp"

namespace {

using namespace kerf;
using kerf::test::ErosionPoint;
using kerf::test::make_law;
using kerf::test::Oracle;

ErosionPoint damage(const std::string& parameters) {
  return ErosionPoint(make_law<ErosionCriterion>("erosion", "johnson_cook_damage", parameters));
}

/// A state of stress with this equivalent and mean stress [Pa].
ErosionInputPoint point_of(double von_mises, double mean, double dt) {
  ErosionInputPoint in;
  in.stress = {2.0 / 3.0 * von_mises + mean, mean - von_mises / 3.0, mean - von_mises / 3.0, 0.0, 0.0, 0.0};
  in.pressure = -mean;
  in.dt = dt;
  return in;
}
/// Plastic strain and temperature, which the criterion reads.
std::vector<double> reads(double strain, double temperature = 0.0) { return {strain, temperature}; }

/// Greatest error of the damage over its greatest value, with straight lines between the rows of the file.
double worst_error(const std::string& name, int steps) {
  const Oracle o(name);
  ErosionPoint point = damage("{D1: 0.05, D2: 3.44, D3: -2.12, D4: 0.002, D5: 0.61, melting_temperature: 1793}");
  double worst = 0.0, greatest = 0.0;
  for (std::size_t r = 1; r < o.n_rows(); ++r) {
    const auto at = [&](const char* column, double share) {
      const std::vector<double>& c = o.column(column);
      return c[r - 1] + share * (c[r] - c[r - 1]);
    };
    const double wanted = o.column("johnson_cook_damage")[r];
    if (wanted >= 1.0) break;  // damage ends at one; the file goes on
    const double dt = (o.column("time_s")[r] - o.column("time_s")[r - 1]) / steps;
    double found = 0.0;
    for (int i = 1; i <= steps; ++i) {
      const double s = static_cast<double>(i) / steps;
      found = point
                  .judge(point_of(at("von_mises_Pa", s), at("mean_stress_Pa", s), dt),
                         reads(at("effective_plastic_strain", s), at("temperature_K", s)))
                  .value;
    }
    worst = std::max(worst, std::fabs(found - wanted));
    greatest = std::max(greatest, wanted);
  }
  EXPECT_GT(greatest, 0.1);
  return worst / greatest;
}

TEST(JohnsonCookDamage, follows_shear_and_tension) {
  // Straight lines between rows miss the first yield within a row: a hundredth of the damage of one row and less.
  for (const char* name : {"failure_shear", "failure_uniaxial_tension"}) EXPECT_LT(worst_error(name, 20), 2e-3) << name;
}

TEST(JohnsonCookDamage, softens_beyond_the_critical_damage) {
  ErosionPoint point =
      damage("{D1: 0.5, D2: 0, D3: 0, softening: stress, critical_damage: 0.2, softening_exponent: 2}");
  for (const double strain : {0.05, 0.1, 0.2, 0.4, 0.5}) {
    const Verdict v = point.judge(point_of(1e9, 0.0, 1e-6), reads(strain));
    const double d = strain / 0.5, share = std::max(d - 0.2, 0.0) / 0.8;
    EXPECT_NEAR(v.value, d, 1e-15);
    EXPECT_NEAR(v.strength, 1.0 - share * share, 1e-14);
    EXPECT_EQ(v.tension, v.strength);
    EXPECT_EQ(v.failed, strain == 0.5 ? 1.0 : 0.0);
  }
}

TEST(JohnsonCookDamage, leaves_the_stress_alone_unless_asked) {
  ErosionPoint point = damage("{D1: 0.5, D2: 0, D3: 0}");
  const Verdict v = point.judge(point_of(1e9, 0.0, 1e-6), reads(0.4));
  EXPECT_NEAR(v.value, 0.8, 1e-15);
  EXPECT_EQ(v.strength, 1.0);
  EXPECT_EQ(v.tension, 1.0);
}

TEST(JohnsonCookDamage, does_not_heal) {
  ErosionPoint point = damage("{D1: 0.5, D2: 0, D3: 0}");
  const double before = point.judge(point_of(1e9, 0.0, 1e-6), reads(0.2)).value;
  EXPECT_EQ(point.judge(point_of(1e9, 0.0, 1e-6), reads(0.2)).value, before);
  EXPECT_EQ(point.judge(point_of(0.0, -1e9, 1e-6), reads(0.2)).value, before);
}

}  // namespace
