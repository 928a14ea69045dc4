// Hollow spheres of hexahedra: shells of the cubed sphere; and patches of them between planes through the centre.
#include <cmath>
#include <cstdint>
#include <string>
#include <vector>

#include <fmt/format.h>

#include "kerf/functions.hpp"
#include "kerf/mesh.hpp"
#include "kerf/meshes/cubed_sphere.hpp"
#include "kerf/meshes/grading.hpp"
#include "kerf/plugin.hpp"

namespace kerf {

namespace {

// The surface's names and the radii are kept in memory.
constexpr std::int64_t most_cells = 2000, most_layers = 10'000'000;
constexpr double quarter_pi = 0.78539816339744830962;

/// What both meshes take: radii, and cells through the thickness.
class RadialLayers : public MeshGenerator {
 public:
  double inner_radius = 0.0, outer_radius = 0.0, cell_size = 0.0;  // [m]; cell_size zero where counts are given
  std::int64_t radial_cells = 0;
  double radial_ratio = 1.0;

 protected:
  template <class S>
  static void describe_layers(S& s) {
    s.real(&RadialLayers::inner_radius, "inner_radius", "m", positive, "radius of the hole; its centre is the origin");
    s.real(&RadialLayers::outer_radius, "outer_radius", "m", positive, "radius of the outer surface");
    s.real(&RadialLayers::cell_size, "cell_size", "m", positive,
           "cell size aimed at, through the thickness and at half of it along the surface")
        .optional();
    s.integer(&RadialLayers::radial_cells, "radial_cells", between(1, most_layers), "cells through the thickness")
        .optional();
    s.real(&RadialLayers::radial_ratio, "radial_ratio", "-", positive,
           "size of the outermost cell over that of the innermost")
        .by_default("1.0");
    s.rule("inner_radius", "inner_radius must be less than outer_radius",
           [](const auto& g) { return g.inner_radius < g.outer_radius; });
  }
  double thickness() const { return outer_radius - inner_radius; }
  double mean_radius() const { return 0.5 * (inner_radius + outer_radius); }
  std::string complaint() const {
    if (cell_size > thickness() * (1.0 + 1e-9))
      return fmt::format("cell_size ({:g} m) is larger than the thickness ({:g} m)", cell_size, thickness());
    if (cell_size > 0.0 && thickness() / cell_size > static_cast<double>(most_layers))
      return fmt::format("cell_size ({:g} m) makes more than {} cells through the thickness", cell_size, most_layers);
    return {};
  }
  void lay() {
    const std::int64_t n = cell_size > 0.0 ? cells_along(thickness(), cell_size) : radial_cells;
    radii_ = graded_lines(inner_radius, outer_radius, n, radial_ratio);
  }
  std::int64_t n_layers() const { return static_cast<std::int64_t>(radii_.size()) - 1; }

  std::vector<double> radii_;
};

/// Nodes are numbered layer by layer from the inside outwards.
class SphericalShellGenerator final : public RadialLayers {
 public:
  std::int64_t angular_cells = 0;
  std::string sector = "full";

  static void describe(Schema<SphericalShellGenerator>& s) {
    using G = SphericalShellGenerator;
    describe_layers(s);
    s.integer(&G::angular_cells, "angular_cells", between(2, 2 * most_cells),
              "cells over 90 degrees of a great circle; an even number")
        .optional();
    s.choice(&G::sector, "sector", {"full", "half", "quarter", "eighth"},
             "part of the shell that is meshed: all, y >= 0, x >= 0 and y >= 0, or x, y and z >= 0")
        .by_default("full");
    s.rule("cell_size", "give either a cell_size or both of radial_cells and angular_cells", [](const G& g) {
      const int given = (g.radial_cells > 0) + (g.angular_cells > 0);
      return g.cell_size > 0.0 ? given == 0 : given == 2;
    });
    s.rule("angular_cells", "90 degrees hold two halves of the cube's faces: give an even number",
           [](const G& g) { return g.angular_cells % 2 == 0; });
  }
  std::vector<std::string> prepare() override {
    if (const std::string text = complaint(); !text.empty()) return {text};
    const double half_face = quarter_pi * mean_radius();
    if (cell_size > 0.0 && half_face / cell_size > static_cast<double>(most_cells))
      return {fmt::format("cell_size ({:g} m) makes more than {} cells over 45 degrees", cell_size, most_cells)};
    lay();
    const std::int64_t n = cell_size > 0.0 ? cells_along(half_face, cell_size) : angular_cells / 2;
    surface_ = CubedSphere(sector, static_cast<int>(n));
    return {};
  }
  std::int64_t n_nodes() const override { return (n_layers() + 1) * surface_.n_nodes(); }
  std::int64_t n_elements() const override { return n_layers() * surface_.n_quads(); }
  Vec3 node(std::int64_t i) const override {
    return surface_.direction(surface_.name(static_cast<int>(i % surface_.n_nodes()))) *
           radii_[static_cast<std::size_t>(i / surface_.n_nodes())];
  }
  ElementNodeIds element(std::int64_t e) const override {
    ElementNodeIds nodes{};
    const auto& quad = surface_.quad(static_cast<int>(e % surface_.n_quads()));
    for (std::size_t c = 0; c < 4; ++c) {
      nodes[c] = e / surface_.n_quads() * surface_.n_nodes() + quad[c];
      nodes[c + 4] = nodes[c] + surface_.n_nodes();
    }
    return nodes;
  }
  std::vector<std::string> face_names() const override {
    std::vector<std::string> names{"inner", "outer"};
    names.insert(names.end(), surface_.cut_names().begin(), surface_.cut_names().end());
    return names;
  }
  bool on_face(std::int64_t i, int face) const override {
    const std::int64_t layer = i / surface_.n_nodes();
    if (face < 2) return layer == (face == 0 ? 0 : n_layers());
    return surface_.on_cut(surface_.name(static_cast<int>(i % surface_.n_nodes())), face - 2);
  }

