// Sums of element forces, independence of lanes, bulk viscosity.
#include <gtest/gtest.h>

#include <algorithm>
#include <numeric>
#include <random>

#include "support/one_part.hpp"

namespace {

using namespace kerf;
using namespace kerf::test;

constexpr double size = 1e-3, dt = 5e-8;  // [m], [s]
constexpr double K = 160e9, G = 80e9, rho = 8000.0;

PartLaws laws_of(int kind) {
  PartLaws laws;
  if (kind == 1) laws.element = "{hourglass: stiffness, hourglass_coefficient: 0.1}";
  if (kind == 2) {
    laws.strength = "elastic_plastic";
    laws.strength_parameters = "{shear_modulus: 80 GPa, yield_stress: 500 MPa, hardening_modulus: 1 GPa}";
    laws.eos = "mie_gruneisen";
    laws.eos_parameters = "{c0: 4000 m/s, s: 1.5, gamma0: 2}";
  }
  return laws;
}

std::vector<Vec3> random_velocities(std::size_t n, double speed, unsigned seed) {
  std::mt19937 random(seed);
  std::uniform_real_distribution<double> any(-speed, speed);
  std::vector<Vec3> v;
  for (std::size_t i = 0; i < n; ++i) v.push_back({any(random), any(random), any(random)});
  return v;
}

/// Some steps of random motion, so that stress, viscosity and hourglass forces are all there.
void shake(OnePart& part, unsigned seed) {
  part.initialise();
  for (unsigned i = 0; i < 3; ++i) {
    part.v = random_velocities(part.x.size(), 500.0, seed + i);
    part.step(dt);
  }
}

TEST(ElementForces, of_one_element_add_up_to_nothing_in_integers) {
  for (int kind = 0; kind < 3; ++kind)
    for (unsigned seed = 1; seed <= 50; ++seed) {
      OnePart part(distorted_element(size, 0.25, seed), laws_of(kind));
      shake(part, 100 * seed);
      std::int64_t largest = 0;
      for (int d = 0; d < 3; ++d) {
        std::int64_t sum = 0;
        for (int n = 0; n < 8; ++n) {
          sum += part.quanta(n, d);
          largest = std::max(largest, std::abs(part.quanta(n, d)));
        }
        EXPECT_EQ(sum, 0) << "kind " << kind << " seed " << seed;
      }
      EXPECT_GT(largest, 1000000);
    }
}

TEST(ElementForces, the_last_node_differs_by_no_more_than_the_others_rounding) {
  // It takes minus the sum of seven rounded forces instead of its own. Under a pressure alone its own force is p B.
  for (unsigned seed = 1; seed <= 50; ++seed) {
    const CellMesh mesh = distorted_element(size, 0.25, seed);
    PartLaws laws;
    laws.compression = 1.01;
    OnePart part(mesh, laws);
    part.initialise();
    part.step(dt);
    const int last = part.nodes(0)[7];
    for (int d = 0; d < 3; ++d) {
      CellMesh plus = mesh, minus = mesh;
      plus.x[last][d] += 0.25 * size, minus.x[last][d] -= 0.25 * size;
      const auto& e = mesh.elements[0];
      const double b = (volume_by_divergence(plus, e) - volume_by_divergence(minus, e)) / (0.5 * size);
      const double round_off = 1e-13 * part.pressure(0) * size * size;
      EXPECT_NEAR(part.force(last)[d], part.pressure(0) * b, 3.5 * OnePart::quantum + round_off);
    }
  }
}

TEST(ElementForces, of_a_block_have_no_torque_under_symmetric_stress) {
  OnePart part(distorted_block(3, 3, 3, size, 0.2, 9), laws_of(0));
  shake(part, 4);
  Vec3 torque;
  double scale = 0.0;
  for (std::size_t n = 0; n < part.x.size(); ++n) {
    torque = torque + cross(part.x[n], part.force(static_cast<int>(n)));
    scale = max_of(scale, norm(part.x[n]) * norm(part.force(static_cast<int>(n))));
  }
  EXPECT_LT(norm(torque), 1e-12 * scale);
}

/// The same elements in another order: other lanes, other neighbours in the block.
CellMesh reordered(const CellMesh& mesh, const std::vector<int>& order) {
  CellMesh other;
  other.x = mesh.x;
  for (const int e : order) other.elements.push_back(mesh.elements[e]);
  return other;
}

TEST(Lanes, order_of_elements_changes_no_bit) {
  for (int kind = 0; kind < 3; ++kind) {
    const CellMesh mesh = distorted_block(3, 3, 3, size, 0.2, 9);
    std::vector<int> order(mesh.elements.size());
    std::iota(order.begin(), order.end(), 0);
    std::shuffle(order.begin(), order.end(), std::mt19937(3));
    OnePart one(mesh, laws_of(kind)), other(reordered(mesh, order), laws_of(kind));
    shake(one, 4);
    shake(other, 4);
    for (std::size_t n = 0; n < one.x.size(); ++n)
      for (int d = 0; d < 3; ++d) EXPECT_EQ(one.quanta(n, d), other.quanta(n, d)) << "kind " << kind;
    for (std::size_t i = 0; i < order.size(); ++i) {
      for (int c = 0; c < 6; ++c)
        EXPECT_EQ(other.get(PartStore::deviator, i, c), one.get(PartStore::deviator, order[i], c));
      EXPECT_EQ(other.get(PartStore::internal_energy, i), one.get(PartStore::internal_energy, order[i]));
    }
    EXPECT_EQ(one.work.hourglass_energy, other.work.hourglass_energy);
  }
}

TEST(Lanes, padding_does_not_matter) {
  // 1 to 17 elements leave 7 to no lanes without an element; forces and state must be those of elements alone.
  const CellMesh mesh = distorted_block(17, 1, 1, size, 0.2, 5);
  std::vector<OnePart> alone;
  for (int e = 0; e < 17; ++e) {
    alone.emplace_back(reordered(mesh, {e}), laws_of(0));
    shake(alone.back(), 4);
  }
  for (int count = 1; count <= 17; ++count) {
    std::vector<int> order(count);
    std::iota(order.begin(), order.end(), 0);
    OnePart part(reordered(mesh, order), laws_of(0));
    shake(part, 4);
    std::int64_t hourglass = 0;
    double step = 1.0;
    for (int e = 0; e < count; ++e) {
      EXPECT_EQ(part.pressure(e), alone[e].pressure(0));
      hourglass += alone[e].work.hourglass_energy;
      step = min_of(step, alone[e].stable_step());
    }
    EXPECT_EQ(part.work.hourglass_energy, hourglass);
    for (std::size_t n = 0; n < part.x.size(); ++n)
      for (int d = 0; d < 3; ++d) {
        std::int64_t sum = 0;
        for (int e = 0; e < count; ++e) sum += alone[e].quanta(n, d);
        EXPECT_EQ(part.quanta(n, d), sum);
      }
    EXPECT_EQ(part.stable_step(), step);
  }
}

/// Bulk viscosity pressure of a cube that is stretched at the given rate for one step.
double viscosity_pressure(double rate, const std::string& element) {
  PartLaws laws;
  laws.element = element;
  OnePart part(distorted_element(size, 0.0, 1), laws);
  part.initialise();
  for (std::size_t n = 0; n < part.x.size(); ++n) part.v[n].x = rate * part.x[n].x;
  part.step(1e-9);
  return part.get(PartStore::element_state, 0);
}

TEST(BulkViscosity, acts_in_compression_only) {
  EXPECT_EQ(viscosity_pressure(1e5, "{}"), 0.0);
  EXPECT_EQ(viscosity_pressure(0.0, "{}"), 0.0);
  EXPECT_GT(viscosity_pressure(-1e5, "{}"), 0.0);
}

TEST(BulkViscosity, is_the_formula_of_both_terms) {
  const double rate = 1e5, c = std::sqrt((K + 4.0 / 3.0 * G) / rho);
  const double b1 = 0.07, b2 = 1.3;
  const double expected = rho * size * rate * (b1 * c + b2 * size * rate);
  // In a step of 1e-9 s the cube becomes shorter by 1e-4 of its size.
  EXPECT_NEAR(viscosity_pressure(-rate, "{linear_viscosity: 0.07, quadratic_viscosity: 1.3}") / expected, 1.0, 5e-4);
  EXPECT_NEAR(
      viscosity_pressure(-rate, "{linear_viscosity: 0.07, quadratic_viscosity: 0}") / (rho * size * rate * b1 * c), 1.0,
      5e-4);
}

TEST(BulkViscosity, is_in_the_forces_but_not_in_the_pressure) {
  PartLaws laws;
  laws.strength = "hydrodynamic";
  laws.strength_parameters = "{}";
  OnePart part(distorted_element(size, 0.0, 1), laws);
  part.initialise();
  for (std::size_t n = 0; n < part.x.size(); ++n) part.v[n].x = -1e5 * part.x[n].x;
  part.step(1e-9);
  const double q = part.get(PartStore::element_state, 0), p = part.pressure(0);
  const double area = size * size;
  // A cube of the size at the end of the step: the faces across y are shorter, those across x are not.
  const int far = part.nodes(0)[6];
  EXPECT_NEAR(part.force(far).x / ((p + q) * area / 4.0), 1.0, 1e-9);
  EXPECT_GT(q, 1e-4 * p);
  EXPECT_NEAR(p / (K * (1.0 / (1.0 - 1e-4) - 1.0)), 1.0, 1e-9);
}

// The kernel keeps its variables by their place. Names in another order would be written over other variables.
TEST(ElementForces, names_of_the_state_stand_where_the_kernel_keeps_them) {
  const auto variables = make_law<Element>("element", "hex8")->state_variables();
  ASSERT_EQ(variables.size(), 16u);
  for (std::size_t i = 0; i < variables.size(); ++i)
    EXPECT_EQ(variables[i].index, static_cast<int>(i)) << variables[i].name;
  EXPECT_EQ(variables[1].name, "hourglass_resistance_1");
  EXPECT_EQ(variables[13].name, "free_share");
  EXPECT_EQ(variables[15].name, "shock_sensor");
}

}  // namespace
