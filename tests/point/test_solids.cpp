// Laws of the whole stress: closed forms, choices of the input, and what the input refuses.
#include <gtest/gtest.h>

#include <cmath>

#include "kerf/solid.hpp"
#include "support/make_law.hpp"

namespace {

using namespace kerf;
using kerf::test::make_law;
using kerf::test::refusal;

/// A point that is strained without rotation, step by step.
class SolidPoint {
 public:
  SolidPoint(const std::string& name, const std::string& parameters, double density = 1000.0)
      : law_(make_law<Solid>("solid", name, parameters)), reference_(density), density_(density) {
    for (const StateVariable& v : law_->state_variables()) state_.insert(state_.end(), lane_width, v.initial);
  }
  /// True strains over `n` equal steps of `dt`.
  void strain(double xx, double yy, double zz, int n = 1, double dt = 1e-6) {
    for (int i = 0; i < n; ++i) step(xx / n, yy / n, zz / n, dt);
  }
  void compress(double xx, int n = 1) { strain(-xx, 0.0, 0.0, n); }
  /// Equal true strains that lead to a volume over the undeformed one.
  void to_volume(double volume_ratio, int n = 1) {
    const double e = std::log(volume_ratio * density_ / reference_) / 3.0;
    strain(e, e, e, n);
  }
  double mu() const { return density_ / reference_ - 1.0; }
  double pressure() const { return pressure_[0]; }
  double lateral() const { return deviator_[1][0] - pressure_[0]; }
  double von_mises() const { return kerf::von_mises(detail::tensor_at(deviator_, 0)); }
  double state(const std::string& name) const {
    for (std::size_t v = 0; v < law_->state_variables().size(); ++v)
      if (law_->state_variables()[v].name == name) return state_[v * lane_width];
    throw std::runtime_error("no state " + name);
  }
  double bulk_modulus() const { return bulk_[0]; }

 private:
  void step(double xx, double yy, double zz, double dt) {
    density_ /= std::exp(xx + yy + zz);
    double increment[6][lane_width] = {}, density[lane_width], energy[lane_width] = {}, shear[lane_width];
    for (int l = 0; l < lane_width; ++l) {
      increment[0][l] = xx, increment[1][l] = yy, increment[2][l] = zz;
      density[l] = density_;
    }
    SolidBatch b;
    b.reference_density = reference_;
    b.dt = dt;
    b.strain_increment = increment;
    b.density = density;
    b.specific_energy = energy;
    b.deviator = deviator_;
    b.pressure = pressure_;
    b.state = state_.data();
    b.shear_modulus = shear;
    b.bulk_modulus = bulk_;
    law_->update(b);
  }

