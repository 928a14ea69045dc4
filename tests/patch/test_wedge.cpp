// An element of six nodes on SolidKernel: its forces balance, are those of its volume, and resist its hourglass modes.
// Affine and rigid motion are in test_affine_motion.cpp.
#include <gtest/gtest.h>

#include <random>

#include "mesh/quality.hpp"
#include "mesh/shared_volume.hpp"
#include "support/wedges.hpp"

namespace {

using namespace kerf;
using namespace kerf::test;

constexpr double size = 1e-3, dt = 1e-9;  // [m], [s]
const char* const plain = "{linear_viscosity: 0, quadratic_viscosity: 0, hourglass_coefficient: 0.1}";

CellMesh one_wedge(double distortion, unsigned seed) {
  CellMesh mesh = in_wedges(distorted_element(size, distortion, seed));
  mesh.elements.pop_back();
  return mesh;
}
CellCorners corners_of(const CellMesh& mesh, std::size_t e) {
  CellCorners x;
  for (std::size_t k = 0; k < 6; ++k) x[k] = mesh.x[mesh.elements[e][k]];
  return x;
}
void set_random_velocities(OnePart& part, double speed) {
  std::mt19937 random(5);
  std::uniform_real_distribution<double> component(-speed, speed);
  for (Vec3& v : part.v) v = {component(random), component(random), component(random)};
}

TEST(Wedge, measures_of_its_shape_are_those_of_half_a_cube) {
  const CellMesh mesh = in_wedges(distorted_element(1.0, 0.0, 1));
  const Shape& shape = *mesh.shape;
  const CellCorners a = corners_of(mesh, 0), b = corners_of(mesh, 1);
  for (const CellCorners& x : {a, b}) {
    EXPECT_NEAR(volume_by_faces(shape, x), 0.5, 1e-15);
    EXPECT_NEAR(min_scaled_jacobian(shape, x), std::sqrt(0.5), 1e-15);  // the sine of 45 degrees
    EXPECT_NEAR(longest_edge(shape, x), std::sqrt(2.0), 1e-15);
  }
  CellCorners inside_out = a;
  std::swap_ranges(inside_out.begin(), inside_out.begin() + 3, inside_out.begin() + 3);
  EXPECT_NEAR(volume_by_faces(shape, inside_out), -0.5, 1e-15);
  EXPECT_LT(min_scaled_jacobian(shape, inside_out), 0.0);
  EXPECT_EQ(shape.opposite_face[0], 1);
  EXPECT_EQ(shape.opposite_face[2], -1);
}

TEST(Wedge, shares_no_volume_with_its_other_half_and_half_of_the_cube) {
  const CellMesh cube = distorted_element(1.0, 0.0, 1), mesh = in_wedges(cube);
  const Cell a{mesh.shape, corners_of(mesh, 0)}, b{mesh.shape, corners_of(mesh, 1)};
  Cell whole;
  for (std::size_t k = 0; k < 8; ++k) whole.x[k] = cube.x[cube.elements[0][k]];
  const auto shared = [](const Cell& c, const Cell& d) {
    return shared_volume(c, FacePlanes(c), d, FacePlanes(d), 1e-6).volume;
  };
  EXPECT_EQ(shared(a, b), 0.0);
  // What the tolerance takes off: a millionth of a length times a surface of 3 + sqrt(2).
  EXPECT_NEAR(shared(a, whole), 0.5, 5e-6);
  EXPECT_NEAR(shared(whole, a), 0.5, 5e-6);
  EXPECT_NEAR(shared(a, a), 0.5, 5e-6);
}

TEST(Wedge, forces_add_up_to_nothing_in_integers) {
  for (unsigned seed = 1; seed <= 5; ++seed) {
    OnePart part(one_wedge(0.2, seed), {}, make_wedge(plain));
    part.initialise();
    set_random_velocities(part, 10.0);
    part.step(1e-7);
    for (int d = 0; d < 3; ++d) {
      std::int64_t sum = 0, sizes = 0;
      for (int k = 0; k < 6; ++k) {
        sum += part.quanta(part.nodes(0)[k], d);
        sizes += std::abs(part.quanta(part.nodes(0)[k], d));
      }
      EXPECT_EQ(sum, 0);
      EXPECT_GT(sizes, 0);
    }
  }
}

TEST(Wedge, pressure_pushes_with_the_derivative_of_the_volume) {
  for (unsigned seed = 1; seed <= 5; ++seed) {
    const CellMesh mesh = one_wedge(0.2, seed);
    PartLaws laws;
    laws.compression = 1.01;
    OnePart part(mesh, laws, make_wedge(plain));
    part.initialise();
    const double pressure = part.pressure(0), face = size * size;
    ASSERT_GT(pressure, 1e9);
    for (int k = 0; k < 6; ++k)
      for (int d = 0; d < 3; ++d) {
        // The volume is linear in each coordinate: a central difference is exact to round-off.
        CellMesh plus = mesh, minus = mesh;
        plus.x[mesh.elements[0][k]][d] += 0.25 * size;
        minus.x[mesh.elements[0][k]][d] -= 0.25 * size;
        const double b =
            (volume_by_divergence(plus, mesh.elements[0]) - volume_by_divergence(minus, mesh.elements[0])) /
            (0.5 * size);
        EXPECT_NEAR(part.force(mesh.elements[0][k])[d], pressure * b, 1e-13 * pressure * face);
      }
  }
}

/// Six velocities are neither rigid nor linear: hourglass control takes energy from each, and books it.
TEST(Wedge, hourglass_control_brakes_what_a_linear_field_leaves) {
  constexpr double patterns[2][6] = {{0, -1, 1, 0, 1, -1}, {-2, 1, 1, 2, -1, -1}};
  for (const auto& pattern : patterns)
    for (int d = 0; d < 3; ++d) {
      OnePart part(one_wedge(0.0, 1), {}, make_wedge(plain));
      part.initialise();
      for (int k = 0; k < 6; ++k) part.v[part.nodes(0)[k]][d] = pattern[k];
      part.step(dt);
      double power = 0.0;
      for (int k = 0; k < 6; ++k) power += dot(part.force(part.nodes(0)[k]), part.v[part.nodes(0)[k]]);
      // Without control there would be none but that of the stress of a step, of the order of K (v dt / size)^2 V / dt.
      EXPECT_LT(power, -1e-2);
      // The first half of the work is booked in this step.
      EXPECT_NEAR(part.hourglass_energy() / (-0.5 * power * dt), 1.0, 1e-3);
    }
}

TEST(Wedge, an_inverted_one_is_reported_and_exerts_no_force) {
  OnePart part(one_wedge(0.1, 1), {}, make_wedge(plain));
  part.initialise();
  std::vector<Vec3> target = part.x;
  for (Vec3& p : target) p.z = -p.z;
  part.move_to(target, 1e-7);
  EXPECT_EQ(part.work.inverted_block, 0);
  for (int k = 0; k < 6; ++k) EXPECT_EQ(norm(part.force(part.nodes(0)[k])), 0.0);
}

}  // namespace
