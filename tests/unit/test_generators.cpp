// Mesh generators: conforming, well-shaped, complete meshes of the right volume, and messages for nonsense.
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <chrono>
#include <cmath>
#include <functional>
#include <map>
#include <memory>
#include <string>
#include <tuple>
#include <vector>

#include "../../physics/meshes/block_generator.hpp"
#include "../../physics/meshes/cylinder_generator.hpp"
#include "kerf/meshes/grading.hpp"
#include "kerf/shape.hpp"
#include "mesh/quality.hpp"

namespace {

using namespace kerf;

constexpr double pi = 3.14159265358979323846;
struct Case {
  std::string name, nose, sector;
  double nose_length, caliber_radius_head, tip;
  double cell_size;
};

std::unique_ptr<CylinderGenerator> rod(const Case& c) {
  auto g = std::make_unique<CylinderGenerator>();
  g->radius = 3.835e-3;
  g->length = 20e-3;
  g->cell_size = c.cell_size;
  g->sector = c.sector;
  g->nose.type = c.nose;
  g->nose.length = c.nose_length;
  g->nose.caliber_radius_head = c.caliber_radius_head;
  g->nose.tip_radius_fraction = c.tip;
  return g;
}

std::vector<Case> all_cases() {
  std::vector<Case> cases;
  for (const std::string sector : {"full", "half", "quarter"})
    for (const double h : {0.8e-3, 1.7e-3}) {
      const std::string size = h > 1e-3 ? "_coarse" : "_fine";
      cases.push_back({"flat_" + sector + size, "flat", sector, 0, 0, -1, h});
      cases.push_back({"hemispherical_" + sector + size, "hemispherical", sector, 0, 0, -1, h});
      cases.push_back({"conical_" + sector + size, "conical", sector, 7e-3, 0, -1, h});
      cases.push_back({"conical_cut_" + sector + size, "conical", sector, 7e-3, 0, 0.4, h});
      cases.push_back({"conical_blunt_" + sector + size, "conical", sector, 2e-3, 0, -1, h});
      cases.push_back({"conical_pointed_" + sector + size, "conical", sector, 9e-3, 0, 0.0, h});
      cases.push_back({"ogival_" + sector + size, "ogival", sector, 0, 3, -1, h});
      cases.push_back({"ogival_cut_" + sector + size, "ogival", sector, 0, 3, 0.4, h});
      cases.push_back({"ogival_pointed_" + sector + size, "ogival", sector, 0, 4.5, 0.0, h});
    }
  return cases;
}

// Every face belongs to two elements, or to one and then with all its nodes to a named face of the body.
void expect_conforming(const MeshGenerator& g) {
  std::map<std::array<std::int64_t, 4>, int> sharing;
  std::vector<bool> used(static_cast<std::size_t>(g.n_nodes()), false);
  for (std::int64_t e = 0; e < g.n_elements(); ++e) {
    const auto n = g.element(e);
    for (const auto i : n) {
      ASSERT_GE(i, 0);
      ASSERT_LT(i, g.n_nodes());
      used[static_cast<std::size_t>(i)] = true;
    }
    for (const auto& f : hexahedron.face) {
      std::array<std::int64_t, 4> key{n[f[0]], n[f[1]], n[f[2]], n[f[3]]};
      std::sort(key.begin(), key.end());
      ++sharing[key];
    }
  }
  EXPECT_EQ(std::count(used.begin(), used.end(), false), 0) << "nodes without elements";
  const int n_names = static_cast<int>(g.face_names().size());
  for (const auto& [key, count] : sharing) {
    ASSERT_LE(count, 2);
    int named = 0;
    for (int face = 0; face < n_names; ++face)
      named += std::all_of(key.begin(), key.end(), [&](auto i) { return g.on_face(i, face); });
    if (count == 1)
      EXPECT_EQ(named, 1) << "an exterior face belongs to one named face";
    else
      EXPECT_EQ(named, 0) << "an interior face belongs to none";
  }
}

void expect_distinct_nodes(const MeshGenerator& g, double tolerance) {
  std::vector<Vec3> nodes;
  for (std::int64_t i = 0; i < g.n_nodes(); ++i) nodes.push_back(g.node(i));
  std::sort(nodes.begin(), nodes.end(), [](Vec3 a, Vec3 b) { return a.x < b.x; });
  for (std::size_t i = 0; i < nodes.size(); ++i)
    for (std::size_t j = i + 1; j < nodes.size() && nodes[j].x - nodes[i].x < tolerance; ++j)
      ASSERT_GT(norm(nodes[j] - nodes[i]), tolerance);
}

std::int64_t count_on_face(const MeshGenerator& g, int face) {
  std::int64_t n = 0;
  for (std::int64_t i = 0; i < g.n_nodes(); ++i) n += g.on_face(i, face);
  return n;
}

int face_index(const MeshGenerator& g, const std::string& name) {
  const auto names = g.face_names();
  return static_cast<int>(std::find(names.begin(), names.end(), name) - names.begin());
}

// Whether some rule declared for the object fails; its message is what the user would read.
template <class T>
std::string broken_rule(const T& object) {
  Description d;
  Schema<T> s(d);
  T::describe(s);
  for (const auto& rule : d.rules)
    if (!rule.holds(&object)) return rule.message;
  return "";
}

double parallelepiped_error(Vec3 a, Vec3 b, Vec3 c) {
  const Vec3 o{0.3, -2.0, 1.1};
  const CellCorners x{o, o + a, o + a + b, o + b, o + c, o + a + c, o + a + b + c, o + b + c};
  return volume_by_faces(hexahedron, x) - dot(a, cross(b, c));
}

// Integral of the trilinear map's Jacobian by 2x2x2 Gauss points, which is exact.
double gauss_volume(const CellCorners& x) {
  const double g = 1.0 / std::sqrt(3.0);
  double volume = 0.0;
  for (int p = 0; p < 8; ++p) {
    const std::array<double, 3> at{p & 1 ? g : -g, p & 2 ? g : -g, p & 4 ? g : -g};
    std::array<Vec3, 3> d{};
    for (std::size_t i = 0; i < 8; ++i) {
      const std::array<double, 3> c{i % 4 == 1 || i % 4 == 2 ? 1.0 : -1.0, i % 4 >= 2 ? 1.0 : -1.0,
                                    i >= 4 ? 1.0 : -1.0};
      const std::array<double, 3> f{1 + c[0] * at[0], 1 + c[1] * at[1], 1 + c[2] * at[2]};
      d[0] = d[0] + x[i] * (c[0] * f[1] * f[2] / 8);
      d[1] = d[1] + x[i] * (c[1] * f[0] * f[2] / 8);
      d[2] = d[2] + x[i] * (c[2] * f[0] * f[1] / 8);
    }
    volume += dot(d[0], cross(d[1], d[2]));
  }
  return volume;
}

TEST(MeshQuality, volume_is_exact_for_parallelepipeds_and_warped_hexahedra) {
  EXPECT_NEAR(parallelepiped_error({1, 0, 0}, {0, 1, 0}, {0, 0, 1}), 0.0, 1e-14);
  EXPECT_NEAR(parallelepiped_error({2, 0.1, 0}, {0.3, 1, -0.2}, {0.2, 0.4, 3}), 0.0, 1e-13);
  const CellCorners warped{{{0, 0, 0.1},
                            {1.1, 0.2, 0},
                            {1, 0.9, -0.3},
                            {0.1, 1.2, 0},
                            {0.2, 0, 1},
                            {1, -0.2, 1.3},
                            {1.3, 1.1, 1},
                            {-0.1, 1, 0.8}}};
  EXPECT_NEAR(volume_by_faces(hexahedron, warped), gauss_volume(warped), 1e-14);
}

TEST(MeshQuality, scaled_jacobian_tells_bricks_shears_and_inversions) {
  CellCorners x{{{0, 0, 0}, {2, 0, 0}, {2, 1, 0}, {0, 1, 0}, {0, 0, 3}, {2, 0, 3}, {2, 1, 3}, {0, 1, 3}}};
  EXPECT_NEAR(min_scaled_jacobian(hexahedron, x), 1.0, 1e-15);
  EXPECT_DOUBLE_EQ(shortest_edge(hexahedron, x), 1.0);
  EXPECT_DOUBLE_EQ(longest_edge(hexahedron, x), 3.0);
  CellCorners sheared = x;
  for (std::size_t i = 4; i < 8; ++i) sheared[i].x += 3.0;  // by 45 degrees
  EXPECT_NEAR(min_scaled_jacobian(hexahedron, sheared), std::sqrt(0.5), 1e-15);
  std::swap(x[0], x[6]);
  EXPECT_LT(min_scaled_jacobian(hexahedron, x), 0.0);
  CellCorners collapsed = sheared;
  collapsed[1] = collapsed[0];
  EXPECT_EQ(min_scaled_jacobian(hexahedron, collapsed), 0.0);
}

TEST(BlockGenerator, uniform_box_is_conforming_and_exact) {
  BlockGenerator g;
  g.size = {3, 2, 1};
  g.origin = {-1, 5, 0.5};
  g.cells = {6, 3, 4};
  ASSERT_TRUE(g.prepare().empty());
  EXPECT_EQ(g.n_elements(), 72);
  EXPECT_EQ(g.n_nodes(), 7 * 4 * 5);
  expect_conforming(g);
  const MeshReport report = assess(g);
  EXPECT_NEAR(report.total_volume, 6.0, 1e-12);
  EXPECT_NEAR(report.min_scaled_jacobian, 1.0, 1e-12);
  EXPECT_EQ(report.n_unusable, 0);
  EXPECT_EQ(count_on_face(g, face_index(g, "x_min")), 4 * 5);
  EXPECT_EQ(count_on_face(g, face_index(g, "z_max")), 7 * 4);
  for (std::int64_t i = 0; i < g.n_nodes(); ++i) {
    EXPECT_EQ(g.on_face(i, face_index(g, "x_max")), g.node(i).x == 2.0);
    EXPECT_EQ(g.on_face(i, face_index(g, "y_min")), g.node(i).y == 5.0);
    EXPECT_EQ(g.on_face(i, face_index(g, "z_max")), g.node(i).z == 1.5);
  }
}

TEST(BlockGenerator, cell_size_is_rounded_to_whole_cells) {
  BlockGenerator g;
  g.size = {1.0, 0.26, 0.5};
  g.cell_size = 0.1;
  ASSERT_TRUE(g.prepare().empty());
  EXPECT_EQ(g.n_elements(), 10 * 3 * 5);
}

TEST(BlockGenerator, grading_keeps_stretches_and_ratios) {
  BlockGenerator g;
  g.size = {2, 1, 1};
  g.cells = {1, 1, 1};
  for (const auto& [to, cells, ratio] : {std::tuple{0.5, 5, 1.0}, std::tuple{2.0, 8, 4.0}}) {
    g.grading_x.push_back(std::make_unique<GradingInput>());
    g.grading_x.back()->to = to;
    g.grading_x.back()->cells = cells;
    g.grading_x.back()->ratio = ratio;
  }
  ASSERT_TRUE(g.prepare().empty());
  const auto& x = g.lines(0);
  ASSERT_EQ(x.size(), 14u);
  EXPECT_DOUBLE_EQ(x[5], 0.5);
  EXPECT_EQ(x.back(), 2.0);
  EXPECT_NEAR((x[13] - x[12]) / (x[6] - x[5]), 4.0, 1e-12);
  for (std::size_t i = 6; i < 12; ++i)
    EXPECT_NEAR((x[i + 1] - x[i]) / (x[i] - x[i - 1]), std::pow(4.0, 1.0 / 7.0), 1e-12);
}

void expect_refined(const std::vector<double>& x, double from, double to, double fine, double coarse, double growth) {
  double smallest = 1e300, largest = 0.0;
  for (std::size_t i = 0; i + 1 < x.size(); ++i) {
    const double size = x[i + 1] - x[i];
    ASSERT_GT(size, 0.0);
    smallest = std::min(smallest, size);
    largest = std::max(largest, size);
    if (x[i] > from - 1e-9 && x[i + 1] < to + 1e-9) {
      EXPECT_NEAR(size, fine, 0.02 * fine);
    }
    if (i > 0) {
      const double ratio = size / (x[i] - x[i - 1]);
      EXPECT_LT(std::max(ratio, 1.0 / ratio), growth * (1.0 + 1e-6));
    }
  }
  EXPECT_GT(smallest, 0.98 * fine);
  EXPECT_LT(largest, coarse * (1.0 + 1e-9));
}

TEST(BlockGenerator, refined_interval_grows_to_the_coarse_size) {
  BlockGenerator g;
  g.size = {0.1, 0.1, 0.02};
  g.cell_size = 4e-3;
  g.refine_x = std::make_unique<RefineAxisInput>();
  g.refine_x->from = 0.04;
  g.refine_x->to = 0.06;
  g.refine_x->size = 1e-3;
  g.refine_y = std::make_unique<RefineAxisInput>();
  g.refine_y->from = 0.0;
  g.refine_y->to = 0.02;
  g.refine_y->size = 0.5e-3;
  g.refine_y->growth = 1.3;
  ASSERT_TRUE(g.prepare().empty());
  expect_refined(g.lines(0), 0.04, 0.06, 1e-3, 4e-3, 1.15);
  expect_refined(g.lines(1), 0.0, 0.02, 0.5e-3, 4e-3, 1.3);
  EXPECT_EQ(g.lines(2).size(), 6u);
  const auto& x = g.lines(0);  // a symmetric interval gives a symmetric mesh
  for (std::size_t i = 0; i < x.size(); ++i) EXPECT_NEAR(x[i] + x[x.size() - 1 - i], 0.1, 1e-12);
  expect_conforming(g);
  EXPECT_NEAR(assess(g).total_volume, 2e-4, 1e-12);
}

TEST(BlockGenerator, refined_zone_is_cut_off_at_the_box) {
  BlockGenerator g;
  g.size = {0.1, 0.1, 0.02};
  g.cell_size = 4e-3;
  g.refine = std::make_unique<RefineZoneInput>();
  g.refine->center = {0.05, 0.0, 0.01};
  g.refine->size = {0.02, 0.03, 0.0};
  g.refine->factor = 4.0;
  ASSERT_TRUE(g.prepare().empty());
  expect_refined(g.lines(0), 0.04, 0.06, 1e-3, 4e-3, 1.15);
  expect_refined(g.lines(1), 0.0, 0.015, 1e-3, 4e-3, 1.15);
  EXPECT_EQ(g.lines(2).size(), 6u);
}

TEST(Grading, short_rests_beside_a_fine_zone_keep_cells_large) {
  for (double from = 0.001; from < 0.2; from += 0.00137) {
    const auto x = refined_lines(1.0, {from, 0.5, 0.01, 1.15, 0.05});
    EXPECT_EQ(x.front(), 0.0);
    EXPECT_EQ(x.back(), 1.0);
    for (std::size_t i = 0; i + 1 < x.size(); ++i) ASSERT_GT(x[i + 1] - x[i], std::min(from * 0.999, 0.0066));
  }
}

TEST(BlockGenerator, nonsense_is_told_in_sentences) {
  BlockGenerator g;
  g.size = {1, 1, 1};
  EXPECT_NE(broken_rule(g).find("either cells or cell_size"), std::string::npos);
  g.cell_size = 0.1;
  EXPECT_EQ(broken_rule(g), "");
  g.cells = {1, 2, 3};
  EXPECT_NE(broken_rule(g).find("either cells or cell_size"), std::string::npos);
  g.cell_size = 0.0;
  g.cells = {1, 2};
  EXPECT_NE(broken_rule(g).find("three whole numbers"), std::string::npos);
  g.cells.clear();
  g.cell_size = 2.0;
  EXPECT_NE(g.prepare().at(0).find("larger than the box along x"), std::string::npos);
  g.cell_size = 0.1;
  g.refine_z = std::make_unique<RefineAxisInput>();
  g.refine_z->from = 0.5;
  g.refine_z->to = 1.5;
  g.refine_z->size = 0.2;
  const auto errors = g.prepare();
  ASSERT_EQ(errors.size(), 2u);
  EXPECT_NE(errors[0].find("outside the box"), std::string::npos);
  EXPECT_NE(errors[1].find("larger than the others"), std::string::npos);
  g.grading_z.push_back(std::make_unique<GradingInput>());
  g.grading_z.back()->to = 0.7;
  g.grading_z.back()->cells = 3;
  EXPECT_NE(g.prepare().at(0).find("only one of grading_z, refine_z and refine"), std::string::npos);
  g.refine_z.reset();
  EXPECT_NE(g.prepare().at(0).find("ends at 0.7 m"), std::string::npos);
}

class Rods : public testing::TestWithParam<Case> {};

TEST_P(Rods, are_conforming_with_complete_faces) {
  const auto g = rod(GetParam());
  ASSERT_EQ(broken_rule(*g), "");
  ASSERT_TRUE(g->prepare().empty());
  expect_conforming(*g);
  expect_distinct_nodes(*g, 0.05 * g->cell_size);
}

TEST_P(Rods, have_well_shaped_cells) {
  const auto g = rod(GetParam());
  ASSERT_TRUE(g->prepare().empty());
  const MeshReport report = assess(*g);
  EXPECT_EQ(report.n_unusable, 0);
  // A pointed tip of half angle a has corners with sin(a)^2 there, whatever the mesh: 0.15 for the slimmest one.
  EXPECT_GT(report.min_scaled_jacobian, g->nose.type == "flat" ? 0.8 : g->nose.tip_radius_fraction == 0.0 ? 0.14 : 0.3);
  const bool coarse = GetParam().cell_size > 1e-3;
  EXPECT_GT(report.smallest_edge, (coarse ? 0.2 : 0.29) * g->cell_size);
}

TEST_P(Rods, lie_within_their_envelope) {
  const auto g = rod(GetParam());
  ASSERT_TRUE(g->prepare().empty());
  const int z_min = face_index(*g, "z_min"), lateral = face_index(*g, "lateral");
  const int symmetry_y = face_index(*g, "symmetry_y"), symmetry_x = face_index(*g, "symmetry_x");
  const int n_names = static_cast<int>(g->face_names().size());
  double top = 0.0;
  for (std::int64_t i = 0; i < g->n_nodes(); ++i) {
    const Vec3 x = g->node(i);
    top = std::max(top, x.z);
    EXPECT_LE(std::hypot(x.x, x.y), g->radius * (1.0 + 1e-12));
    EXPECT_EQ(g->on_face(i, z_min), x.z == 0.0);
    if (g->nose.type == "flat") {
      EXPECT_EQ(g->on_face(i, lateral), std::abs(std::hypot(x.x, x.y) - g->radius) < 1e-9 * g->radius);
    }
    if (symmetry_y < n_names) {
      EXPECT_EQ(g->on_face(i, symmetry_y), x.y == 0.0);
    }
    if (symmetry_x < n_names) {
      EXPECT_EQ(g->on_face(i, symmetry_x), x.x == 0.0);
    }
  }
  EXPECT_NEAR(top, g->length, 1e-12 * g->length);
}

INSTANTIATE_TEST_SUITE_P(Noses, Rods, testing::ValuesIn(all_cases()), [](const auto& info) { return info.param.name; });

// Nodes of a mesh in a fixed order, for comparing meshes bit by bit.
std::vector<std::array<double, 3>> sorted_nodes(const MeshGenerator& g, const std::function<bool(Vec3)>& keep) {
  std::vector<std::array<double, 3>> nodes;
  for (std::int64_t i = 0; i < g.n_nodes(); ++i)
    if (const Vec3 x = g.node(i); keep(x)) nodes.push_back({x.x, x.y, x.z});
  std::sort(nodes.begin(), nodes.end());
  return nodes;
}

TEST(CylinderGenerator, halves_and_quarters_make_up_the_full_rod) {
  for (const std::string nose : {"flat", "conical", "ogival", "hemispherical"}) {
    std::map<std::string, std::unique_ptr<CylinderGenerator>> g;
    for (const std::string sector : {"full", "half", "quarter"}) {
      g[sector] = rod({"", nose, sector, nose == "conical" ? 7e-3 : 0.0, nose == "ogival" ? 3.0 : 0.0, -1, 0.8e-3});
      ASSERT_TRUE(g[sector]->prepare().empty());
    }
    const auto shared = count_on_face(*g["half"], face_index(*g["half"], "symmetry_y"));
    EXPECT_EQ(g["full"]->n_elements(), 2 * g["half"]->n_elements());
    EXPECT_EQ(g["full"]->n_nodes(), 2 * g["half"]->n_nodes() - shared);
    EXPECT_EQ(g["half"]->n_elements(), 2 * g["quarter"]->n_elements());
    const auto all = [](Vec3) { return true; };
    EXPECT_EQ(sorted_nodes(*g["half"], all), sorted_nodes(*g["full"], [](Vec3 x) { return x.y >= 0.0; }));
    EXPECT_EQ(sorted_nodes(*g["quarter"], all), sorted_nodes(*g["half"], [](Vec3 x) { return x.x >= 0.0; }));
  }
}

// Orders of convergence of the volume over two doublings of all cell counts.
void expect_second_order(CylinderGenerator& g, double exact) {
  std::array<double, 3> error{};
  for (std::size_t level = 0; level < 3; ++level) {
    const std::int64_t factor = std::int64_t{1} << level;
    g.core_cells = 2 * factor;
    g.ring_cells = factor;
    g.axial_cells = 8 * factor;
    ASSERT_EQ(broken_rule(g), "");
    ASSERT_TRUE(g.prepare().empty());
    error[level] = std::abs(assess(g).total_volume - exact) / exact;
  }
  EXPECT_LT(error[2], 3e-3);
  EXPECT_NEAR(std::log2(error[1] / error[2]), 2.0, 0.1);
  EXPECT_NEAR(std::log2(error[0] / error[1]), 2.0, 0.25);
}

TEST(CylinderGenerator, volume_converges_with_second_order) {
  const double r = 1.5, length = 6.0;
  {
    CylinderGenerator g;
    g.radius = r;
    g.length = length;
    expect_second_order(g, pi * r * r * length);
    g.sector = "quarter";
    expect_second_order(g, pi * r * r * length / 4.0);
  }
  {
    CylinderGenerator g;
    g.radius = r;
    g.length = length;
    g.nose.type = "hemispherical";
    expect_second_order(g, pi * r * r * (length - r) + 2.0 / 3.0 * pi * r * r * r);
  }
  for (const double tip : {0.0, 0.5}) {
    CylinderGenerator g;
    g.radius = r;
    g.length = length;
    g.nose.type = "conical";
    g.nose.length = 3.0;
    g.nose.tip_radius_fraction = tip;
    expect_second_order(g, pi * r * r * ((length - 3.0) + 3.0 * (1.0 + tip + tip * tip) / 3.0));
  }
}

TEST(CylinderGenerator, ogive_has_its_closed_form_volume) {
  CylinderGenerator g;
  g.radius = 1.0;
  g.length = 8.0;
  g.nose.type = "ogival";
  g.nose.caliber_radius_head = 3.0;
  // rho = 6 R, axis offset d = rho - R; V = pi int_0^h (sqrt(rho^2 - z^2) - d)^2 dz up to the cut at r = R/10
  const double rho = 6.0, d = rho - 1.0, h = std::sqrt(rho * rho - (d + 0.1) * (d + 0.1));
  const double area = 0.5 * (h * std::sqrt(rho * rho - h * h) + rho * rho * std::asin(h / rho));
  const double nose = pi * (rho * rho * h - h * h * h / 3.0 - 2.0 * d * area + d * d * h);
  const double exact = pi * (g.length - h) + nose;
  g.cell_size = 0.05;
  ASSERT_TRUE(g.prepare().empty());
  // The polygonal section alone takes away (2 pi / 112)^2 / 6 = 0.05 %.
  EXPECT_NEAR(assess(g).total_volume, exact, 1e-3 * exact);
}

TEST(CylinderGenerator, exact_section_has_the_volume_of_the_cylinder) {
  CylinderGenerator g;
  g.radius = 0.7;
  g.length = 2.0;
  g.core_cells = 2;
  g.ring_cells = 1;
  g.axial_cells = 4;
  g.exact_section = true;
  g.sector = "half";
  ASSERT_TRUE(g.prepare().empty());
  EXPECT_NEAR(assess(g).total_volume, pi * 0.49, 1e-12);
}

TEST(CylinderGenerator, sections_are_about_as_fine_as_asked) {
  const auto elements_in_section = [](double cell_size, const std::string& sector) {
    const auto g = rod({"", "flat", sector, 0, 0, -1, cell_size});
    EXPECT_TRUE(g->prepare().empty());
    return static_cast<double>(g->n_elements()) / std::round(g->length / cell_size);
  };
  EXPECT_EQ(elements_in_section(0.8e-3, "full"), 84.0);
  EXPECT_EQ(elements_in_section(1.5e-3, "half"), 16.0);
}

TEST(CylinderGenerator, axial_ratio_grades_the_layers) {
  CylinderGenerator g;
  g.radius = 1.0;
  g.length = 10.0;
  g.core_cells = 1;
  g.ring_cells = 1;
  g.axial_cells = 20;
  g.axial_ratio = 5.0;
  ASSERT_TRUE(g.prepare().empty());
  std::vector<double> z;
  for (std::int64_t i = 0; i < g.n_nodes(); ++i) z.push_back(g.node(i).z);
  std::sort(z.begin(), z.end());
  z.erase(std::unique(z.begin(), z.end()), z.end());
  ASSERT_EQ(z.size(), 21u);
  EXPECT_NEAR((z[20] - z[19]) / (z[1] - z[0]), 5.0, 1e-9);
}

TEST(CylinderGenerator, nonsense_is_told_in_sentences) {
  CylinderGenerator g;
  g.radius = 1.0;
  g.length = 2.0;
  EXPECT_NE(broken_rule(g).find("either a cell_size or all of"), std::string::npos);
  g.cell_size = 0.3;
  g.core_cells = 2;
  EXPECT_NE(broken_rule(g).find("either a cell_size or all of"), std::string::npos);
  g.core_cells = 0;
  EXPECT_EQ(broken_rule(g), "");
  g.nose.type = "conical";
  EXPECT_NE(broken_rule(g.nose).find("conical nose takes a length"), std::string::npos);
  g.nose.length = 3.0;
  EXPECT_EQ(broken_rule(g.nose), "");
  EXPECT_NE(g.prepare().at(0).find("the nose (3 m) is longer than the rod (2 m)"), std::string::npos);
  g.nose.length = 0.1;
  EXPECT_NE(g.prepare().at(0).find("too flat"), std::string::npos);
  g.nose.type = "hemispherical";
  EXPECT_NE(broken_rule(g.nose).find("no other nose"), std::string::npos);
  g.nose.length = 0.0;
  g.nose.tip_radius_fraction = 0.2;
  EXPECT_NE(broken_rule(g.nose).find("tip_radius_fraction"), std::string::npos);
  g.nose.tip_radius_fraction = -1.0;
  g.cell_size = 1.5;
  EXPECT_NE(g.prepare().at(0).find("larger than the radius"), std::string::npos);
}

// Ten million elements cost nothing until they are asked for, and each one is cheap: the generous bounds
// fail only where something is proportional to the mesh or allocates.
TEST(CylinderGenerator, large_meshes_are_addressable_at_once) {
  const auto seconds = [start = std::chrono::steady_clock::now()] {
    return std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
  };
  CylinderGenerator g;
  g.radius = 1.0;
  g.length = 60.0;
  g.cell_size = 0.0235;
  g.nose.type = "hemispherical";
  ASSERT_TRUE(g.prepare().empty());
  EXPECT_GT(g.n_elements(), 10'000'000);
  EXPECT_LT(seconds(), 0.5);
  double sum = 0.0;
  const std::int64_t stride = g.n_elements() / 100'000;
  for (std::int64_t e = 0; e < g.n_elements(); e += stride) sum += volume_by_faces(hexahedron, placed_cell(g, e).x);
  EXPECT_GT(sum, 0.0);
  EXPECT_LT(seconds(), 3.0);
}

}  // namespace
