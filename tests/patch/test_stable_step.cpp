// The stable time step against the largest eigenvalue of stiffness over mass, both taken from the element's forces.
#include <gtest/gtest.h>

#include <Eigen/Dense>
#include <algorithm>

#include "support/one_part.hpp"

namespace {

using namespace kerf;
using namespace kerf::test;

constexpr double size = 1e-3;  // [m]

PartLaws laws_of(double poisson, const std::string& element) {
  const double G = 80e9, K = 2.0 / 3.0 * G * (1.0 + poisson) / (1.0 - 2.0 * poisson);
  PartLaws laws;
  laws.strength_parameters = "{shear_modulus: " + std::to_string(G) + "}";
  laws.eos_parameters = "{bulk_modulus: " + std::to_string(K) + "}";
  laws.element = element;
  return laws;
}

/// Largest stable step of central differences for small motion of the mesh: 2 over its highest frequency [s].
double true_limit(const CellMesh& mesh, const PartLaws& laws) {
  // A step that moves one node by 1e-9 of a metre: small against the size, large against the quantum of force.
  const double moved = 1e-9, dt = 1e-9;
  const int n = 3 * static_cast<int>(mesh.x.size());
  Eigen::MatrixXd stiffness(n, n);
  Eigen::VectorXd mass = Eigen::VectorXd::Zero(n);
  for (int column = 0; column < n; ++column) {
    OnePart part(mesh, laws);
    part.initialise();
    part.v[column / 3][column % 3] = moved / dt;
    part.step(dt);
    for (int row = 0; row < n; ++row) stiffness(row, column) = -part.force(row / 3)[row % 3] / moved;
    if (column > 0) continue;
    for (int e = 0; e < part.n_elements(); ++e)
      for (const int node : part.nodes(e))
        for (int d = 0; d < 3; ++d) mass[3 * node + d] += part.element_mass(e) / 8.0;
  }
  const Eigen::VectorXd scale = mass.cwiseSqrt().cwiseInverse();
  const Eigen::MatrixXd dynamic = scale.asDiagonal() * (0.5 * (stiffness + stiffness.transpose())) * scale.asDiagonal();
  const double largest = Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd>(dynamic).eigenvalues().maxCoeff();
  return 2.0 / std::sqrt(largest);
}

double estimate(const CellMesh& mesh, const PartLaws& laws) {
  OnePart part(mesh, laws);
  part.initialise();
  return part.stable_step();
}

std::string no_viscosity(const std::string& rest) {
  return "{linear_viscosity: 0, quadratic_viscosity: 0, " + rest + "}";
}

const std::string bare = no_viscosity("hourglass_coefficient: 0");
const std::string free_element = no_viscosity("hourglass_coefficient: 0, stable_step: free_element");

TEST(StableStep, of_a_free_cube_is_exact) {
  for (const double poisson : {0.0, 0.2, 0.3, 0.45}) {
    const CellMesh cube = distorted_element(size, 0.0, 1);
    // The stiffness is taken with a finite displacement of 1e-6 of the size.
    EXPECT_NEAR(estimate(cube, laws_of(poisson, free_element)) / true_limit(cube, laws_of(poisson, bare)), 1.0, 1e-5)
        << "Poisson's ratio " << poisson;
  }
}

TEST(StableStep, of_a_free_element_is_never_above_the_true_limit) {
  double least = 1e300, most = 0.0;
  for (unsigned seed = 1; seed <= 60; ++seed) {
    CellMesh mesh = distorted_element(size, 0.25, seed);
    const double flatten = seed % 3 == 0 ? 0.2 : 1.0, stretch = seed % 4 == 0 ? 3.0 : 1.0;
    for (Vec3& x : mesh.x) x.z *= flatten, x.y *= stretch;
    const double poisson = 0.15 * (seed % 4);
    const double ratio = estimate(mesh, laws_of(poisson, free_element)) / true_limit(mesh, laws_of(poisson, bare));
    least = std::min(least, ratio);
    most = std::max(most, ratio);
  }
  EXPECT_LE(most, 1.0 + 1e-5);
  EXPECT_GE(least, 0.93);  // how much the bound gives away: measured 0.951 at worst
  RecordProperty("least_ratio", std::to_string(least));
}

TEST(StableStep, of_a_free_element_holds_for_bars_and_sheets_of_one_cell) {
  const int shapes[][3] = {{1, 1, 5}, {3, 3, 1}, {2, 2, 2}, {3, 3, 3}};
  for (const auto& n : shapes)
    for (const double distortion : {0.0, 0.2}) {
      const CellMesh mesh = distorted_block(n[0], n[1], n[2], size, distortion, 3);
      EXPECT_LE(estimate(mesh, laws_of(0.35, free_element)), true_limit(mesh, laws_of(0.35, bare)) * (1.0 + 1e-5));
    }
}

/// The least stable step where each element knows its exposed faces.
double estimate_with_exposure(const CellMesh& mesh, const PartLaws& laws, const std::vector<int>& exposed) {
  OnePart part(mesh, laws);
  std::vector<std::uint8_t> faces(8 * ((exposed.size() + 7) / 8), 0);
  std::copy(exposed.begin(), exposed.end(), faces.begin());
  part.exposed_faces = faces.data();
  part.initialise();
  return part.stable_step();
}

TEST(StableStep, of_exposed_cells_holds_for_free_bodies_of_every_thickness) {
  const int shapes[][3] = {{1, 1, 1}, {1, 1, 2}, {1, 1, 5}, {2, 2, 1}, {4, 3, 1}, {2, 2, 2}, {3, 3, 3}, {2, 2, 4}};
  for (const auto& n : shapes) {
    std::vector<int> exposed;
    for (int i = 0; i < n[0]; ++i)
      for (int j = 0; j < n[1]; ++j)
        for (int k = 0; k < n[2]; ++k)
          exposed.push_back((i == 0) + (i == n[0] - 1) + (j == 0) + (j == n[1] - 1) + (k == 0) + (k == n[2] - 1));
    for (const double poisson : {0.0, 0.3, 0.45, 0.499}) {
      const CellMesh mesh = distorted_block(n[0], n[1], n[2], size, 0.0, 1);
      // The finite displacement that takes the stiffness is 1e-6 of the size.
      EXPECT_LE(estimate_with_exposure(mesh, laws_of(poisson, bare), exposed),
                true_limit(mesh, laws_of(poisson, bare)) * (1.0 + 1e-4))
          << n[0] << " x " << n[1] << " x " << n[2] << " cells, Poisson's ratio " << poisson;
    }
  }
}

TEST(StableStep, of_a_plane_wave_with_defaults_holds_for_bodies_of_several_cells) {
  // Without knowledge of exposed faces, as here, the default safety factor of 0.9 and the default linear viscosity
  // cover what free surfaces take from the plane wave's limit at these ratios; it is exact in an endless mesh of cubes.
  for (const int n : {2, 3})
    for (const double poisson : {0.0, 0.3, 0.4}) {
      const CellMesh mesh = distorted_block(n, n, n, size, 0.0, 1);
      const double step = 0.9 * estimate(mesh, laws_of(poisson, "{}"));
      EXPECT_LE(step, true_limit(mesh, laws_of(poisson, bare))) << n << " cells, Poisson's ratio " << poisson;
    }
  for (unsigned seed = 1; seed <= 3; ++seed) {
    const CellMesh mesh = distorted_block(3, 3, 3, size, 0.2, seed);
    EXPECT_LE(estimate(mesh, laws_of(0.3, "{}")), true_limit(mesh, laws_of(0.3, bare))) << "seed " << seed;
  }
}

TEST(StableStep, of_a_plane_wave_does_not_hold_for_a_cube_that_stands_alone) {
  // Why there are two bounds: a free cube breathes with 3 K, a plane wave moves with K + 4G/3.
  const double poisson = 0.3, G = 80e9, K = 2.0 / 3.0 * G * (1.0 + poisson) / (1.0 - 2.0 * poisson);
  const CellMesh cube = distorted_element(size, 0.0, 1);
  const double ratio = true_limit(cube, laws_of(poisson, bare)) / estimate(cube, laws_of(poisson, bare));
  EXPECT_NEAR(ratio, std::sqrt((K + 4.0 / 3.0 * G) / (3.0 * K)), 1e-5);
}

TEST(StableStep, is_not_lowered_by_stiffness_hourglass_control) {
  for (const double coefficient : {0.05, 0.25}) {
    const std::string control = "hourglass: stiffness, hourglass_coefficient: " + std::to_string(coefficient);
    for (unsigned seed = 1; seed <= 10; ++seed) {
      const CellMesh mesh = distorted_element(size, 0.25, seed);
      const double step = estimate(mesh, laws_of(0.3, no_viscosity(control + ", stable_step: free_element")));
      EXPECT_LE(step, true_limit(mesh, laws_of(0.3, no_viscosity(control))) * (1.0 + 1e-5)) << "seed " << seed;
    }
  }
}

TEST(StableStep, of_the_start_sees_the_viscosity_of_the_initial_velocities) {
  // A cube that closes at v over its edge: nu = b1 c + b2 v. Its nodes move by less than 0.05 of the edge.
  const double G = 80e9, K = 2.0 / 3.0 * G * 1.3 / 0.4, c = std::sqrt((K + 4.0 / 3.0 * G) / 8000.0), v = 0.04 * c;
  OnePart part(distorted_element(size, 0.0, 1), laws_of(0.3, "{}"));
  for (std::size_t n = 0; n < part.x.size(); ++n) part.v[n] = {-v * part.x[n].x / size, 0.0, 0.0};
  part.initialise();
  const double nu = 0.06 * c + 1.5 * v;
  EXPECT_NEAR(part.stable_step() / (size / (nu + std::sqrt(nu * nu + c * c))), 1.0, 1e-12);
}

TEST(StableStep, of_the_start_lets_no_node_cross_a_twentieth_of_a_cell) {
  for (const double speed : {100.0, 1e4, 1e5}) {
    OnePart part(distorted_element(size, 0.2, 1), laws_of(0.3, "{}"));
    const double at_rest = estimate(distorted_element(size, 0.2, 1), laws_of(0.3, "{}"));
    part.v.assign(8, Vec3{0.6 * speed, 0.0, -0.8 * speed});
    part.initialise();
    EXPECT_LE(part.stable_step() * speed, 0.05 * size);
    if (speed < 1e3) {
      EXPECT_NEAR(part.stable_step() / at_rest, 1.0, 1e-12);
    }
  }
}

TEST(StableStep, falls_with_bulk_viscosity) {
  const CellMesh cube = distorted_element(size, 0.0, 1);
  const double b1 = 0.3;
  const double ratio = estimate(cube, laws_of(0.3, "{linear_viscosity: 0.3}")) / estimate(cube, laws_of(0.3, bare));
  EXPECT_NEAR(ratio, std::sqrt(1.0 + b1 * b1) - b1, 1e-12);
}

}  // namespace
