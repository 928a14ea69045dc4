// Requirement: tubes, spheres and their parts converge to the exact volume with second order, have cells of good
// quality, no node twice, named faces that lie where they should, and refuse what cannot be meshed.
#include <gtest/gtest.h>

#include <cmath>
#include <map>
#include <tuple>

#include "mesh/quality.hpp"
#include "support/make_law.hpp"

namespace {

using kerf::assess;
using kerf::MeshGenerator;
using kerf::Vec3;
using kerf::test::make_law;

constexpr double pi = 3.14159265358979323846;

std::unique_ptr<MeshGenerator> mesh(const std::string& type, const std::string& parameters) {
  auto made = make_law<MeshGenerator>("mesh", type, parameters);
  const auto errors = made->prepare();
  for (const std::string& line : errors) ADD_FAILURE() << line;
  return made;
}

std::string complaint(const std::string& type, const std::string& parameters) {
  const auto errors = make_law<MeshGenerator>("mesh", type, parameters)->prepare();
  return errors.empty() ? "" : errors.front();
}

/// A mesh with counts that double, and its exact volume.
struct Family {
  std::string type, fixed, counts;  // counts with %d for the factor times 1, in the order of `base`
  std::vector<int> base;
  double volume;
  double least_jacobian;

  std::unique_ptr<MeshGenerator> at(int factor) const {
    std::string text = counts;
    for (const int b : base) text.replace(text.find("%d"), 2, std::to_string(b * factor));
    return mesh(type, "{" + fixed + ", " + text + "}");
  }
  friend std::ostream& operator<<(std::ostream& s, const Family& f) { return s << f.type << " " << f.fixed; }
};

const double shell_volume = 4.0 / 3.0 * pi * (8.0 - 1.0);
// Of the pyramid between x = 0, x = z tan a, y = 0, y = z tan a: the solid angle is asin(sin^2 a).
const double sector_volume = std::asin(std::pow(std::sin(pi / 6.0), 2)) * (8.0 - 1.0) / 3.0;

class RoundMesh : public testing::TestWithParam<Family> {};

TEST_P(RoundMesh, volume_converges_with_second_order) {
  double error[3];
  for (int level = 0; level < 3; ++level)
    error[level] = std::fabs(assess(*GetParam().at(1 << level)).total_volume / GetParam().volume - 1.0);
  EXPECT_LT(error[2], 0.01);
  // What is left of the next order of the error.
  EXPECT_NEAR(std::log2(error[1] / error[2]), 2.0, 0.15);
}

TEST_P(RoundMesh, cells_are_of_good_quality) {
  for (const int factor : {1, 4}) {
    const auto report = assess(*GetParam().at(factor));
    EXPECT_EQ(report.n_unusable, 0);
    EXPECT_GT(report.min_scaled_jacobian, GetParam().least_jacobian) << factor;
  }
}

TEST_P(RoundMesh, every_node_belongs_to_an_element_and_stands_alone) {
  const auto m = GetParam().at(2);
  std::map<std::tuple<long, long, long>, int> places;
  for (std::int64_t i = 0; i < m->n_nodes(); ++i) {
    const Vec3 x = m->node(i);
    const auto rounded = [](double v) { return std::lround(v * 1e7); };
    ++places[{rounded(x.x), rounded(x.y), rounded(x.z)}];
  }
  EXPECT_EQ(places.size(), static_cast<std::size_t>(m->n_nodes()));
  std::vector<char> used(static_cast<std::size_t>(m->n_nodes()));
  for (std::int64_t e = 0; e < m->n_elements(); ++e) {
    const auto nodes = m->element(e);
    for (std::size_t k = 0; k < 8; ++k) used[static_cast<std::size_t>(nodes[k])] = 1;
  }
  EXPECT_EQ(std::count(used.begin(), used.end(), 0), 0);
}

TEST_P(RoundMesh, exterior_facets_lie_on_named_faces) {
  const auto m = GetParam().at(2);
  std::map<std::array<std::int64_t, 4>, int> facets;
  for (std::int64_t e = 0; e < m->n_elements(); ++e) {
    const auto n = m->element(e);
    for (const std::array<int, 4> f : {std::array{0, 3, 2, 1}, std::array{4, 5, 6, 7}, std::array{0, 1, 5, 4},
                                       std::array{1, 2, 6, 5}, std::array{2, 3, 7, 6}, std::array{3, 0, 4, 7}}) {
      std::array<std::int64_t, 4> key{};
      for (std::size_t c = 0; c < 4; ++c) key[c] = n[static_cast<std::size_t>(f[c])];
      std::sort(key.begin(), key.end());
      ++facets[key];
    }
  }
  const int n_faces = static_cast<int>(m->face_names().size());
  for (const auto& [nodes, times] : facets) {
    EXPECT_LE(times, 2);
    int n_on = 0;
    for (int f = 0; f < n_faces; ++f)
      n_on += std::all_of(nodes.begin(), nodes.end(), [&](std::int64_t i) { return m->on_face(i, f); });
    EXPECT_EQ(n_on, times == 1 ? 1 : 0);
  }
}

INSTANTIATE_TEST_SUITE_P(
    All, RoundMesh,
    testing::Values(
        Family{"tube",
               "inner_radius: 1, outer_radius: 2, length: 3",
               "radial_cells: %d, circumferential_cells: %d, axial_cells: %d",
               {2, 12, 2},
               9.0 * pi,
               0.8},
        Family{"tube",
               "inner_radius: 1, outer_radius: 2, length: 3, sector: half, radial_ratio: 2, axial_ratio: 0.5",
               "radial_cells: %d, circumferential_cells: %d, axial_cells: %d",
               {2, 6, 2},
               4.5 * pi,
               0.8},
        Family{"tube",
               "inner_radius: 1, outer_radius: 2, length: 3, sector: quarter",
               "radial_cells: %d, circumferential_cells: %d, axial_cells: %d",
               {2, 3, 2},
               2.25 * pi,
               0.8},
        Family{"tube",
               "inner_radius: 1, outer_radius: 2, length: 3, angle: 100 deg",
               "radial_cells: %d, circumferential_cells: %d, axial_cells: %d",
               {2, 3, 2},
               2.5 * pi,
               0.8},
        Family{"sphere", "radius: 1", "core_cells: %d, ring_cells: %d", {2, 2}, 4.0 / 3.0 * pi, 0.4},
        Family{"sphere", "radius: 1, sector: half", "core_cells: %d, ring_cells: %d", {2, 2}, 2.0 / 3.0 * pi, 0.4},
        Family{"sphere", "radius: 1, sector: quarter", "core_cells: %d, ring_cells: %d", {2, 2}, pi / 3.0, 0.4},
        Family{"sphere", "radius: 1, sector: eighth", "core_cells: %d, ring_cells: %d", {2, 2}, pi / 6.0, 0.4},
        Family{"spherical_shell",
               "inner_radius: 1, outer_radius: 2",
               "radial_cells: %d, angular_cells: %d",
               {2, 4},
               shell_volume,
               0.6},
        Family{"spherical_shell",
               "inner_radius: 1, outer_radius: 2, sector: half",
               "radial_cells: %d, angular_cells: %d",
               {2, 4},
               shell_volume / 2.0,
               0.6},
        Family{"spherical_shell",
               "inner_radius: 1, outer_radius: 2, sector: quarter",
               "radial_cells: %d, angular_cells: %d",
               {2, 4},
               shell_volume / 4.0,
               0.6},
        Family{"spherical_shell",
               "inner_radius: 1, outer_radius: 2, sector: eighth, radial_ratio: 3",
               "radial_cells: %d, angular_cells: %d",
               {2, 4},
               shell_volume / 8.0,
               0.6},
        Family{"spherical_sector",
               "inner_radius: 1, outer_radius: 2, angle_x: 30 deg, angle_y: 30 deg",
               "radial_cells: %d, cells_x: %d, cells_y: %d",
               {2, 1, 1},
               sector_volume,
               0.8}));

TEST(RoundMeshes, refuse_what_cannot_be_meshed) {
  EXPECT_NE(kerf::test::refusal("mesh", "tube", "{inner_radius: 2, outer_radius: 2, length: 1, cell_size: 0.1}")
                .find("inner_radius must be less than outer_radius"),
            std::string::npos);
  EXPECT_NE(kerf::test::refusal("mesh", "spherical_shell", "{inner_radius: 3, outer_radius: 2, cell_size: 0.1}")
                .find("inner_radius must be less than outer_radius"),
            std::string::npos);
  EXPECT_NE(kerf::test::refusal("mesh", "spherical_shell",
                                "{inner_radius: 1, outer_radius: 2, radial_cells: 2, angular_cells: 5}")
                .find("give an even number"),
            std::string::npos);
  EXPECT_EQ(complaint("tube",
                      "{inner_radius: 1, outer_radius: 2, length: 1, radial_cells: 1, axial_cells: 1, "
                      "circumferential_cells: 5}"),
            "5 cells around 360 degrees are too few; at least 6 are needed, so that none is wider than 60 degrees");
  EXPECT_EQ(complaint("tube", "{inner_radius: 1, outer_radius: 2, length: 1, cell_size: 1.5}"),
            "cell_size (1.5 m) is larger than the thickness (1 m)");
  EXPECT_EQ(complaint("sphere", "{radius: 1, cell_size: 0.6}"),
            "cell_size (0.6 m) is larger than half of the radius (1 m)");
}

}  // namespace
