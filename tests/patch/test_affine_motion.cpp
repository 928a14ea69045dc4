// The patch test: affine motion of a distorted mesh gives every element the same, right stress, and no force on
// inner nodes; rigid motion gives none and turns the stress that is there.
#include <gtest/gtest.h>

#include <Eigen/Dense>
#include <cmath>

#include "support/one_part.hpp"
#include "support/wedges.hpp"

namespace {

using namespace kerf;
using namespace kerf::test;
using Matrix = Eigen::Matrix3d;

constexpr double G = 80e9, K = 160e9, rho = 8000.0;  // of PartLaws [Pa], [kg/m3]
constexpr double size = 1e-3, dt = 1e-7;  // [m], [s]
constexpr double round_off = 1e-12;  // a few hundred operations in double precision

// Bulk viscosity depends on the element's size, so it is no part of a uniform field.
const char* const viscous = "{linear_viscosity: 0, quadratic_viscosity: 0, hourglass_coefficient: 0.1}";
const char* const stiffness =
    "{linear_viscosity: 0, quadratic_viscosity: 0, hourglass: stiffness, hourglass_coefficient: 0.1}";

const char* const wedge = "an element of another shape, with the parameters of the viscous one";

Vec3 operator*(const Matrix& m, Vec3 a) {
  const Eigen::Vector3d r = m * Eigen::Vector3d(a.x, a.y, a.z);
  return {r[0], r[1], r[2]};
}
Matrix full(SymTensor t) {
  Matrix m;
  m << t.xx, t.xy, t.zx, t.xy, t.yy, t.yz, t.zx, t.yz, t.zz;
  return m;
}
double largest(const Matrix& m) { return m.cwiseAbs().maxCoeff(); }

OnePart part_of(const CellMesh& mesh, const char* element) {
  PartLaws laws;
  laws.element = element;
  OnePart part = element == wedge ? OnePart(in_wedges(mesh), laws, make_wedge(viscous)) : OnePart(mesh, laws);
  part.initialise();
  return part;
}

std::vector<Vec3> mapped(const std::vector<Vec3>& x, const Matrix& f, Vec3 shift) {
  std::vector<Vec3> y;
  for (const Vec3& p : x) y.push_back(f * p + shift);
  return y;
}

/// Stress of a linear hypoelastic solid after one step with the deformation gradient f.
Matrix stress_after(const Matrix& f) {
  const Matrix one = Matrix::Identity();
  const Matrix g = one - f.inverse();  // with respect to the end of the step
  const Matrix h = g * (one - 0.5 * g).inverse();
  const Matrix middle = 0.5 * (h + h.transpose()), spin = 0.5 * (h - h.transpose());
  const Matrix strain =
      middle + 0.5 * (spin * middle - middle * spin);  // turned from the middle of the step to its end
  const double p = K * (1.0 / f.determinant() - 1.0);
  return 2.0 * G * (strain - one * (strain.trace() / 3.0)) - p * one;
}

const Matrix stretched = (Matrix() << 1.10, 0.07, -0.03, 0.02, 0.96, 0.05, -0.04, 0.03, 1.05).finished();

void expect_uniform_stress(const Matrix& f, Vec3 shift, const char* element, double tolerance) {
  for (unsigned seed = 1; seed <= 5; ++seed) {
    OnePart part = part_of(distorted_block(3, 3, 3, size, 0.2, seed), element);
    part.move_to(mapped(part.x, f, shift), dt);
    const Matrix expected = stress_after(f);
    for (int e = 0; e < part.n_elements(); ++e)
      EXPECT_LT(largest(full(part.stress(e)) - expected), tolerance * largest(expected)) << "element " << e;
    // Inner nodes are in balance. A node of 3 x 3 x 3 cells is inner where none of its three indices is 0 or 3.
    for (int n = 0; n < 64; ++n) {
      const int index[3] = {n / 16, n / 4 % 4, n % 4};
      if (index[0] % 3 == 0 || index[1] % 3 == 0 || index[2] % 3 == 0) continue;
      EXPECT_LT(norm(part.force(n)), 10.0 * tolerance * largest(expected) * size * size) << "node " << n;
    }
  }
}

TEST(AffineMotion, gives_uniform_stress) {
  expect_uniform_stress(stretched, {}, viscous, round_off);
  expect_uniform_stress(stretched, {}, stiffness, round_off);
  expect_uniform_stress(stretched, {}, wedge, round_off);
}

TEST(AffineMotion, gives_the_same_stress_under_translation) {
  expect_uniform_stress(stretched, Vec3{3.0, -2.0, 1.0} * size, viscous, round_off);
}

TEST(AffineMotion, far_from_the_origin_loses_only_the_digits_of_the_coordinates) {
  // At a thousand element sizes a coordinate is rounded by 1.1e-13 of the element's size; the strain is about 0.1.
  expect_uniform_stress(stretched, Vec3{1000.0, -500.0, 700.0} * size, viscous, 1e-11);
}

TEST(AffineMotion, of_small_strain_is_linear_elasticity) {
  const Matrix gradient = 1e-7 * (Matrix() << 1.0, 0.5, -0.3, 0.2, -0.6, 0.4, -0.7, 0.1, 0.8).finished();
  const Matrix f = Matrix::Identity() + gradient, strain = 0.5 * (gradient + gradient.transpose());
  const Matrix expected =
      2.0 * G * (strain - Matrix::Identity() * (strain.trace() / 3.0)) + K * strain.trace() * Matrix::Identity();
  OnePart part = part_of(distorted_block(3, 3, 3, size, 0.2, 1), viscous);
  part.move_to(mapped(part.x, f, {}), dt);
  // The strain is known to round-off of the coordinates over 1e-7, and to second order in 1e-7.
  for (int e = 0; e < part.n_elements(); ++e)
    EXPECT_LT(largest(full(part.stress(e)) - expected), 1e-6 * largest(expected));
}

TEST(AffineMotion, has_the_internal_energy_of_its_stress) {
  // Uniaxial strain in small steps: E = (K + 4G/3)/2 ln(V)^2 to the order of strain cubed.
  OnePart part = part_of(distorted_block(2, 2, 2, size, 0.2, 3), viscous);
  const double volume = part.get(PartStore::volume, 0), strain = 1e-4;
  const Matrix f = Eigen::Vector3d(1.0 - strain / 100.0, 1.0, 1.0).asDiagonal();
  for (int i = 0; i < 100; ++i) part.move_to(mapped(part.x, f, {}), dt);
  EXPECT_NEAR(part.get(PartStore::internal_energy, 0) / (0.5 * (K + 4.0 / 3.0 * G) * strain * strain * volume), 1.0,
              3.0 * strain);
}

/// Turns a stressed mesh by `angle` in `n` steps and compares with the stress turned exactly.
void expect_turned_stress(double angle, int n, double tolerance) {
  const Eigen::Vector3d axis = Eigen::Vector3d(0.3, -0.5, 0.8).normalized();
  const Matrix step = Eigen::AngleAxisd(angle / n, axis).toRotationMatrix();
  const Matrix whole = Eigen::AngleAxisd(angle, axis).toRotationMatrix();
  const SymTensor s{300e6, -100e6, -200e6, 150e6, -50e6, 250e6};
  for (const char* element : {viscous, stiffness, wedge}) {
    OnePart part = part_of(distorted_block(3, 2, 2, size, 0.2, 7), element);
    for (int e = 0; e < part.n_elements(); ++e) part.set_deviator(e, s);
    const std::vector<Vec3> start = part.x;
    Matrix so_far = Matrix::Identity();
    for (int i = 0; i < n; ++i) {
      so_far = step * so_far;
      part.move_to(mapped(start, so_far, {}), dt);
    }
    const Matrix expected = whole * full(s) * whole.transpose();
    for (int e = 0; e < part.n_elements(); ++e) {
      EXPECT_LT(largest(full(part.deviator(e)) - expected), tolerance * largest(expected)) << n << " steps";
      EXPECT_LT(std::fabs(part.pressure(e)), tolerance * K);
    }
  }
}

TEST(RigidRotation, turns_the_stress_exactly_in_large_steps) { expect_turned_stress(1.0, 10, 1e-12); }
TEST(RigidRotation, turns_the_stress_exactly_in_one_step_of_a_radian) { expect_turned_stress(1.0, 1, 1e-12); }
// A thousand steps each add the round-off of coordinates of a few 1e-16 times G/s, some 300; it adds up as a walk.
TEST(RigidRotation, turns_the_stress_exactly_in_small_steps) { expect_turned_stress(1.0, 1000, 1e-10); }

TEST(RigidRotation, gives_no_stress_to_a_body_without_stress) {
  for (const char* element : {viscous, wedge})
    for (const int n : {10, 1000}) {
      OnePart part = part_of(distorted_block(3, 2, 2, size, 0.2, 5), element);
      const Matrix step = Eigen::AngleAxisd(1.0 / n, Eigen::Vector3d(1, 2, -1).normalized()).toRotationMatrix();
      for (int i = 0; i < n; ++i) part.move_to(mapped(part.x, step, {}), dt);
      for (int e = 0; e < part.n_elements(); ++e)
        EXPECT_LT(largest(full(part.stress(e))), 1e-15 * n * 10.0 * K) << n << " steps";  // round-off of n steps
    }
}

TEST(RigidRotation, exerts_no_hourglass_force) {
  for (const char* element : {viscous, stiffness, wedge}) {
    OnePart part = part_of(distorted_block(2, 2, 2, size, 0.25, 5), element);
    const Matrix step = Eigen::AngleAxisd(0.1, Eigen::Vector3d(1, 2, -1).normalized()).toRotationMatrix();
    part.move_to(mapped(part.x, step, Vec3{1, 1, 1} * size), dt);
    for (std::size_t n = 0; n < part.x.size(); ++n)
      EXPECT_LT(norm(part.force(static_cast<int>(n))), 1e-13 * K * size * size);
    EXPECT_LT(std::fabs(part.hourglass_energy()), 1e-20 * K * size * size * size);
  }
}

}  // namespace
