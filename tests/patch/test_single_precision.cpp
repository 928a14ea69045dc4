// The element in single precision against itself in double precision: what it loses, and what it must not lose.
#include <gtest/gtest.h>

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>
#include <numeric>
#include <random>

#include "support/one_part.hpp"

namespace {

using namespace kerf;
using namespace kerf::test;

constexpr double size = 1e-3, dt = 5e-8;  // [m], [s]
constexpr double K = 160e9, rho = 8000.0;  // of PartLaws
constexpr double unit = 0x1p-24;  // half a unit in the last place of a float of size one

PartLaws laws_of(int kind) {
  PartLaws laws;
  if (kind == 1) laws.element = "{hourglass: stiffness, hourglass_coefficient: 0.1, stable_step: free_element}";
  if (kind == 2) {
    laws.strength = "elastic_plastic";
    laws.strength_parameters = "{shear_modulus: 80 GPa, yield_stress: 500 MPa, hardening_modulus: 1 GPa}";
    laws.eos = "mie_gruneisen";
    laws.eos_parameters = "{c0: 4000 m/s, s: 1.5, gamma0: 2}";
  }
  if (kind == 3) {
    laws.strength = "johnson_cook";
    laws.strength_parameters =
        "{shear_modulus: 80 GPa, A: 800 MPa, B: 600 MPa, n: 0.17, C: 0.009, m: 1.1, specific_heat: 460, "
        "melting_temperature: 1800 K}";
  }
  return laws;
}

/// Steps of random motion on top of a common velocity, so that stress, viscosity and hourglass forces are all there.
template <class Part>
void shake(Part& part, unsigned seed, Vec3 common = {}, int steps = 3) {
  part.initialise();
  std::mt19937 random(seed);
  std::uniform_real_distribution<double> any(-300.0, 300.0);
  for (int i = 0; i < steps; ++i) {
    for (Vec3& v : part.v) v = common + Vec3{any(random), any(random), any(random)};
    part.step(dt);
  }
}

double largest(SymTensor s) {
  return std::max(
      {std::fabs(s.xx), std::fabs(s.yy), std::fabs(s.zz), std::fabs(s.xy), std::fabs(s.yz), std::fabs(s.zx)});
}

/// Greatest difference of two parts' stresses, in units of the bulk modulus.
template <class A, class B>
double stress_difference(const A& a, const B& b) {
  double most = 0.0;
  for (int e = 0; e < a.n_elements(); ++e) most = std::max(most, largest(a.stress(e) - b.stress(e)));
  return most / K;
}

TEST(SinglePrecision, follows_double_precision_to_round_off) {
  for (int kind = 0; kind < 4; ++kind)
    for (unsigned seed = 1; seed <= 10; ++seed) {
      const CellMesh mesh = distorted_block(3, 3, 2, size, 0.2, seed);
      OnePart exact(mesh, laws_of(kind));
      SinglePart part(mesh, laws_of(kind));
      shake(exact, seed);
      shake(part, seed);
      // Strains of a step are some 5 %, and known to ten units of that; stresses are a tenth of K.
      EXPECT_LT(stress_difference(exact, part), 2.0 * unit) << "kind " << kind << ", seed " << seed;
      double force = 0.0, error = 0.0, energy = 0.0, energy_error = 0.0;
      for (std::size_t n = 0; n < part.x.size(); ++n) {
        force = std::max(force, norm(exact.force(static_cast<int>(n))));
        error = std::max(error, norm(exact.force(static_cast<int>(n)) - part.force(static_cast<int>(n))));
      }
      for (int e = 0; e < part.n_elements(); ++e) {
        const double internal = exact.get(PartStore::internal_energy, e);
        energy = std::max(energy, std::fabs(internal));
        energy_error = std::max(energy_error, std::fabs(internal - part.get(PartStore::internal_energy, e)));
        EXPECT_EQ(part.element_mass(e), exact.element_mass(e));  // masses are doubles
      }
      // So 2 units of K are 20 of the stresses; forces have the areas' error on top of it, some ten units, energies
      // that of the work.
      EXPECT_LT(error, 100.0 * unit * force) << "kind " << kind << ", seed " << seed;
      EXPECT_LT(energy_error, 100.0 * unit * energy) << "kind " << kind << ", seed " << seed;
      // The step follows from the length, of which V and an eigenvalue of B B^T are taken, some tens of units each, and
      // from the wave speed; hourglass energy from products of three projections on modes, which are differences.
      EXPECT_NEAR(part.stable_step() / exact.stable_step(), 1.0, 100.0 * unit);
      EXPECT_NEAR(part.hourglass_energy() / exact.hourglass_energy(), 1.0, 100.0 * unit);
    }
}

TEST(SinglePrecision, forces_of_one_element_add_up_to_nothing_in_integers) {
  for (int kind = 0; kind < 4; ++kind)
    for (unsigned seed = 1; seed <= 50; ++seed) {
      SinglePart part(distorted_element(size, 0.25, seed), laws_of(kind));
      shake(part, 100 * seed);
      for (int d = 0; d < 3; ++d) {
        std::int64_t sum = 0, most = 0;
        for (int n = 0; n < 8; ++n) {
          sum += part.quanta(n, d);
          most = std::max(most, std::abs(part.quanta(n, d)));
        }
        EXPECT_EQ(sum, 0) << "kind " << kind << " seed " << seed;
        EXPECT_GT(most, 1000000);
      }
    }
}

TEST(SinglePrecision, place_and_common_speed_do_not_matter) {
  // Differences are taken before they are rounded. At a million sizes from the origin a double has an error of 1e-10 of
  // the size, and a speed of 10 km/s moves the nodes by half a size in a step.
  const CellMesh here = distorted_block(3, 3, 3, size, 0.2, 4);
  CellMesh there = here;
  for (Vec3& x : there.x) x = x + Vec3{1e6, -2e6, 0.5e6} * size;
  SinglePart near(here, laws_of(0)), far(there, laws_of(0)), fast(here, laws_of(0));
  shake(near, 9);
  shake(far, 9);
  shake(fast, 9, {1e4, -2e3, 5e3});
  EXPECT_LT(stress_difference(near, far), 2.0 * unit);
  EXPECT_LT(stress_difference(near, fast), 2.0 * unit);
  EXPECT_GT(largest(near.stress(0)), 0.01 * K);
}

TEST(SinglePrecision, order_of_elements_and_padding_change_no_bit) {
  const CellMesh mesh = distorted_block(3, 3, 3, size, 0.2, 3);
  CellMesh other = mesh;
  std::vector<int> order(mesh.elements.size());
  std::iota(order.begin(), order.end(), 0);
  std::shuffle(order.begin(), order.end(), std::mt19937(5));
  for (std::size_t e = 0; e < order.size(); ++e) other.elements[e] = mesh.elements[order[e]];
  other.elements.resize(other.elements.size() - 3);  // another number of empty lanes
  for (int kind = 0; kind < 4; ++kind) {
    SinglePart a(mesh, laws_of(kind)), b(other, laws_of(kind));
    shake(a, 3);
    shake(b, 3);
    for (int e = 0; e < b.n_elements(); ++e) {
      for (int c = 0; c < 6; ++c)
        EXPECT_EQ(b.get(PartStore::deviator, e, c), a.get(PartStore::deviator, order[e], c)) << "kind " << kind;
      EXPECT_EQ(b.pressure(e), a.pressure(order[e]));
      EXPECT_EQ(b.get(PartStore::internal_energy, e), a.get(PartStore::internal_energy, order[e]));
      for (int c = 0; c < 13; ++c)
        EXPECT_EQ(b.get(PartStore::element_state, e, c), a.get(PartStore::element_state, order[e], c));
    }
  }
}

TEST(SinglePrecision, turns_the_stress) {
  // Every step rounds the stress: a walk of some units, n steps long.
  constexpr int n = 1000;
  const Eigen::Vector3d axis = Eigen::Vector3d(0.3, -0.5, 0.8).normalized();
  const SymTensor s{300e6, -100e6, -200e6, 150e6, -50e6, 250e6};
  SinglePart part(distorted_block(3, 2, 2, size, 0.2, 7), laws_of(0));
  part.initialise();
  for (int e = 0; e < part.n_elements(); ++e) part.set_deviator(e, s);
  const auto turned = [&](double angle) { return Eigen::AngleAxisd(angle, axis).toRotationMatrix().eval(); };
  const std::vector<Vec3> start = part.x;
  for (int i = 1; i <= n; ++i) {
    std::vector<Vec3> x;
    for (const Vec3& p : start) {
      const Eigen::Vector3d r = turned(1.0 * i / n) * Eigen::Vector3d(p.x, p.y, p.z);
      x.push_back({r[0], r[1], r[2]});
    }
    part.move_to(x, dt);
  }
  const Eigen::Matrix3d r = turned(1.0);
  const SymTensor expected =
      rotate(s, {r(0, 0), r(0, 1), r(0, 2), r(1, 0), r(1, 1), r(1, 2), r(2, 0), r(2, 1), r(2, 2)});
  // The strain of a rigid step is zero to some units of its angle, times 2 G/s = 500.
  const double per_step = unit * (3.0 + 500.0 / n * 3.0);
  for (int e = 0; e < part.n_elements(); ++e)
    EXPECT_LT(largest(part.deviator(e) - expected), 3.0 * std::sqrt(n) * per_step * largest(expected));
}

TEST(SinglePrecision, energies_of_small_steps_are_not_lost) {
  // An increment that a float of the energy's size would not notice.
  SinglePart part(distorted_element(size, 0.1, 2), laws_of(0));
  part.initialise();
  constexpr double large = 1e9;  // [J]
  part.set(PartStore::internal_energy, 0, 0, large);
  part.set_deviator(0, {3e8, -3e8, 0.0, 0.0, 0.0, 0.0});
  for (Vec3& v : part.v) v = Vec3{10.0 * part.x[&v - part.v.data()].x / size, 0.0, 0.0};
  for (int i = 0; i < 100; ++i) part.step(1e-9);
  const double gained = part.get(PartStore::internal_energy, 0) - large;
  const double strain = 100 * 1e-9 * 10.0 / size, stress = 3e8 + 0.5 * (K + 4.0 / 3.0 * 80e9) * strain;  // on average
  EXPECT_NEAR(gained / (stress * strain * part.get(PartStore::volume, 0)), 1.0, 2.0 * strain);  // to second order
  EXPECT_LT(gained, 0.1 * unit * large);
}

TEST(SinglePrecision, edges_from_a_tenth_of_a_micrometre_to_a_hundred_kilometres) {
  // The limits that set-up holds meshes to; areas squared, and determinants of them, are near those of floats. Three
  // of the eight lanes are empty and hold the dummy, which is 16 times as large.
  for (const double edge : {1.2e-7, 1e-5, 1.0, 8e4})
    for (const int kind : {0, 1, 2}) {
      const double time = dt * edge / size;
      const CellMesh mesh = distorted_block(5, 1, 1, edge, 0.2, 8);
      OnePart exact(mesh, laws_of(kind));
      SinglePart part(mesh, laws_of(kind));
      part.force_quantum = exact.force_quantum = OnePart::quantum * std::exp2(std::ceil(2.0 * std::log2(edge / size)));
      for (std::size_t n = 0; n < part.x.size(); ++n)
        part.v[n] = exact.v[n] = {100.0 * std::sin(3.0 * n), 100.0 * std::sin(5.0 * n), 100.0 * std::sin(7.0 * n)};
      exact.initialise();
      part.initialise();
      EXPECT_NEAR(part.stable_step() / exact.stable_step(), 1.0, 100.0 * unit) << edge;
      exact.step(time);
      part.step(time);
      EXPECT_LT(stress_difference(exact, part), 20.0 * unit) << edge;
      EXPECT_NEAR(part.stable_step() / exact.stable_step(), 1.0, 100.0 * unit) << edge;
      EXPECT_EQ(part.work.bad_block, -1) << edge << " m, kind " << kind;
    }
}

TEST(SinglePrecision, pressure_is_that_of_a_doubles_volume) {
  // Rounded to a float once, at the end: not to a share of the bulk modulus.
  for (unsigned seed = 1; seed <= 10; ++seed) {
    const CellMesh mesh = distorted_block(3, 3, 3, size, 0.25, seed);
    for (const double compression : {1.0, 1.0 + 1e-7, 1.0 + 1e-4}) {
      PartLaws laws;
      laws.compression = compression;
      OnePart exact(mesh, laws);
      SinglePart part(mesh, laws);
      exact.initialise();
      part.initialise();
      for (int e = 0; e < part.n_elements(); ++e) {
        // Two formulas of the volume, some ten double's units each, times K.
        EXPECT_NEAR(part.pressure(e), exact.pressure(e), unit * std::fabs(exact.pressure(e)) + 1e-14 * K);
        EXPECT_NEAR(part.get(PartStore::volume, e) / exact.get(PartStore::volume, e), 1.0, 1e-14);
      }
    }
  }
}

TEST(SinglePrecision, an_inverted_element_is_reported_and_exerts_no_force) {
  CellMesh mesh = distorted_element(size, 0.0, 1);
  SinglePart part(mesh);
  part.initialise();
  EXPECT_EQ(part.work.inverted_block, -1);
  std::vector<Vec3> flipped = part.x;
  for (int k = 0; k < 4; ++k) std::swap(flipped[part.nodes(0)[k]], flipped[part.nodes(0)[k + 4]]);
  part.move_to(flipped, dt);
  EXPECT_EQ(part.work.inverted_block, 0);
  for (int n = 0; n < 8; ++n) EXPECT_EQ(norm(part.force(n)), 0.0);
}

TEST(SinglePrecision, a_force_that_is_no_number_is_reported) {
  SinglePart part(distorted_element(size, 0.1, 1));
  part.initialise();
  part.set_deviator(0, {std::nan(""), 0.0, 0.0, 0.0, 0.0, 0.0});
  part.step(dt);
  EXPECT_EQ(part.work.bad_block, 0);
}

}  // namespace
