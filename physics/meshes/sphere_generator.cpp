// Solid spheres of hexahedra.
#include "sphere_generator.hpp"

#include <algorithm>
#include <cmath>

#include <fmt/format.h>

#include "kerf/meshes/grading.hpp"
#include "kerf/plugin.hpp"

namespace kerf {

namespace {

// The surface's names are kept in memory.
constexpr int most_cells = 2000;
// About so much of the cells along a radius belongs to the core: then cells at the surface are as wide as at the
// centre.
constexpr double core_share = 0.55;
// How far the faces of the core bulge outwards: 0 is a cube with flat faces, 1 a part of a sphere. In between, the
// three cells that meet at an edge of the core, and the four at a vertex, share the space about equally; found by
// trial.
constexpr double bulge = 0.5;

}  // namespace

void SphereGenerator::describe(Schema<SphereGenerator>& s) {
  using G = SphereGenerator;
  s.real(&G::radius, "radius", "m", positive, "radius of the sphere, whose centre is the origin");
  s.real(&G::cell_size, "cell_size", "m", positive, "cell size aimed at").optional();
  s.integer(&G::core_cells, "core_cells", between(1, most_cells), "cells from the centre to a face of the core")
      .optional();
  s.integer(&G::ring_cells, "ring_cells", between(1, most_cells), "cells from the core to the surface").optional();
  s.choice(&G::sector, "sector", {"full", "half", "quarter", "eighth"},
           "part of the sphere that is meshed: all, y >= 0, x >= 0 and y >= 0, or x, y and z >= 0")
      .by_default("full");
  s.rule("cell_size", "give either a cell_size or both of core_cells and ring_cells", [](const G& g) {
    const int given = (g.core_cells > 0) + (g.ring_cells > 0);
    return g.cell_size > 0.0 ? given == 0 : given == 2;
  });
}

std::vector<std::string> SphereGenerator::prepare() {
  if (cell_size > 0.5 * radius)
    return {fmt::format("cell_size ({:g} m) is larger than half of the radius ({:g} m)", cell_size, radius)};
  if (cell_size > 0.0 && radius / cell_size > most_cells)
    return {fmt::format("cell_size ({:g} m) makes {:.3g} cells along the radius ({:g} m); at most {} are possible",
                        cell_size, radius / cell_size, radius, most_cells)};
  std::int64_t n_core = core_cells;
  n_ring_ = ring_cells;
  if (cell_size > 0.0) {
    n_core = cells_along(core_share * radius, cell_size);
    n_ring_ = std::max<std::int64_t>(1, cells_along(radius, cell_size) - n_core);
  }
  surface_ = CubedSphere(sector, static_cast<int>(n_core));
  n_core_nodes_ = n_core_elements_ = 1;
  for (int axis = 0; axis < 3; ++axis) {
    n_[axis] = n_core - surface_.first(axis) + 1;
    n_core_nodes_ *= n_[axis];
    n_core_elements_ *= n_[axis] - 1;
  }
  // On the way out to a face's middle, cells of core and ring are equally long.
  middle_ = static_cast<double>(n_core) / static_cast<double>(n_core + n_ring_);
  return {};
}

SphereGenerator::Place SphereGenerator::place(std::int64_t i) const {
  if (i < n_core_nodes_)
    return {{static_cast<int>(i % n_[0]) + surface_.first(0), static_cast<int>(i / n_[0] % n_[1]) + surface_.first(1),
             static_cast<int>(i / (n_[0] * n_[1])) + surface_.first(2)},
            0};
  const std::int64_t beyond = i - n_core_nodes_;
  return {surface_.name(static_cast<int>(beyond % surface_.n_nodes())), beyond / surface_.n_nodes() + 1};
}

// A blend of a cube with the image of its shells on spheres.
Vec3 SphereGenerator::core_point(const CubedSphere::Node& p) const {
  const double n = surface_.n();
  const Vec3 cube{p.i / n, p.j / n, p.k / n};
  const double shell = std::max({std::fabs(cube.x), std::fabs(cube.y), std::fabs(cube.z)});
  if (shell == 0.0) return {};
  // The ball's image of a cube's shell grows rounder towards the surface of the core.
  const Vec3 round = cube * (shell / norm(cube));
  const double share = bulge * shell;
  return (cube * (1.0 - share) + round * share) * middle_;
}

Vec3 SphereGenerator::node(std::int64_t i) const {
  const Place p = place(i);
  const Vec3 inner = core_point(p.name);
  if (p.shell == 0) return inner * radius;
  const double t = static_cast<double>(p.shell) / static_cast<double>(n_ring_);
  return (inner * (1.0 - t) + surface_.direction(p.name) * t) * radius;
}

std::int64_t SphereGenerator::core_index(const CubedSphere::Node& p) const {
  return ((p.k - surface_.first(2)) * n_[1] + p.j - surface_.first(1)) * n_[0] + p.i - surface_.first(0);
}

std::int64_t SphereGenerator::index(int surface_node, std::int64_t shell) const {
  if (shell == 0) return core_index(surface_.name(surface_node));
  return n_core_nodes_ + (shell - 1) * surface_.n_nodes() + surface_node;
}

ElementNodeIds SphereGenerator::element(std::int64_t e) const {
  ElementNodeIds nodes{};
  if (e < n_core_elements_) {
    const std::int64_t nx = n_[0] - 1, ny = n_[1] - 1;
    const std::int64_t a = (e / (nx * ny) * n_[1] + e / nx % ny) * n_[0] + e % nx, up = n_[0] * n_[1];
    return {a, a + 1, a + n_[0] + 1, a + n_[0], a + up, a + up + 1, a + up + n_[0] + 1, a + up + n_[0]};
  }
  const std::int64_t beyond = e - n_core_elements_, shell = beyond / surface_.n_quads();
  const auto& quad = surface_.quad(static_cast<int>(beyond % surface_.n_quads()));
  for (std::size_t c = 0; c < 4; ++c) {
    nodes[c] = index(quad[c], shell);
    nodes[c + 4] = index(quad[c], shell + 1);
  }
  return nodes;
}

std::vector<std::string> SphereGenerator::face_names() const {
  std::vector<std::string> names{"outer"};
  names.insert(names.end(), surface_.cut_names().begin(), surface_.cut_names().end());
  return names;
}

bool SphereGenerator::on_face(std::int64_t i, int face) const {
  const Place p = place(i);
  return face == 0 ? p.shell == n_ring_ : surface_.on_cut(p.name, face - 1);
}

}  // namespace kerf

KERF_REGISTER(KERF_TYPE(kerf::SphereGenerator, "mesh", "sphere",
                        "solid sphere of hexahedra: whole, half, quarter or eighth"))
