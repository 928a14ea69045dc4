// What a law makes of a point must not depend on the lane that the point stands in, nor on who stands in the others:
// which elements share a block is a matter of the partition. Compilers break that where they peel lanes off a loop.
#include <gtest/gtest.h>

#include <cmath>
#include <map>
#include <random>
#include <string>

#include "kerf/eos.hpp"
#include "kerf/material.hpp"
#include "support/make_law.hpp"

namespace {

using namespace kerf;
using kerf::test::builtin_plugins;
using kerf::test::make_law;

const std::map<std::string, std::string> materials = {
    {"elastic", "{shear_modulus: 80e9}"},
    {"elastic_plastic", "{shear_modulus: 80e9, yield_stress: 4e8, hardening_modulus: 5e8}"},
    {"hydrodynamic", "{}"},
    {"johnson_cook",
     "{shear_modulus: 79.6e9, A: 806e6, B: 614e6, n: 0.168, C: 0.0089, m: 1.1, reference_temperature: 293.15, "
     "melting_temperature: 1813.15, specific_heat: 460}"}};
const std::map<std::string, std::string> equations = {
    {"linear", "{bulk_modulus: 160e9}"},
    {"linear_polynomial", "{C1: 160e9, C2: 1e9, C3: 3e9, C4: 1.9, C5: 0.3, C6: 0.1}"},
    {"mie_gruneisen", "{c0: 4570, s: 1.49, gamma0: 1.93, gamma_slope: 0.5}"}};

/// Everything that a law reads and writes of one block.
struct Block {
  static constexpr int n_rows = 6 + 6 + 3 + 8;  // strain, deviator; density, energy, pressure; state
  using Row = double[lane_width];
  alignas(64) double rows[n_rows][lane_width] = {}, outputs[2][lane_width] = {};

  Row* strain() { return rows; }
  Row* deviator() { return rows + 6; }
  double* density() { return rows[12]; }
  double* energy() { return rows[13]; }
  double* pressure() { return rows[14]; }
  double* state() { return rows[15]; }

  /// The point of one lane of another block takes a lane of this one.
  void take(int lane, const Block& from, int its_lane) {
    for (int r = 0; r < n_rows; ++r) rows[r][lane] = from.rows[r][its_lane];
  }
  void expect_same(int lane, const Block& other, int its_lane, const std::string& what) const {
    for (int r = 0; r < n_rows; ++r) EXPECT_EQ(rows[r][lane], other.rows[r][its_lane]) << what << ", row " << r;
    for (int r = 0; r < 2; ++r) EXPECT_EQ(outputs[r][lane], other.outputs[r][its_lane]) << what << ", output " << r;
  }
};

/// Points at rest and in motion, elastic, at the yield stress and far beyond; hot and cold.
Block random_block(std::mt19937& random, int n_state) {
  std::uniform_real_distribution<double> u(-1.0, 1.0);
  Block b;
  for (int l = 0; l < lane_width; ++l) {
    const double rate = std::pow(10.0, -2.0 + 2.5 * u(random)), load = 4e8 * (1.0 + u(random));
    for (int i = 0; i < 6; ++i) {
      b.strain()[i][l] = 1e-2 * rate * u(random);
      b.deviator()[i][l] = load * u(random);
    }
    b.density()[l] = 7850.0 * (1.0 + 0.1 * u(random));
    b.energy()[l] = 1e5 * (1.0 + u(random));
    b.pressure()[l] = 1e9 * u(random);
    for (int v = 0; v < n_state; ++v) b.state()[v * lane_width + l] = (1.0 + u(random)) * (v == 1 ? 700.0 : 0.2);
  }
  return b;
}

/// Runs blocks through a law, and the same points in other lanes and in other company.
template <class Update>
void expect_lanes_alike(int n_state, const Update& update, const std::string& name) {
  std::mt19937 random(7);
  for (int round = 0; round < 200; ++round) {
    const Block start = random_block(random, n_state);
    Block together = start;
    update(together);
    for (int shift = 1; shift < lane_width; ++shift) {
      Block shifted;
      for (int l = 0; l < lane_width; ++l) shifted.take((l + shift) % lane_width, start, l);
      update(shifted);
      for (int l = 0; l < lane_width; ++l) together.expect_same(l, shifted, (l + shift) % lane_width, name);
    }
    for (int l = 0; l < lane_width; ++l) {
      Block alike;
      for (int k = 0; k < lane_width; ++k) alike.take(k, start, l);
      update(alike);
      for (int k = 0; k < lane_width; ++k) together.expect_same(l, alike, k, name);
    }
    if (testing::Test::HasFailure()) return;
  }
}

TEST(Lanes, MaterialsTreatAllAlike) {
  for (const std::string& name : builtin_plugins().names("material")) {
    ASSERT_TRUE(materials.contains(name)) << "give " << name << " parameters here";
    const auto law = make_law<Material>("material", name, materials.at(name));
    const auto n_state = static_cast<int>(law->state_variables().size());
    expect_lanes_alike(
        n_state,
        [&](Block& b) {
          MaterialBatch m;
          m.dt = 1e-7;
          m.reference_density = 7850.0;
          m.strain_increment = b.strain();
          m.density = b.density();
          m.specific_energy = b.energy();
          m.pressure = b.pressure();
          m.deviator = b.deviator();
          m.state = b.state();
          m.shear_modulus = b.outputs[0];
          law->update(m);
        },
        name);
  }
}

TEST(Lanes, EquationsOfStateTreatAllAlike) {
  for (const std::string& name : builtin_plugins().names("eos")) {
    ASSERT_TRUE(equations.contains(name)) << "give " << name << " parameters here";
    const auto law = make_law<Eos>("eos", name, equations.at(name));
    expect_lanes_alike(
        static_cast<int>(law->state_variables().size()),
        [&](Block& b) {
          EosBatch e;
          e.reference_density = 7850.0;
          e.density = b.density();
          e.specific_energy = b.energy();
          e.state = b.state();
          e.pressure = b.outputs[0];
          e.bulk_modulus = b.outputs[1];
          law->evaluate(e);
        },
        name);
  }
}

}  // namespace
