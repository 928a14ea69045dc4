// Wedges, pyramids and tetrahedra as hex8 elements with corners that coincide: volumes, masses, the patch test in a
// mesh of all kinds, rigid motion, forces and the stable step.
#include <gtest/gtest.h>

#include <Eigen/Dense>
#include <algorithm>
#include <random>

#include "mesh/quality.hpp"
#include "support/mixed_cells.hpp"

namespace {

using namespace kerf;
using namespace kerf::test;
using Matrix = Eigen::Matrix3d;

constexpr double G = 80e9, K = 160e9, rho = 8000.0;  // of PartLaws [Pa], [kg/m3]
constexpr double size = 1e-3, dt = 1e-7;  // [m], [s]
const char* const viscous =
    "{linear_viscosity: 0, quadratic_viscosity: 0, hourglass: viscous, "
    "hourglass_coefficient: 0.1}";
const char* const stiffness = "{linear_viscosity: 0, quadratic_viscosity: 0, hourglass_coefficient: 0.1}";

CellMesh mixed(double distortion, unsigned seed) {
  return CutBlock(distorted_block(3, 3, 3, size, distortion, seed), 3, 3, 3, all_cuts).mesh();
}

CellKind kind_of(const CellMesh& mesh, std::size_t e) { return kind_of_cell(mesh.elements[e]); }

/// The first cell of a kind, alone.
CellMesh one_of(CellKind kind, double distortion, unsigned seed) {
  CellMesh mesh = mixed(distortion, seed);
  for (std::size_t e = 0; e < mesh.elements.size(); ++e)
    if (kind_of(mesh, e) == kind) {
      CellMesh one{{}, {{}}, mesh.shape};
      std::vector<std::int32_t> number(mesh.x.size(), -1);
      for (std::size_t k = 0; k < 8; ++k) {
        std::int32_t& n = number[static_cast<std::size_t>(mesh.elements[e][k])];
        if (n < 0) {
          n = static_cast<std::int32_t>(one.x.size());
          one.x.push_back(mesh.x[static_cast<std::size_t>(mesh.elements[e][k])]);
        }
        one.elements[0][k] = n;
      }
      return one;
    }
  ADD_FAILURE() << "no cell of this kind";
  return mesh;
}

constexpr CellKind collapsed_kinds[] = {CellKind::wedge, CellKind::pyramid, CellKind::tetrahedron};

std::vector<Vec3> mapped(const std::vector<Vec3>& x, const Matrix& f, Vec3 shift) {
  std::vector<Vec3> y;
  for (const Vec3& p : x) {
    const Eigen::Vector3d r = f * Eigen::Vector3d(p.x, p.y, p.z);
    y.push_back(Vec3{r[0], r[1], r[2]} + shift);
  }
  return y;
}
Matrix full(SymTensor t) {
  Matrix m;
  m << t.xx, t.xy, t.zx, t.xy, t.yy, t.yz, t.zx, t.yz, t.zz;
  return m;
}
double largest(const Matrix& m) { return m.cwiseAbs().maxCoeff(); }

template <class Part>
Part part_of(const CellMesh& mesh, const char* element) {
  PartLaws laws;
  laws.element = element;
  Part part(mesh, laws);
  part.initialise();
  return part;
}

/// Tips, and corners of bricks that do not lie on the surface of the block.
bool is_inner(int node) {
  if (node >= 64) return true;
  const int index[3] = {node / 16, node / 4 % 4, node % 4};
  return index[0] % 3 != 0 && index[1] % 3 != 0 && index[2] % 3 != 0;
}

TEST(CollapsedCells, are_found_however_the_hexahedron_is_turned) {
  using Nodes = std::array<int, 8>;
  const std::pair<Nodes, CellKind> forms[] = {{{0, 1, 2, 3, 4, 5, 6, 7}, CellKind::hexahedron},
                                              {{0, 1, 2, 2, 3, 4, 5, 5}, CellKind::wedge},
                                              {{0, 1, 2, 3, 4, 4, 4, 4}, CellKind::pyramid},
                                              {{0, 1, 2, 2, 3, 3, 3, 3}, CellKind::tetrahedron},
                                              {{0, 1, 2, 3, 3, 3, 3, 3}, CellKind::tetrahedron}};
  for (const auto& [form, kind] : forms)
    for (const auto& order : collapsed::rotations) {
      Nodes turned{};
      for (std::size_t k = 0; k < 8; ++k) turned[k] = form[order[k]];
      EXPECT_EQ(kind_of_cell(in_order_of_kind(turned)), kind);
    }
  // One edge, a corner of three edges, two edges that are not opposite in a face, and a line.
  for (const Nodes& other :
       {Nodes{0, 1, 2, 2, 4, 5, 6, 7}, Nodes{0, 0, 2, 0, 0, 5, 6, 7}, Nodes{0, 0, 2, 3, 4, 5, 6, 6},
        Nodes{0, 1, 0, 1, 4, 5, 6, 7}, Nodes{0, 0, 0, 0, 4, 4, 4, 4}})
    EXPECT_EQ(kind_of_cell(in_order_of_kind(other)), CellKind::unknown);
}

TEST(CollapsedCells, have_the_faces_of_their_shape) {
  for (const CellKind kind : collapsed_kinds) {
    const CellMesh mesh = one_of(kind, 0.1, 1);
    const DistinctCell cell(hexahedron, mesh.elements[0]);
    const auto nodes = cell.of(mesh.elements[0]);
    std::vector<std::array<std::int32_t, 4>> of_corners, of_shape;
    for (const auto& f : hexahedron.face) {
      const auto& n = mesh.elements[0];
      const std::array<std::int32_t, 4> face = {n[f[0]], n[f[1]], n[f[2]], n[f[3]]};
      if (!is_collapsed_face(face)) of_corners.push_back(face_key(face));
    }
    CellCorners x;
    for (std::size_t k = 0; k < 8; ++k) x[k] = mesh.x[static_cast<std::size_t>(nodes[k])];
    for (int f = 0; f < cell.shape->n_faces; ++f) {
      const auto& c = cell.shape->face[f];
      of_shape.push_back(face_key(std::array{nodes[c[0]], nodes[c[1]], nodes[c[2]], nodes[c[3]]}));
    }
    std::sort(of_corners.begin(), of_corners.end());
    std::sort(of_shape.begin(), of_shape.end());
    EXPECT_EQ(of_corners, of_shape) << cell.shape->name;
    EXPECT_NEAR(volume_by_faces(*cell.shape, x), volume_by_divergence(mesh, mesh.elements[0]),
                1e-14 * size * size * size);
    EXPECT_GT(min_scaled_jacobian(*cell.shape, x), 0.1);
    EXPECT_GT(shortest_edge(*cell.shape, x), 0.1 * size);
  }
}

TEST(CollapsedCells, fill_the_block_that_was_cut) {
  const CellMesh mesh = mixed(0.0, 1);
  const auto element = make_law<Element>("element", "hex8", "{}");
  EXPECT_TRUE(element->takes_collapsed_cells());
  std::map<CellKind, int> n;
  double sum = 0.0;
  for (std::size_t e = 0; e < mesh.elements.size(); ++e) {
    CellCorners x;
    for (std::size_t k = 0; k < 8; ++k) x[k] = mesh.x[static_cast<std::size_t>(mesh.elements[e][k])];
    const double volume = element->volume(x);
    // A brick, half, a sixth and a twelfth of it.
    const double share = kind_of(mesh, e) == CellKind::hexahedron ? 1.0
                         : kind_of(mesh, e) == CellKind::wedge    ? 1.0 / 2.0
                         : kind_of(mesh, e) == CellKind::pyramid  ? 1.0 / 6.0
                                                                  : 1.0 / 12.0;
    EXPECT_NEAR(volume / (share * size * size * size), 1.0, 1e-14);
    sum += volume;
    ++n[kind_of(mesh, e)];
  }
  EXPECT_NEAR(sum / (27.0 * size * size * size), 1.0, 1e-14);
  for (const auto kind : {CellKind::hexahedron, CellKind::wedge, CellKind::pyramid, CellKind::tetrahedron})
    EXPECT_GE(n[kind], 6);
}

/// One affine step: every cell has the stress of the deformation, and inner nodes are in balance.
template <class Part>
void expect_patch(const char* element, double tolerance) {
  const Matrix f = (Matrix() << 1.10, 0.07, -0.03, 0.02, 0.96, 0.05, -0.04, 0.03, 1.05).finished();
  const Matrix one = Matrix::Identity(), g = one - f.inverse(), h = g * (one - 0.5 * g).inverse();
  const Matrix middle = 0.5 * (h + h.transpose()), spin = 0.5 * (h - h.transpose());
  const Matrix strain = middle + 0.5 * (spin * middle - middle * spin);
  const Matrix expected = 2.0 * G * (strain - one * (strain.trace() / 3.0)) - K * (1.0 / f.determinant() - 1.0) * one;
  for (unsigned seed = 1; seed <= 5; ++seed) {
    Part part = part_of<Part>(mixed(0.1, seed), element);
    part.move_to(mapped(part.x, f, Vec3{3, -2, 1} * size), dt);
    for (int e = 0; e < part.n_elements(); ++e)
      EXPECT_LT(largest(full(part.stress(e)) - expected), tolerance * largest(expected)) << "element " << e;
    for (int n = 0; n < static_cast<int>(part.x.size()); ++n)
      if (is_inner(n))
        EXPECT_LT(norm(part.force(n)), 10.0 * tolerance * largest(expected) * size * size) << "node " << n;
  }
}

TEST(CollapsedCells, of_all_kinds_pass_the_patch_test) {
  expect_patch<OnePart>(viscous, 1e-12);
  expect_patch<OnePart>(stiffness, 1e-12);
}
// Strains of 0.1 from floats, and moduli of 500 such stresses.
TEST(CollapsedCells, of_all_kinds_pass_the_patch_test_in_single_precision) {
  expect_patch<SinglePart>(stiffness, 1e-5);
}

TEST(CollapsedCells, feel_no_rigid_motion) {
  for (const char* element : {viscous, stiffness}) {
    OnePart part = part_of<OnePart>(mixed(0.1, 3), element);
    const Matrix turn = Eigen::AngleAxisd(0.1, Eigen::Vector3d(1, 2, -1).normalized()).toRotationMatrix();
    for (int i = 0; i < 10; ++i) part.move_to(mapped(part.x, turn, Vec3{1, 1, 1} * size), dt);
    for (int e = 0; e < part.n_elements(); ++e) EXPECT_LT(largest(full(part.stress(e))), 1e-13 * K);
    for (int n = 0; n < static_cast<int>(part.x.size()); ++n) EXPECT_LT(norm(part.force(n)), 1e-12 * K * size * size);
    EXPECT_LT(std::fabs(part.hourglass_energy()), 1e-19 * K * size * size * size);
  }
}

TEST(CollapsedCells, have_forces_that_add_up_to_nothing_in_integers) {
  std::mt19937 random(5);
  std::uniform_real_distribution<double> component(-10.0, 10.0);
  for (const CellKind kind : collapsed_kinds) {
    OnePart part = part_of<OnePart>(one_of(kind, 0.1, 2), stiffness);
    for (Vec3& v : part.v) v = {component(random), component(random), component(random)};
    part.step(1e-7);
    for (int d = 0; d < 3; ++d) {
      std::int64_t sum = 0, sizes = 0;
      for (int n = 0; n < static_cast<int>(part.x.size()); ++n) {
        sum += part.quanta(n, d);
        sizes += std::abs(part.quanta(n, d));
      }
      EXPECT_EQ(sum, 0);
      EXPECT_GT(sizes, 0);
    }
  }
}

TEST(CollapsedCells, press_with_the_derivative_of_their_volume) {
  for (const CellKind kind : collapsed_kinds) {
    const CellMesh mesh = one_of(kind, 0.1, 4);
    PartLaws laws;
    laws.compression = 1.01;
    OnePart part(mesh, laws);
    part.initialise();
    ASSERT_GT(part.pressure(0), 1e9);
    for (std::size_t n = 0; n < mesh.x.size(); ++n)
      for (int d = 0; d < 3; ++d) {
        // The volume is linear in each coordinate: a central difference is exact to round-off.
        CellMesh plus = mesh, minus = mesh;
        plus.x[n][d] += 0.25 * size;
        minus.x[n][d] -= 0.25 * size;
        const double b =
            (volume_by_divergence(plus, mesh.elements[0]) - volume_by_divergence(minus, mesh.elements[0])) /
            (0.5 * size);
        EXPECT_NEAR(part.force(static_cast<int>(n))[d], part.pressure(0) * b, 1e-12 * part.pressure(0) * size * size);
      }
  }
}

/// Forces on the nodes of a cell alone where these move at random, without what a linear field explains.
TEST(CollapsedCells, tetrahedra_have_no_hourglass_modes_and_the_others_resist_theirs) {
  std::mt19937 random(5);
  std::uniform_real_distribution<double> component(-1.0, 1.0);
  for (const CellKind kind : collapsed_kinds) {
    const CellMesh mesh = one_of(kind, 0.1, 2);
    OnePart part = part_of<OnePart>(mesh, viscous);
    for (Vec3& v : part.v) v = {component(random), component(random), component(random)};
    part.step(1e-9);
    // Without control: stress alone.
    OnePart bare = part_of<OnePart>(mesh, "{linear_viscosity: 0, quadratic_viscosity: 0, hourglass_coefficient: 0}");
    bare.v = part.v;
    bare.step(1e-9);
    double power = 0.0, scale = 0.0;
    for (int n = 0; n < static_cast<int>(part.x.size()); ++n) {
      power += dot(part.force(n) - bare.force(n), part.v[n]);
      scale += norm(bare.force(n)) * norm(part.v[n]);
    }
    if (kind == CellKind::tetrahedron)
      EXPECT_LT(std::fabs(power), 1e-6 * scale);
    else
      EXPECT_LT(power, -1e-3 * scale);
  }
}

/// Largest stable step of central differences for small motion of the mesh: 2 over its highest frequency [s].
double true_limit(const CellMesh& mesh, const PartLaws& laws) {
  const double moved = 1e-9, step = 1e-9;
  const int n = 3 * static_cast<int>(mesh.x.size());
  Eigen::MatrixXd k(n, n);
  Eigen::VectorXd mass = Eigen::VectorXd::Zero(n);
  for (int column = 0; column < n; ++column) {
    OnePart part(mesh, laws);
    part.initialise();
    part.v[column / 3][column % 3] = moved / step;
    part.step(step);
    for (int row = 0; row < n; ++row) k(row, column) = -part.force(row / 3)[row % 3] / moved;
    if (column > 0) continue;
    for (int e = 0; e < part.n_elements(); ++e)
      for (const int node : part.nodes(e))
        for (int d = 0; d < 3; ++d) mass[3 * node + d] += part.element_mass(e) / 8.0;
  }
  const Eigen::VectorXd scale = mass.cwiseSqrt().cwiseInverse();
  const Eigen::MatrixXd dynamic = scale.asDiagonal() * (0.5 * (k + k.transpose())) * scale.asDiagonal();
  return 2.0 / std::sqrt(Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd>(dynamic).eigenvalues().maxCoeff());
}

/// The bound takes each corner for a node of its own with an eighth of the mass. That corners move together makes
/// frequencies lower, never higher.
TEST(CollapsedCells, have_a_stable_step_below_their_highest_frequency) {
  PartLaws laws;
  laws.element =
      "{linear_viscosity: 0, quadratic_viscosity: 0, hourglass_coefficient: 0.05, stable_step: free_element}";
  const auto ratio = [&](const CellMesh& mesh) {
    OnePart part(mesh, laws);
    part.initialise();
    return part.stable_step() / true_limit(mesh, laws);
  };
  for (const CellKind kind : collapsed_kinds)
    for (unsigned seed = 1; seed <= 3; ++seed) {
      const double r = ratio(one_of(kind, 0.1, seed));
      EXPECT_LE(r, 1.0 + 1e-4) << static_cast<int>(kind);
      EXPECT_GE(r, 0.4) << static_cast<int>(kind);
      RecordProperty(std::to_string(static_cast<int>(kind)) + "_" + std::to_string(seed), std::to_string(r));
    }
  // Plane wave's bound: whole blocks of one kind, without exposed faces taken into account.
  laws.element = "{linear_viscosity: 0, quadratic_viscosity: 0, hourglass_coefficient: 0.05}";
  for (const CutOf cut :
       {CutOf([](int, int, int) { return Cut::wedges; }), CutOf([](int, int, int) { return Cut::pyramids; }),
        CutOf([](int, int, int) { return Cut::tetrahedra; }), CutOf(all_cuts)}) {
    const double r = ratio(CutBlock(distorted_block(3, 3, 3, size, 0.0, 1), 3, 3, 3, cut).mesh());
    EXPECT_LE(r, 1.0);
    std::printf("plane wave's bound over the true limit of a block: %.3f\n", r);
  }
}

}  // namespace
