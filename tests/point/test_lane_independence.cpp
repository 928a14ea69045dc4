// What a law makes of a point must not depend on the lane that the point stands in, nor on who stands in the others:
// which elements share a block is a matter of the partition. Compilers break that where they peel lanes off a loop.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <random>
#include <string>

#include "kerf/eos.hpp"
#include "kerf/material.hpp"
#include "kerf/solid.hpp"
#include "support/make_law.hpp"

namespace {

using namespace kerf;
using kerf::test::builtin_plugins;
using kerf::test::make_law;

const std::map<std::string, std::string> materials = {
    {"cowper_symonds",
     "{shear_modulus: 80e9, yield_stress: 4e8, hardening_modulus: 5e9, isotropic_share: 0.3, C: 40.4, P: 5}"},
    {"elastic", "{shear_modulus: 80e9}"},
    {"elastic_plastic", "{shear_modulus: 80e9, yield_stress: 4e8, hardening_modulus: 5e8}"},
    {"hydrodynamic", "{}"},
    {"johnson_cook",
     "{shear_modulus: 79.6e9, A: 806e6, B: 614e6, n: 0.168, C: 0.0089, m: 1.1, reference_temperature: 293.15, "
     "melting_temperature: 1813.15, specific_heat: 460}"},
    {"mooney_rivlin", "{C10: 30e9, C01: 10e9}"},
    {"neo_hookean", "{shear_modulus: 80e9}"},
    {"newtonian_fluid", "{viscosity: 100}"},
    {"steinberg_guinan",
     "{shear_modulus: 47.7e9, yield_stress: 0.12e9, maximum_yield_stress: 0.64e9, beta: 36, n: 0.45, A: 2.83e-11, "
     "B: 3.77e-4, melting_temperature: 1790, gamma0: 2.02, gamma_slope: 0.47, a: 1.5, specific_heat: 383}"},
    {"tabulated_hardening",
     "{shear_modulus: 80e9, curves: [{plastic_strain_rate: 1, plastic_strain: [0, 0.05, 0.1], yield_stress: [4e8, 5e8, "
     "4.5e8]}, {plastic_strain_rate: 1e3, plastic_strain: [0, 0.1], yield_stress: [5e8, 6e8]}], rate_interpolation: "
     "logarithmic, beyond: last_slope, C: 40.4, P: 5, temperatures: [300, 1000], temperature_factors: [1, 0.2], "
     "specific_heat: 460}"},
    {"mixed_hardening", "{shear_modulus: 80e9, yield_stress: 4e8, hardening_modulus: 5e9, isotropic_share: 0.3}"},
    {"zerilli_armstrong",
     "{shear_modulus: 80e9, C0: 65e6, C1: 1033e6, C3: 0.00698, C4: 0.000415, C5: 266e6, n: 0.289, specific_heat: "
     "452}"}};
const std::map<std::string, std::string> solids = {
    {"johnson_holmquist_2",
     "{shear_modulus: 80e9, A: 0.93, B: 0.31, C: 0.01, M: 0.6, N: 0.6, tensile_strength: 0.2e9, "
     "hugoniot_elastic_limit: "
     "2.8e9, hugoniot_elastic_pressure: 1.46e9, D1: 0.1, D2: 1.0, K1: 131e9}"}};
const std::map<std::string, std::string> equations = {
    {"linear", "{bulk_modulus: 160e9}"},
    {"linear_polynomial", "{C1: 160e9, C2: 1e9, C3: 3e9, C4: 1.9, C5: 0.3, C6: 0.1}"},
    {"mie_gruneisen", "{c0: 4570, s: 1.49, gamma0: 1.93, gamma_slope: 0.5}"},
    {"jwl",
     "{A: 371e9, B: 3.2e9, R1: 4.15, R2: 0.95, omega: 0.3, initial_energy: 7e9, detonation_velocity: 6930, "
     "cj_pressure: "
     "21e9, detonators: [{point: [0, 0, 0]}]}"},
    {"p_alpha", "{solid_density: 9000, c0: 4570, s: 1.49, gamma0: 1.93, elastic_pressure: 50e6, solid_pressure: 1e9}"}};

/// Everything that a law reads and writes of one block, of an element that computes with numbers of type `Real`.
template <class Real>
struct Block {
  static constexpr int n_rows = 6 + 6 + 3, n_state = 12;  // strain, deviator; density, energy, pressure
  using Row = Real[lane_width];
  alignas(64) Real rows[n_rows][lane_width] = {}, outputs[2][lane_width] = {};
  alignas(64) double states[n_state][lane_width] = {};

