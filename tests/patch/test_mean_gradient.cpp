// Mean gradient and volume of an element against numerical integration of its trilinear shape functions.
#include <gtest/gtest.h>

#include <Eigen/Dense>

#include "support/one_part.hpp"

namespace {

using namespace kerf;
using namespace kerf::test;
using Gradient = Eigen::Matrix<double, 8, 3>;

constexpr double size = 1e-3;  // [m]
constexpr double round_off = 1e-12;

/// Integral of dN/dx over the element with 3 x 3 x 3 Gauss points; two would do for the quadratic integrand.
Gradient integrated_gradient(const std::vector<Vec3>& x) {
  const double point[3] = {-std::sqrt(0.6), 0.0, std::sqrt(0.6)}, weight[3] = {5.0 / 9.0, 8.0 / 9.0, 5.0 / 9.0};
  Eigen::Matrix<double, 8, 3> where;
  for (int n = 0; n < 8; ++n) where.row(n) << x[n].x, x[n].y, x[n].z;
  Gradient sum = Gradient::Zero();
  for (int a = 0; a < 3; ++a)
    for (int b = 0; b < 3; ++b)
      for (int c = 0; c < 3; ++c) {
        Gradient local;
        for (int n = 0; n < 8; ++n) {
          const double p = 1.0 + corner[n][0] * point[a], q = 1.0 + corner[n][1] * point[b],
                       r = 1.0 + corner[n][2] * point[c];
          local.row(n) << corner[n][0] * q * r / 8.0, corner[n][1] * p * r / 8.0, corner[n][2] * p * q / 8.0;
        }
        const Eigen::Matrix3d jacobian = where.transpose() * local;
        sum += local * jacobian.inverse() * (jacobian.determinant() * weight[a] * weight[b] * weight[c]);
      }
  return sum;
}

/// The element's own gradient: under a pressure alone, its forces are p B. Twice the density gives p = K.
Gradient own_gradient(const CellMesh& mesh) {
  PartLaws laws;
  laws.strength = "hydrodynamic";
  laws.strength_parameters = "{}";
  laws.eos_parameters = "{bulk_modulus: 1e12 Pa}";  // forces of 1e6 N, resolved to 1e-16 of that
  laws.compression = 2.0;
  OnePart part(mesh, laws);
  part.initialise();
  part.step(1e-9);  // at rest
  Gradient b;
  std::array<int, 8> at{};
  for (int n = 0; n < 8; ++n) at[n] = part.nodes(0)[n];
  for (int n = 0; n < 8; ++n)
    for (int d = 0; d < 3; ++d) b(n, d) = part.force(at[n])[d] / 1e12;
  return b;
}

std::vector<Vec3> corners_of(const CellMesh& mesh) {
  std::vector<Vec3> x;
  for (const int n : mesh.elements[0]) x.push_back(mesh.x[n] - mesh.x[mesh.elements[0][0]]);
  return x;
}

TEST(MeanGradient, equals_the_integral_of_the_shape_functions_gradient) {
  for (unsigned seed = 1; seed <= 100; ++seed) {
    const CellMesh mesh = distorted_element(size, 0.3, seed);
    const Gradient difference = own_gradient(mesh) - integrated_gradient(corners_of(mesh));
    EXPECT_LT(difference.cwiseAbs().maxCoeff(), round_off * size * size) << "seed " << seed;
  }
}

TEST(MeanGradient, is_exact_for_the_flux_through_warped_faces) {
  // sum_I x_iI B_jI = V delta_ij: the gradient of a linear field is right in any element.
  for (unsigned seed = 1; seed <= 20; ++seed) {
    const CellMesh mesh = distorted_element(size, 0.3, seed);
    const Gradient b = own_gradient(mesh);
    const std::vector<Vec3> x = corners_of(mesh);
    const double volume = volume_by_divergence(mesh, mesh.elements[0]);
    for (int i = 0; i < 3; ++i)
      for (int j = 0; j < 3; ++j) {
        double sum = 0.0;
        for (int n = 0; n < 8; ++n) sum += x[n][i] * b(n, j);
        EXPECT_NEAR(sum / volume, i == j ? 1.0 : 0.0, round_off);
      }
  }
}

TEST(Volume, equals_the_integral_over_the_surface) {
  for (unsigned seed = 1; seed <= 100; ++seed) {
    const CellMesh mesh = distorted_element(size, 0.3, seed);
    OnePart part(mesh);
    part.initialise();
    EXPECT_NEAR(part.get(PartStore::volume, 0) / volume_by_divergence(mesh, mesh.elements[0]), 1.0, round_off);
  }
}

TEST(Volume, of_a_neighbourhood_adds_up_to_that_of_the_block) {
  // Inner nodes are moved, the block's surface is not: warped faces leave no gap and no overlap.
  CellMesh mesh = distorted_block(3, 3, 3, size, 0.0, 1);
  const CellMesh moved = distorted_block(3, 3, 3, size, 0.3, 2);
  for (int n = 0; n < 64; ++n)
    if (n / 16 % 3 != 0 && n / 4 % 4 % 3 != 0 && n % 4 % 3 != 0) mesh.x[n] = moved.x[n];
  OnePart part(mesh);
  part.initialise();
  double sum = 0.0;
  for (int e = 0; e < part.n_elements(); ++e) sum += part.get(PartStore::volume, e);
  EXPECT_NEAR(sum / (27.0 * size * size * size), 1.0, round_off);
}

TEST(Volume, of_an_inverted_element_is_reported_and_exerts_no_force) {
  PartLaws laws;
  OnePart part(distorted_element(size, 0.1, 3), laws);
  part.initialise();
  EXPECT_EQ(part.work.inverted_block, -1);
  std::vector<Vec3> mirrored = part.x;
  for (Vec3& p : mirrored) p.x = -p.x;
  part.move_to(mirrored, 1e-7);
  EXPECT_EQ(part.work.inverted_block, 0);
  for (int n = 0; n < 8; ++n)
    for (int d = 0; d < 3; ++d) EXPECT_EQ(part.quanta(n, d), 0);
}

}  // namespace
