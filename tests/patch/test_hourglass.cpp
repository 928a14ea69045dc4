// Hourglass modes: no stress, but a force that opposes them and does nothing to rigid and linear motion.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <random>

#include "support/one_part.hpp"

namespace {

using namespace kerf;
using namespace kerf::test;

constexpr double size = 1e-3, dt = 1e-8;  // [m], [s]
constexpr double K = 160e9, G = 80e9, rho = 8000.0;
const double c = std::sqrt((K + 4.0 / 3.0 * G) / rho);  // [m/s]

/// The four patterns of signs that have no mean gradient in a cube.
double pattern(int mode, int node) {
  const int* s = corner[node];
  const int products[4] = {s[1] * s[2], s[0] * s[2], s[0] * s[1], s[0] * s[1] * s[2]};
  return products[mode];
}

PartLaws laws_with(const std::string& hourglass, double coefficient) {
  PartLaws laws;
  laws.element = "{hourglass: " + hourglass + ", hourglass_coefficient: " + std::to_string(coefficient) + "}";
  return laws;
}

/// Mean gradient dN/dx, from central differences of the volume, which is linear in every single coordinate.
std::vector<Vec3> gradient_by_volume(const CellMesh& mesh) {
  std::vector<Vec3> b(8);
  for (int n = 0; n < 8; ++n)
    for (int d = 0; d < 3; ++d) {
      CellMesh plus = mesh, minus = mesh;
      plus.x[mesh.elements[0][n]][d] += 0.25 * size;
      minus.x[mesh.elements[0][n]][d] -= 0.25 * size;
      b[n][d] =
          (volume_by_divergence(plus, mesh.elements[0]) - volume_by_divergence(minus, mesh.elements[0])) / (0.5 * size);
    }
  return b;
}

/// A velocity along `direction` in the pattern of a mode, with the linear part taken out that a distorted element
/// sees in it.
std::vector<Vec3> hourglass_velocity(const CellMesh& mesh, int mode, int direction, double speed) {
  const auto& element = mesh.elements[0];
  const std::vector<Vec3> b = gradient_by_volume(mesh);
  const double volume = volume_by_divergence(mesh, element);
  Vec3 slope;
  for (int n = 0; n < 8; ++n) slope = slope + b[n] * (pattern(mode, n) / volume);
  std::vector<Vec3> v(8);
  for (int n = 0; n < 8; ++n) {
    const Vec3 x = mesh.x[element[n]] - mesh.x[element[0]];
    v[element[n]][direction] = speed * (pattern(mode, n) - dot(slope, x));
  }
  return v;
}

/// An element at rest at the end of a step in which it moved in one hourglass mode.
OnePart moved_in_mode(const CellMesh& end, const PartLaws& laws, int mode, int direction, double speed) {
  CellMesh start = end;
  const std::vector<Vec3> v = hourglass_velocity(end, mode, direction, speed);
  for (int n = 0; n < 8; ++n) start.x[n] = end.x[n] - v[n] * dt;
  OnePart part(start, laws);
  part.initialise();
  part.v = v;
  part.step(dt);
  return part;
}

double power(const OnePart& part) {
  double sum = 0.0;
  for (int n = 0; n < 8; ++n) sum += dot(part.force(n), part.v[n]);
  return sum;
}

TEST(Hourglass, modes_give_no_stress) {
  for (const char* kind : {"viscous", "stiffness"})
    for (int mode = 0; mode < 4; ++mode)
      for (int direction = 0; direction < 3; ++direction) {
        // A tenth of the element's size in one step.
        const OnePart part =
            moved_in_mode(distorted_element(size, 0.2, 11), laws_with(kind, 0.1), mode, direction, 0.1 * size / dt);
        const SymTensor s = part.stress(0);
        EXPECT_LT(std::sqrt(double_dot(s, s)), 1e-12 * K) << kind << " mode " << mode << " along " << direction;
      }
}

TEST(Hourglass, force_opposes_every_mode) {
  for (const char* kind : {"viscous", "stiffness"})
    for (int mode = 0; mode < 4; ++mode)
      for (int direction = 0; direction < 3; ++direction) {
        const OnePart part =
            moved_in_mode(distorted_element(size, 0.2, 12), laws_with(kind, 0.1), mode, direction, 1.0);
        EXPECT_LT(power(part), 0.0) << kind << " mode " << mode << " along " << direction;
        EXPECT_GT(part.hourglass_energy(), 0.0);
      }
}

TEST(Hourglass, viscous_force_in_a_cube_is_the_formula) {
  // Q = kappa/4 rho c A g, g = 8 v; the force on a node is Q times the pattern.
  const double kappa = 0.08, speed = 1.0;
  const OnePart part = moved_in_mode(distorted_element(size, 0.0, 1), laws_with("viscous", kappa), 2, 1, speed);
  const double expected = 0.25 * kappa * rho * c * size * size * 8.0 * speed;
  for (int n = 0; n < 8; ++n) {
    const int node = part.nodes(0)[n];
    EXPECT_NEAR(part.force(node).y, -expected * pattern(2, n), 1e-5 * expected);  // moved by 1e-5 of its size
    EXPECT_LT(std::fabs(part.force(node).x), 1e-5 * expected);
  }
}

TEST(Hourglass, viscous_force_vanishes_with_the_velocity) {
  OnePart part = moved_in_mode(distorted_element(size, 0.2, 1), laws_with("viscous", 0.1), 0, 0, 10.0);
  part.v.assign(8, Vec3{});
  part.step(dt);
  for (int n = 0; n < 8; ++n) EXPECT_LT(norm(part.force(n)), 1e-12 * K * size * size);
}

TEST(Hourglass, stiffness_force_stays_and_returns_its_energy) {
  OnePart part = moved_in_mode(distorted_element(size, 0.0, 1), laws_with("stiffness", 0.1), 0, 0, 10.0);
  const double stored = part.hourglass_energy();
  const std::vector<Vec3> v = part.v;
  part.v.assign(8, Vec3{});
  part.step(dt);
  double restoring = 0.0;
  for (int n = 0; n < 8; ++n) restoring += dot(part.force(n), v[n]);
  EXPECT_LT(restoring, 0.0);
  EXPECT_EQ(part.hourglass_energy(), 0.0);
  for (int n = 0; n < 8; ++n) part.v[n] = -v[n];
  part.step(dt);
  EXPECT_NEAR(part.hourglass_energy() / stored, -1.0, 1e-6);
  for (int n = 0; n < 8; ++n) EXPECT_LT(norm(part.force(n)), 1e-6 * K * size * size * 1e-4);
}

TEST(Hourglass, viscous_control_books_what_the_motion_loses) {
  // A free cube whose nodes carry an eighth of its mass each, released in an hourglass mode: the motion dies within
  // some steps, and its whole energy must be in the account, however much of it every single step takes.
  for (const double coefficient : {0.02, 0.05, 0.1}) {
    const CellMesh mesh = distorted_element(size, 0.0, 1);
    OnePart part(mesh, laws_with("viscous", coefficient));
    part.initialise();
    part.v = hourglass_velocity(mesh, 0, 0, 0.1);
    const double mass = part.element_mass(0) / 8.0, step = 0.5 * size / c;
    const auto kinetic = [&] {
      double sum = 0.0;
      for (const Vec3& v : part.v) sum += 0.5 * mass * dot(v, v);
      return sum;
    };
    const double start = kinetic();
    double booked = 0.0;
    for (int i = 0; i < 200; ++i) {
      part.step(step);
      booked += part.hourglass_energy();
      for (int n = 0; n < 8; ++n) part.v[n] = part.v[n] + part.force(n) * (step / mass);
    }
    // The displacement is 1e-4 of the size: the modes are orthogonal to strain to that order.
    EXPECT_NEAR((booked + kinetic()) / start, 1.0, 1e-3) << "coefficient " << coefficient;
    EXPECT_LT(kinetic(), 0.01 * start);
  }
}

/// Largest share of an hourglass motion that the force takes from it in a step of the default length: with f = -C v and
/// C symmetric, |f|^2 / (-f . v) is at most C's largest eigenvalue.
double largest_share(const CellMesh& mesh, const PartLaws& laws) {
  OnePart probe(mesh, laws);
  probe.initialise();
  const double step = 0.9 * probe.stable_step(), mass = probe.element_mass(0) / 8.0;
  double largest = 0.0;
  std::mt19937 random(1);
  std::uniform_real_distribution<double> any(-1.0, 1.0);
  for (int trial = 0; trial < 40; ++trial) {
    std::vector<Vec3> v(8);
    for (int mode = 0; mode < 4; ++mode) {
      const std::vector<Vec3> add = hourglass_velocity(mesh, mode, 0, any(random));
      for (int n = 0; n < 8; ++n) v[n] = v[n] + add[n];
    }
    OnePart part(mesh, laws);
    part.initialise();
    for (int n = 0; n < 8; ++n) part.x[n] = mesh.x[n] - v[n] * step;
    part.v = v;
    part.step(step);
    double square = 0.0;
    for (int n = 0; n < 8; ++n) square += dot(part.force(n), part.force(n));
    largest = std::max(largest, step / mass * square / -power(part));
  }
  return largest;
}

/// A cube whose upper face is shrunk to `x` by `y` of its size.
CellMesh tapered(double x, double y) {
  CellMesh mesh = distorted_element(size, 0.0, 1);
  for (Vec3& p : mesh.x)
    if (p.z > 0.5 * size) p = {0.5 * size + x * (p.x - 0.5 * size), 0.5 * size + y * (p.y - 0.5 * size), p.z};
  return mesh;
}

TEST(Hourglass, force_is_bounded_in_every_shape) {
  // Twice the motion would be the limit of stability. Shapes are those of cells that flow: pinched, sheared, flattened.
  std::vector<CellMesh> shapes;
  for (const double x : {1.0, 0.6, 0.3, 0.1})
    for (const double y : {1.0, 0.3})
      for (const double flatten : {1.0, 0.2, 5.0}) {
        shapes.push_back(tapered(x, y));
        for (Vec3& p : shapes.back().x) p.z *= flatten;
      }
  for (unsigned seed = 1; seed <= 30; ++seed) shapes.push_back(distorted_element(size, 0.3, seed));
  for (const double coefficient : {0.05, 0.15})
    for (const CellMesh& mesh : shapes) {
      // 1e-3: the shape at the step's end is the one that is measured, and it carries no stress but round-off.
      EXPECT_LE(largest_share(mesh, laws_with("viscous", coefficient)), 1.001) << "coefficient " << coefficient;
      // Four would be the limit of stability of a force that grows with the displacement.
      EXPECT_LE(largest_share(mesh, laws_with("stiffness", 3 * coefficient)), 2.002) << "coefficient " << coefficient;
    }
}

TEST(Hourglass, viscous_force_is_the_formula_wherever_it_is_harmless) {
  // The bound of the force must not weaken the control of cells in fair shape at the default coefficient: a cube's
  // share is 64 kappa/4 dt c / size, 0.8 times the safety factor and the bulk viscosity's share of the step.
  EXPECT_NEAR(largest_share(tapered(1.0, 1.0), laws_with("viscous", 0.05)),
              0.8 * 0.9 * (std::sqrt(1.0 + 0.06 * 0.06) - 0.06), 1e-6);
}

/// Force in an hourglass mode of a cube that shears at the same time by `strain` in a step.
double force_while_sheared(const PartLaws& laws, double strain) {
  const CellMesh mesh = distorted_element(size, 0.0, 1);
  OnePart part(mesh, laws);
  part.initialise();
  const std::vector<Vec3> v = hourglass_velocity(mesh, 3, 2, 1.0);
  for (int n = 0; n < 8; ++n) part.v[n] = v[n] + Vec3{mesh.x[n].y * strain / dt, 0.0, 0.0};
  part.step(dt);
  double along = 0.0;
  for (int n = 0; n < 8; ++n) along += part.force(n).z * v[n].z;
  return -along;
}

TEST(Hourglass, stiffness_force_grows_as_little_as_the_stress_of_a_body_that_flows) {
  PartLaws laws = laws_with("stiffness", 0.1);
  laws.strength = "elastic_plastic";
  laws.strength_parameters = "{shear_modulus: 80 GPa, yield_stress: 100 MPa, hardening_modulus: 0}";
  const double elastic = force_while_sheared(laws, 1e-4);
  // Pure shear flows at 1/sqrt(3) of the yield stress.
  const double at_yield = 100e6 / std::sqrt(3.0) / 80e9;
  for (const double strain : {0.002, 0.02})
    EXPECT_NEAR(force_while_sheared(laws, strain) / elastic, at_yield / strain, 0.02 * at_yield / strain);
  // A fluid has no shape to hold: it is resisted as by viscous control.
  laws.strength = "hydrodynamic";
  laws.strength_parameters = "{}";
  const double in_fluid = force_while_sheared(laws, 0.002);
  laws.element = laws_with("viscous", 0.1).element;
  EXPECT_NEAR(in_fluid / force_while_sheared(laws, 0.002), 1.0, 1e-12);
}

TEST(Hourglass, stiffness_force_turns_with_the_element) {
  OnePart part = moved_in_mode(distorted_element(size, 0.0, 1), laws_with("stiffness", 0.1), 1, 2, 10.0);
  std::vector<Vec3> before(8), turned(8);
  for (int n = 0; n < 8; ++n) before[n] = part.force(n);
  const double angle = 0.5, cs = std::cos(angle), sn = std::sin(angle);
  for (int n = 0; n < 8; ++n)
    turned[n] = {cs * part.x[n].x - sn * part.x[n].y, sn * part.x[n].x + cs * part.x[n].y, part.x[n].z};
  part.move_to(turned, dt);
  const Vec3 f = before[3];
  const double scale = norm(f);
  for (int n = 0; n < 8; ++n) {
    const Vec3 expected{cs * before[n].x - sn * before[n].y, sn * before[n].x + cs * before[n].y, before[n].z};
    EXPECT_LT(norm(part.force(n) - expected), 1e-8 * scale);
  }
}

TEST(Hourglass, stiffness_force_of_a_turning_mode_turns_with_it) {
  // A mode that grows along an axis of a body that turns by 0.2 in a step: the resistance at the end of the step lies
  // along the axis as it is then.
  const double angle = 0.2, cs = std::cos(angle), sn = std::sin(angle), moved = 1e-4 * size;
  const CellMesh cube = distorted_element(size, 0.0, 1);
  OnePart part(cube, laws_with("stiffness", 0.1));
  part.initialise();
  std::vector<Vec3> target(8);
  for (int n = 0; n < 8; ++n) {
    const Vec3 p = cube.x[part.nodes(0)[n]] + Vec3{moved * pattern(1, n), 0.0, 0.0};
    target[part.nodes(0)[n]] = {cs * p.x - sn * p.y, sn * p.x + cs * p.y, p.z};
  }
  part.move_to(target, dt);
  for (int n = 0; n < 8; ++n) {
    const Vec3 f = part.force(n);
    const double along = cs * f.x + sn * f.y, across = -sn * f.x + cs * f.y;
    // The strain of the mode, of second order, is a hundredth; a rate that is not turned is off by a fifth.
    EXPECT_LT(std::fabs(across), 0.01 * std::fabs(along));
  }
}

TEST(Hourglass, forces_are_orthogonal_to_rigid_and_linear_motion) {
  // With a zero mean gradient there is no stress, and every force is the hourglass control's: their sum and all
  // their first moments must vanish.
  for (const char* kind : {"viscous", "stiffness"})
    for (unsigned seed = 1; seed <= 10; ++seed) {
      const CellMesh mesh = distorted_element(size, 0.25, seed);
      std::vector<Vec3> v(8);
      std::mt19937 random(seed);
      std::uniform_real_distribution<double> any(-100.0, 100.0);
      for (int mode = 0; mode < 4; ++mode) {
        const int direction = mode % 3;  // more than one direction at once would change the volume
        const std::vector<Vec3> add = hourglass_velocity(mesh, mode, direction, any(random));
        for (int n = 0; n < 8; ++n) v[n] = v[n] + add[n];
      }
      PartLaws laws = laws_with(kind, 0.1);
      laws.eos_parameters = "{bulk_modulus: 1 Pa}";  // the change of volume is of second order: no pressure from it
      laws.element.insert(1, "linear_viscosity: 0, quadratic_viscosity: 0, ");
      CellMesh start = mesh;
      for (int n = 0; n < 8; ++n) start.x[n] = mesh.x[n] - v[n] * dt;
      OnePart part(start, laws);
      part.initialise();
      part.v = v;
      part.step(dt);
      double largest = 0.0;
      for (int n = 0; n < 8; ++n) largest = max_of(largest, norm(part.force(n)));
      ASSERT_GT(largest, 1e-3);
      for (int i = 0; i < 3; ++i) {
        std::int64_t sum = 0;
        for (int n = 0; n < 8; ++n) sum += part.quanta(n, i);
        EXPECT_EQ(sum, 0);
        for (int j = 0; j < 3; ++j) {
          double moment = 0.0;
          for (int n = 0; n < 8; ++n) moment += part.force(n)[i] * part.x[n][j];
          // Round-off of the stress that is not there, and half a quantum for each of seven nodes and seven of the
          // last.
          EXPECT_LT(std::fabs(moment), 1e-11 * largest * size + 7.0 * OnePart::quantum * 1.5 * size)
              << kind << " seed " << seed;
        }
      }
    }
}

TEST(Hourglass, linear_velocity_exerts_no_force) {
  PartLaws laws = laws_with("viscous", 0.15);
  laws.strength = "hydrodynamic";
  laws.strength_parameters = "{}";
  laws.eos_parameters = "{bulk_modulus: 1 Pa}";
  laws.element.insert(1, "linear_viscosity: 0, quadratic_viscosity: 0, ");
  OnePart part(distorted_element(size, 0.3, 4), laws);
  part.initialise();
  for (int n = 0; n < 8; ++n) {
    const Vec3 x = part.x[n] * (1.0 / size);
    part.v[n] = {100.0 + 3.0 * x.x - x.y, 2.0 * x.z + x.y, x.x - x.z};
  }
  part.step(dt);
  // What the bulk modulus of a pascal can give is 1e-6 N; the control's coefficient makes 1e-5 N of 1e-3 m/s.
  for (int n = 0; n < 8; ++n) EXPECT_LT(norm(part.force(n)), 1e-8);
}

}  // namespace