  Row* strain() { return rows; }
  Row* deviator() { return rows + 6; }
  Real* density() { return rows[12]; }
  Real* energy() { return rows[13]; }
  Real* pressure() { return rows[14]; }
  double* state() { return states[0]; }

  /// The point of one lane of another block takes a lane of this one.
  void take(int lane, const Block& from, int its_lane) {
    for (int r = 0; r < n_rows; ++r) rows[r][lane] = from.rows[r][its_lane];
    for (int r = 0; r < n_state; ++r) states[r][lane] = from.states[r][its_lane];
  }
  void expect_same(int lane, const Block& other, int its_lane, const std::string& what) const {
    for (int r = 0; r < n_rows; ++r) EXPECT_EQ(rows[r][lane], other.rows[r][its_lane]) << what << ", row " << r;
    for (int r = 0; r < n_state; ++r) EXPECT_EQ(states[r][lane], other.states[r][its_lane]) << what << ", state " << r;
    for (int r = 0; r < 2; ++r) EXPECT_EQ(outputs[r][lane], other.outputs[r][its_lane]) << what << ", output " << r;
  }
};

/// Points at rest and in motion, elastic, at the yield stress and far beyond; hot and cold.
template <class Real>
Block<Real> random_block(std::mt19937& random, int n_state) {
  std::uniform_real_distribution<Real> u(-1.0, 1.0);
  Block<Real> b;
  for (int l = 0; l < lane_width; ++l) {
    const auto rate = static_cast<Real>(std::pow(10.0, -2.0 + 2.5 * u(random)));
    const Real load = Real(4e8) * (1 + u(random));
    for (int i = 0; i < 6; ++i) {
      b.strain()[i][l] = Real(1e-2) * rate * u(random);
      b.deviator()[i][l] = load * u(random);
    }
    b.density()[l] = Real(7850.0) * (1 + Real(0.1) * u(random));
    b.energy()[l] = Real(1e5) * (1 + u(random));
    b.pressure()[l] = Real(1e9) * u(random);
    for (int v = 0; v < n_state; ++v) b.state()[v * lane_width + l] = (1.0 + u(random)) * (v == 1 ? 700.0 : 0.2);
  }
  return b;
}

/// Runs blocks through a law, and the same points in other lanes and in other company.
template <class Real, class Update>
void expect_lanes_alike(int n_state, const Update& update, const std::string& name) {
  std::mt19937 random(7);
  for (int round = 0; round < 200; ++round) {
    const Block<Real> start = random_block<Real>(random, n_state);
    Block<Real> together = start;
    update(together);
    for (int shift = 1; shift < lane_width; ++shift) {
      Block<Real> shifted;
      for (int l = 0; l < lane_width; ++l) shifted.take((l + shift) % lane_width, start, l);
      update(shifted);
      for (int l = 0; l < lane_width; ++l) together.expect_same(l, shifted, (l + shift) % lane_width, name);
    }
    for (int l = 0; l < lane_width; ++l) {
      Block<Real> alike;
      for (int k = 0; k < lane_width; ++k) alike.take(k, start, l);
      update(alike);
      for (int k = 0; k < lane_width; ++k) together.expect_same(l, alike, k, name);
    }
    if (testing::Test::HasFailure()) return;
  }
}

/// A turn about z by 0.1 of all points, as rows.
const double (*turn())[lane_width] {
  alignas(64) static double rows[9][lane_width];
  const double one[9] = {std::cos(0.1), -std::sin(0.1), 0.0, std::sin(0.1), std::cos(0.1), 0.0, 0.0, 0.0, 1.0};
  for (int i = 0; i < 9; ++i) std::fill_n(rows[i], lane_width, one[i]);
  return rows;
}

template <class Real>
MaterialRows<Real> rows_of(Block<Real>& b) {
  MaterialRows<Real> m;
  m.rotation = turn();
  m.dt = 1e-7;
  m.reference_density = 7850.0;
  m.strain_increment = b.strain();
  m.density = b.density();
  m.specific_energy = b.energy();
  m.pressure = b.pressure();
  m.deviator = b.deviator();
  m.state = b.state();
  m.shear_modulus = b.outputs[0];
  return m;
}

TEST(Lanes, materials_treat_all_alike) {
  for (const std::string& name : builtin_plugins().names("material")) {
    ASSERT_TRUE(materials.contains(name)) << "give " << name << " parameters here";
    const auto law = make_law<Material>("material", name, materials.at(name));
    const auto n_state = static_cast<int>(law->state_variables().size());
    expect_lanes_alike<double>(
        n_state, [&](Block<double>& b) { law->update(rows_of(b)); }, name);
    expect_lanes_alike<float>(
        n_state, [&](Block<float>& b) { law->update_single(rows_of(b)); }, name + ", single");
  }
}

TEST(Lanes, solids_treat_all_alike) {
  for (const std::string& name : builtin_plugins().names("solid")) {
    ASSERT_TRUE(solids.contains(name)) << "give " << name << " parameters here";
    const auto law = make_law<Solid>("solid", name, solids.at(name));
    expect_lanes_alike<double>(
        static_cast<int>(law->state_variables().size()),
        [&](Block<double>& b) {
          SolidBatch m;
          m.dt = 1e-7;
          m.reference_density = 7850.0;
          m.strain_increment = b.strain();
          m.density = b.density();
          m.specific_energy = b.energy();
          m.deviator = b.deviator();
          m.pressure = b.pressure();
          m.state = b.state();
          m.shear_modulus = b.outputs[0];
          m.bulk_modulus = b.outputs[1];
          law->update(m);
        },
        name);
  }
}

TEST(SinglePrecision, materials_give_the_same_stress_to_round_off) {
  for (const std::string& name : builtin_plugins().names("material")) {
    const auto law = make_law<Material>("material", name, materials.at(name));
    const auto n_state = static_cast<int>(law->state_variables().size());
    std::mt19937 random(3);
    for (int round = 0; round < 200; ++round) {
      Block<float> single = random_block<float>(random, n_state);
      Block<double> exact;
      for (int l = 0; l < lane_width; ++l) {
        for (int r = 0; r < exact.n_rows; ++r) exact.rows[r][l] = single.rows[r][l];
        for (int r = 0; r < exact.n_state; ++r) exact.states[r][l] = single.states[r][l];
      }
      const Block<double> before = exact;
      law->update(rows_of(exact));
      law->update_single(rows_of(single));
      for (int l = 0; l < lane_width; ++l) {
        // The trial stress, of which a few units are lost: the stress before and 2 G times a strain increment. Rubber
        // has its stress from its state.
        double trial = 0.0;
        for (int i = 0; i < 6; ++i)
          trial = std::max({trial, std::fabs(before.rows[6 + i][l]), std::fabs(exact.rows[6 + i][l]),
                            2.0 * 80e9 * std::fabs(before.rows[i][l])});
        for (int i = 0; i < 6; ++i)
          EXPECT_NEAR(single.deviator()[i][l], exact.deviator()[i][l], 20.0 * 0x1p-24 * trial) << name;
        // A plastic increment is known to that over 3 G; of what it heats and of its rate, the same share.
        for (int v = 0; v < n_state; ++v) {
          const double gained = exact.states[v][l] - before.states[v][l];
          const bool is_stress = law->state_variables()[static_cast<std::size_t>(v)].unit == "Pa";
          const double scale = v == 0      ? trial / 80e9
                               : is_stress ? trial
                                           : std::fabs(exact.states[v][l]) + std::fabs(gained);
          EXPECT_NEAR(single.states[v][l], exact.states[v][l], 20.0 * 0x1p-24 * scale) << name << ", state " << v;
        }
        EXPECT_NEAR(single.outputs[0][l], exact.outputs[0][l], 0x1p-23 * exact.outputs[0][l]) << name;
      }
    }
  }
}

TEST(Lanes, equations_of_state_treat_all_alike) {
  for (const std::string& name : builtin_plugins().names("eos")) {
    ASSERT_TRUE(equations.contains(name)) << "give " << name << " parameters here";
    const auto law = make_law<Eos>("eos", name, equations.at(name));
    expect_lanes_alike<double>(
        static_cast<int>(law->state_variables().size()),
        [&](Block<double>& b) {
          EosBatch e;
          e.reference_density = 7850.0;
          e.density = b.density();
          e.specific_energy = b.energy();
          e.dt = 1e-7;
          e.time = 2e-6;
          e.length = b.density();
          e.state = b.state();
          e.new_state = b.state();
          e.pressure = b.outputs[0];
          e.bulk_modulus = b.outputs[1];
          law->evaluate(e);
        },
        name);
  }
}

}  // namespace