  std::unique_ptr<Solid> law_;
  double reference_, density_, deviator_[6][lane_width] = {}, pressure_[lane_width] = {}, bulk_[lane_width] = {};
  std::vector<double> state_;
};

// Boron carbide: K1, K2, K3 of a polynomial that bends, and a failure strain of a thousandth.
const std::string boron_carbide =
    "{shear_modulus: 197 GPa, A: 0.927, B: 0.7, C: 0.005, M: 0.85, N: 0.67, tensile_strength: 0.26 GPa, "
    "most_fractured_strength: 0.2, hugoniot_elastic_limit: 19 GPa, hugoniot_elastic_pressure: 8.71 GPa, D1: 0.001, "
    "D2: 0.5, K1: 233 GPa, K2: -593 GPa, K3: 2800 GPa}";

TEST(JohnsonHolmquist2, boron_carbide_fails_within_one_step_and_takes_up_more_room) {
  SolidPoint point("johnson_holmquist_2", boron_carbide, 2510.0);
  const double de = 1e-5, dt = 1e-9;
  double q_before = 0.0, damage_before = 0.0;
  for (int i = 0; i < 10000 && point.state("damage") == 0.0; ++i) {
    q_before = point.von_mises();
    damage_before = point.state("damage");
    point.strain(-de, 0.0, 0.0, 1, dt);
  }
  EXPECT_EQ(damage_before, 0.0);
  EXPECT_EQ(point.state("damage"), 1.0);
  // Fractured, the strength is most_fractured_strength of sigma_HEL = 1.5 (HEL - PHEL).
  const double sigma_hel = 1.5 * (19e9 - 8.71e9), mu = point.mu();
  EXPECT_NEAR(point.von_mises(), 0.2 * sigma_hel, 1e-6 * sigma_hel);
  // The elastic energy from the intact strength down to that becomes pressure. A step adds 2 G de = 3.9 MPa to the
  // stress, so that the intact strength lies between the stress before and after it: 0.1 % of it.
  const auto bulked = [&](double q) {
    const double energy = (q * q - std::pow(0.2 * sigma_hel, 2)) / (6.0 * 197e9), linear = 233e9 * mu;
    return -linear + std::sqrt(linear * linear + 2.0 * 233e9 * energy);
  };
  EXPECT_NEAR(point.state("bulking_pressure"), bulked(q_before), 2e-3 * bulked(q_before));
  const double polynomial = ((2800e9 * mu - 593e9) * mu + 233e9) * mu;
  EXPECT_NEAR(point.pressure(), polynomial + point.state("bulking_pressure"), 1e-9 * polynomial);
}

TEST(JohnsonHolmquist2, silicon_carbide_is_damaged_step_by_step_and_stays_finite) {
  const std::string silicon_carbide =
      "{shear_modulus: 183 GPa, A: 0.96, B: 0.35, C: 0, M: 1, N: 0.65, tensile_strength: 0.37 GPa, "
      "most_fractured_strength: 0.8, hugoniot_elastic_limit: 14.567 GPa, hugoniot_elastic_pressure: 5.9 GPa, D1: 0.48, "
      "D2: 0.48, K1: 204.785 GPa}";
  SolidPoint coarse("johnson_holmquist_2", silicon_carbide, 3163.0),
      fine("johnson_holmquist_2", silicon_carbide, 3163.0);
  double damage = 0.0;
  for (const double way : {0.3, -0.5, 0.4, -0.6}) {  // far into compression, apart, and again
    coarse.compress(way, 500);
    fine.compress(way, 2000);
    EXPECT_GE(coarse.state("damage"), damage);
    damage = coarse.state("damage");
    // First order: a quarter of the step changes the damage by less than the tolerance of the law, 0.02.
    EXPECT_NEAR(damage, fine.state("damage"), 0.02);
    EXPECT_TRUE(std::isfinite(coarse.pressure()) && std::isfinite(coarse.von_mises()));
  }
  EXPECT_GT(damage, 0.5);
  EXPECT_LE(damage, 1.0);
}

const std::string concrete_but =
    "shear_modulus: 14.86 GPa, A: 0.79, B: 1.6, N: 0.61, C: 0.007, compressive_strength: 48 MPa, "
    "tensile_strength: 4 MPa, most_strength: 7, least_failure_strain: 0.01, crush_pressure: 16 MPa, "
    "crush_mu: 0.001, lock_mu: 0.1, K2: -171 GPa, K3: 208 GPa, D1: 0.04";
const std::string concrete = "{" + concrete_but + ", lock_pressure: 0.8 GPa, K1: 85 GPa}";

TEST(HolmquistJohnsonCook, pressure_is_continuous_where_pores_are_closed) {
  // mu where K1 m + K2 m^2 + K3 m^3 = 0.8 GPa with m = (mu - 0.1)/1.1, found by another program.
  const double locked = 0.11055428761044743;
  SolidPoint below("holmquist_johnson_cook", concrete, 2440.0), above("holmquist_johnson_cook", concrete, 2440.0);
  below.to_volume(1.0 / (1.0 + locked - 1e-9));
  above.to_volume(1.0 / (1.0 + locked + 1e-9));
  // 1e-9 in mu are 80 Pa with K1, and round-off of the density as much.
  EXPECT_NEAR(below.pressure(), 0.8e9, 200.0);
  EXPECT_NEAR(above.pressure(), 0.8e9, 200.0);
}

TEST(HolmquistJohnsonCook, is_reversible_once_pores_are_closed) {
  SolidPoint point("holmquist_johnson_cook", concrete, 2440.0);
  point.to_volume(1.0 / 1.3, 50);
  point.to_volume(1.0 / 1.15, 50);
  const double m = (point.mu() - 0.1) / 1.1, expected = ((208e9 * m - 171e9) * m + 85e9) * m;
  EXPECT_NEAR(point.pressure(), expected, 1e-9 * expected);
  point.to_volume(1.0 / 1.05, 50);  // below lock_mu: no tension beyond T (1 - D)
  EXPECT_NEAR(point.pressure(), -4e6 * (1.0 - point.state("damage")), 1e-3);
}

TEST(HolmquistJohnsonCook, refuses_constants_that_give_no_pressure) {
  const auto refused = [](const std::string& rest) {
    return refusal("solid", "holmquist_johnson_cook", "{" + concrete_but + ", " + rest + "}");
  };
  EXPECT_EQ(refused("lock_pressure: 0.8 GPa, K1: 85 GPa"), "");
  EXPECT_NE(refused("lock_pressure: 10 MPa, K1: 85 GPa").find("lock_pressure must be above"), std::string::npos);
  // K1 m - 171 m^2 + 208 m^3 GPa with K1 = 20 GPa has its highest point at m = 0.067, 0.64 GPa.
  EXPECT_NE(refused("lock_pressure: 0.8 GPa, K1: 20 GPa").find("must give a pressure that rises"), std::string::npos);
}

std::string soil(const std::string& strength, const std::string& table = "") {
  return "{shear_modulus: 200 MPa, " + strength + ", " +
         (table.empty() ? "compactions: [0, 0.02, 0.1], pressures: [0 MPa, 2 MPa, 20 MPa], unloading_moduli: 1 GPa"
                        : table) +
         "}";
}

TEST(DruckerPrager, mohr_coulomb_is_the_cone_through_its_edges_of_compression) {
  // At the edge of compression sigma_1 (1 + sin f)/2 - sigma_3 (1 - sin f)/2 = c cos f, compression positive.
  SolidPoint point("drucker_prager", soil("yield: mohr_coulomb, cohesion: 50 kPa, friction_angle: 30 deg"));
  point.compress(0.1, 10);
  const double axial = 3.0 * point.pressure() + 2.0 * point.lateral(), lateral = -point.lateral();
  EXPECT_GT(point.state("effective_plastic_strain"), 0.0);
  EXPECT_NEAR(axial * (1.0 - 0.5) / 2.0 - lateral * (1.0 + 0.5) / 2.0, 50e3 * std::sqrt(0.75), 1e-6 * axial);
}

TEST(DruckerPrager, three_forms_of_one_cone_agree_and_the_cap_cuts_them) {
  // a0 = c^2/3, a1 = 2 c t/3, a2 = t^2/3.
  SolidPoint linear("drucker_prager", soil("strength_at_no_pressure: 30 kPa, slope: 0.6"));
  SolidPoint quadratic("drucker_prager", soil("yield: quadratic, a0: 3e8 Pa2, a1: 12 kPa, a2: 0.12"));
  SolidPoint capped("drucker_prager", soil("strength_at_no_pressure: 30 kPa, slope: 0.6, most_strength: 3 MPa"));
  for (SolidPoint* p : {&linear, &quadratic, &capped}) p->compress(0.09, 9);
  const double strength = 30e3 + 0.6 * linear.pressure();
  EXPECT_NEAR(linear.von_mises(), strength, 1e-9 * strength);
  EXPECT_NEAR(quadratic.von_mises(), strength, 1e-9 * strength);
  EXPECT_GT(strength, 3e6);
  EXPECT_NEAR(capped.von_mises(), 3e6, 1e-3);
}

TEST(DruckerPrager, compaction_lasts_unless_the_table_holds_both_ways) {
  SolidPoint lasting("drucker_prager", soil("strength_at_no_pressure: 0 Pa, slope: 0.6"));
  SolidPoint elastic("drucker_prager",
                     soil("strength_at_no_pressure: 0 Pa, slope: 0.6",
                          "compactions: [0, 0.02, 0.1], pressures: [0 MPa, 2 MPa, 20 MPa], unloading: along_table"));
  for (SolidPoint* p : {&lasting, &elastic}) {
    p->to_volume(std::exp(-0.06), 6);
    EXPECT_NEAR(p->pressure(), 11e6, 1.0);  // half way from 2 to 20 MPa; round-off of the logarithm
    p->to_volume(std::exp(-0.055), 2);
  }
  EXPECT_NEAR(lasting.pressure(), 11e6 - 0.005 * 1e9, 1.0);
  EXPECT_NEAR(elastic.pressure(), 11e6 - 0.005 * 225e6, 1.0);
  EXPECT_NEAR(lasting.state("greatest_compaction"), 0.06, 1e-9);
  EXPECT_NEAR(lasting.bulk_modulus(), 1e9, 1.0);
}

TEST(DruckerPrager, the_table_may_be_over_mu_and_goes_on_with_its_last_slope) {
  SolidPoint point("drucker_prager",
                   soil("strength_at_no_pressure: 0 Pa, slope: 0",
                        "compaction_measure: mu, compactions: [0, 0.1, 0.2], pressures: [0 MPa, 10 MPa, 30 MPa], "
                        "unloading_moduli: [1 GPa, 2 GPa, 3 GPa]"));
  point.to_volume(1.0 / 1.15, 5);
  EXPECT_NEAR(point.pressure(), 20e6, 1.0);
  EXPECT_NEAR(point.bulk_modulus(), 1.15 * 2.5e9, 10.0);  // rho dp/drho = (1 + mu) dp/dmu
  point.to_volume(1.0 / 1.25, 5);
  EXPECT_NEAR(point.pressure(), 40e6, 1.0);
  point.to_volume(1.0 / 1.24, 5);
  EXPECT_NEAR(point.pressure(), 40e6 - 0.01 * 3e9, 1.0);
}

TEST(DruckerPrager, a_foam_with_slope_3_has_no_lateral_stress_when_crushed) {
  // Uniaxial crushing strength s over the compaction: pressures s/3, slope 3; moduli of unloading E/3 and E/2.
  SolidPoint foam("drucker_prager",
                  "{shear_modulus: 50 MPa, strength_at_no_pressure: 0 Pa, slope: 3, compactions: [0, 0.01, 0.5], "
                  "pressures: [0 MPa, 0.33 MPa, 0.6 MPa], unloading_moduli: 33.4 MPa}");
  foam.compress(0.3, 300);
  const double p = foam.pressure();
  EXPECT_NEAR(p, 0.33e6 + 0.29 / 0.49 * 0.27e6, 1.0);
  EXPECT_NEAR(foam.lateral(), 0.0, 1e-9 * p);
  foam.compress(-0.1, 100);  // stretched while still compacted: the strength vanishes with the pressure
  EXPECT_NEAR(foam.pressure(), 0.0, 1e-6);
  EXPECT_NEAR(foam.von_mises(), 0.0, 1e-6);
}

TEST(DruckerPrager, refuses_tables_and_strengths_that_make_no_sense) {
  const std::string cone = "strength_at_no_pressure: 0 Pa, slope: 0.6";
  const auto refused = [](const std::string& strength, const std::string& table) {
    return refusal("solid", "drucker_prager", soil(strength, table));
  };
  const auto has = [](const std::string& text, const std::string& part) {
    return text.find(part) != std::string::npos;
  };
  EXPECT_EQ(refused(cone, ""), "");
  EXPECT_TRUE(has(refused("slope: 0.6", ""), "yield: linear takes"));
  EXPECT_TRUE(has(refused(cone + ", a0: 1 Pa2", ""), "nothing of the other forms"));
  EXPECT_TRUE(has(refused("yield: quadratic, a0: 1 Pa2, a1: 1 Pa", ""), "yield: quadratic takes"));
  EXPECT_TRUE(has(refused("yield: mohr_coulomb, cohesion: 1 Pa", ""), "yield: mohr_coulomb takes"));
  const std::string end = ", unloading_moduli: 1 GPa";
  EXPECT_TRUE(has(refused(cone, "compactions: [0.1, 0.2], pressures: [0, 1]" + end), "ascend from 0"));
  EXPECT_TRUE(has(refused(cone, "compactions: [0, 0.2, 0.1], pressures: [0, 1, 2]" + end), "ascend from 0"));
  EXPECT_TRUE(has(refused(cone, "compactions: [0, 0.1], pressures: [0, 1, 2]" + end), "as many values"));
  EXPECT_TRUE(has(refused(cone, "compactions: [0, 0.1, 0.2], pressures: [0, 2, 1]" + end), "never fall"));
  EXPECT_TRUE(has(refused(cone, "compactions: [0, 0.1], pressures: [0, 1]"), "unloading_moduli must be one value"));
  EXPECT_TRUE(has(refused(cone, "compactions: [0, 0.1], pressures: [0 MPa, 100 MPa]" + end), "would gain energy"));
}

}  // namespace