 private:
  CubedSphere surface_;
};

/// The shell between the planes x = 0 and x = z tan(angle_x), y = 0 and y = z tan(angle_y): a column of cells along
/// a radius for spherically symmetric problems. Nodes run along x, then y, then outwards.
class SphericalSectorGenerator final : public RadialLayers {
 public:
  double angle_x = 0.0, angle_y = 0.0;  // [rad]
  std::int64_t cells_x = 0, cells_y = 0;

  static void describe(Schema<SphericalSectorGenerator>& s) {
    using G = SphericalSectorGenerator;
    describe_layers(s);
    constexpr Range up_to_45_degrees{0.0, quarter_pi * (1.0 + 1e-12), true, false};
    s.real(&G::angle_x, "angle_x", "rad", up_to_45_degrees,
           "angle at the centre from the plane x = 0, up to 45 degrees");
    s.real(&G::angle_y, "angle_y", "rad", up_to_45_degrees,
           "angle at the centre from the plane y = 0, up to 45 degrees");
    s.integer(&G::cells_x, "cells_x", between(1, most_cells), "cells over angle_x").optional();
    s.integer(&G::cells_y, "cells_y", between(1, most_cells), "cells over angle_y").optional();
    s.rule("cell_size", "give either a cell_size or all of radial_cells, cells_x and cells_y", [](const G& g) {
      const int given = (g.radial_cells > 0) + (g.cells_x > 0) + (g.cells_y > 0);
      return g.cell_size > 0.0 ? given == 0 : given == 3;
    });
  }
  std::vector<std::string> prepare() override {
    if (const std::string text = complaint(); !text.empty()) return {text};
    lay();
    const double r = mean_radius();
    n_[0] = cell_size > 0.0 ? cells_along(angle_x * r, cell_size) : cells_x;
    n_[1] = cell_size > 0.0 ? cells_along(angle_y * r, cell_size) : cells_y;
    if (n_[0] > most_cells || n_[1] > most_cells)
      return {fmt::format("cell_size ({:g} m) makes more than {} cells over an angle", cell_size, most_cells)};
    return {};
  }
  std::int64_t n_nodes() const override { return (n_[0] + 1) * (n_[1] + 1) * (n_layers() + 1); }
  std::int64_t n_elements() const override { return n_[0] * n_[1] * n_layers(); }
  Vec3 node(std::int64_t i) const override {
    const auto [a, b, layer] = place(i);
    const Vec3 p{tangent(a, n_[0], angle_x), tangent(b, n_[1], angle_y), 1.0};
    return p * (radii_[static_cast<std::size_t>(layer)] / norm(p));
  }
  ElementNodeIds element(std::int64_t e) const override {
    const std::int64_t row = n_[0] + 1, up = row * (n_[1] + 1);
    const std::int64_t a = e / (n_[0] * n_[1]) * up + e / n_[0] % n_[1] * row + e % n_[0];
    return {a, a + 1, a + row + 1, a + row, a + up, a + up + 1, a + up + row + 1, a + up + row};
  }
  std::vector<std::string> face_names() const override {
    return {"inner", "outer", "symmetry_x", "symmetry_y", "oblique_x", "oblique_y"};
  }
  bool on_face(std::int64_t i, int face) const override {
    const auto [a, b, layer] = place(i);
    switch (face) {
      case 0:
        return layer == 0;
      case 1:
        return layer == n_layers();
      case 2:
        return a == 0;
      case 3:
        return b == 0;
      case 4:
        return a == n_[0];
      default:
        return b == n_[1];
    }
  }

 private:
  struct Place {
    std::int64_t a, b, layer;
  };
  Place place(std::int64_t i) const {
    const std::int64_t row = n_[0] + 1;
    return {i % row, i / row % (n_[1] + 1), i / (row * (n_[1] + 1))};
  }
  static double tangent(std::int64_t a, std::int64_t n, double angle) {
    return kerf::tan(angle * (static_cast<double>(a) / static_cast<double>(n)));
  }

  std::int64_t n_[2] = {1, 1};
};

}  // namespace

}  // namespace kerf

KERF_REGISTER(KERF_TYPE(kerf::SphericalShellGenerator, "mesh", "spherical_shell",
                        "hollow sphere of hexahedra: whole, half, quarter or eighth")
                  KERF_TYPE(kerf::SphericalSectorGenerator, "mesh", "spherical_sector",
                            "column of hexahedra along a radius between four planes through the centre"))
