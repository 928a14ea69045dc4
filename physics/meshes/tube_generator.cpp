// Tubes along z of hexahedra: whole, half, quarter, or a sector of any angle.
#include <cmath>
#include <cstdint>
#include <string>
#include <vector>

#include <fmt/format.h>

#include "kerf/functions.hpp"
#include "kerf/mesh.hpp"
#include "kerf/meshes/grading.hpp"
#include "kerf/plugin.hpp"

namespace kerf {

namespace {

constexpr double pi = 3.14159265358979323846;
// Lines along the three directions are kept in memory.
constexpr std::int64_t most_cells = 10'000'000;
// A flat cell over a larger angle has lost too much of its arc to stand for it.
constexpr double widest_cell = 60.0 * pi / 180.0;

/// Nodes are numbered along the radius, then around, then along z.
class TubeGenerator final : public MeshGenerator {
 public:
  double inner_radius = 0.0, outer_radius = 0.0, length = 0.0, cell_size = 0.0;  // [m]
  std::int64_t radial_cells = 0, circumferential_cells = 0, axial_cells = 0;
  double radial_ratio = 1.0, axial_ratio = 1.0;
  std::string sector = "full";
  double angle = 0.0;  // [rad]; zero where absent

  static void describe(Schema<TubeGenerator>& s);

  std::vector<std::string> prepare() override;
  std::int64_t n_nodes() const override { return n_radii() * n_around() * n_planes(); }
  std::int64_t n_elements() const override { return (n_radii() - 1) * n_cells_around_ * (n_planes() - 1); }
  Vec3 node(std::int64_t i) const override;
  ElementNodeIds element(std::int64_t e) const override;
  std::vector<std::string> face_names() const override;
  bool on_face(std::int64_t i, int face) const override;

 private:
  std::int64_t n_radii() const { return static_cast<std::int64_t>(radii_.size()); }
  std::int64_t n_planes() const { return static_cast<std::int64_t>(z_.size()); }
  /// Nodes on a circle.
  std::int64_t n_around() const { return is_closed() ? n_cells_around_ : n_cells_around_ + 1; }
  bool is_closed() const { return angle == 0.0 && sector == "full"; }
  double sector_angle() const {
    return angle > 0.0 ? angle : sector == "full" ? 2.0 * pi : sector == "half" ? pi : 0.5 * pi;
  }

  std::vector<double> radii_, z_;  // [m]
  std::vector<double> cosine_, sine_;  // of the azimuths
  std::int64_t n_cells_around_ = 1;
};

void TubeGenerator::describe(Schema<TubeGenerator>& s) {
  using T = TubeGenerator;
  s.real(&T::inner_radius, "inner_radius", "m", positive, "radius of the hole along z");
  s.real(&T::outer_radius, "outer_radius", "m", positive, "radius of the outer surface");
  s.real(&T::length, "length", "m", positive, "length along z, from the origin");
  s.real(&T::cell_size, "cell_size", "m", positive,
         "cell size aimed at along all three directions, around at half of the thickness")
      .optional();
  s.integer(&T::radial_cells, "radial_cells", between(1, most_cells), "cells through the thickness").optional();
  s.integer(&T::circumferential_cells, "circumferential_cells", between(1, most_cells),
            "cells around, over the sector that is meshed")
      .optional();
  s.integer(&T::axial_cells, "axial_cells", between(1, most_cells), "layers along the tube").optional();
  s.real(&T::radial_ratio, "radial_ratio", "-", positive, "size of the outermost cell over that of the innermost")
      .by_default("1.0");
  s.real(&T::axial_ratio, "axial_ratio", "-", positive, "size of the last layer over that of the first")
      .by_default("1.0");
  s.choice(&T::sector, "sector", {"full", "half", "quarter"},
           "part of the tube that is meshed: all, y >= 0, or x >= 0 and y >= 0")
      .by_default("full");
  s.real(
       &T::angle, "angle", "rad", Range{0.0, pi, true, false},
       "in place of a sector: the angle, up to 180 degrees, from the half-plane y = 0, x > 0 towards y, that is meshed")
      .optional();
  s.rule("inner_radius", "inner_radius must be less than outer_radius; for a rod without a hole use the mesh cylinder",
         [](const T& t) { return t.inner_radius < t.outer_radius; });
  s.rule("angle", "give either a sector or an angle", [](const T& t) { return t.angle == 0.0 || t.sector == "full"; });
  s.rule("cell_size", "give either a cell_size or all of radial_cells, circumferential_cells and axial_cells",
         [](const T& t) {
           const int given = (t.radial_cells > 0) + (t.circumferential_cells > 0) + (t.axial_cells > 0);
           return t.cell_size > 0.0 ? given == 0 : given == 3;
         });
}

std::vector<std::string> TubeGenerator::prepare() {
  const double thickness = outer_radius - inner_radius, arc = sector_angle() * 0.5 * (inner_radius + outer_radius);
  const auto room = [&](double along, const char* what) -> std::string {
    if (cell_size > along * (1.0 + 1e-9))
      return fmt::format("cell_size ({:g} m) is larger than the {} ({:g} m)", cell_size, what, along);
    if (cell_size > 0.0 && along / cell_size > static_cast<double>(most_cells))
      return fmt::format("cell_size ({:g} m) makes more than {} cells along the {} ({:g} m)", cell_size, most_cells,
                         what, along);
    return {};
  };
  std::vector<std::string> errors;
  for (const std::string& text : {room(thickness, "thickness"), room(length, "length"), room(arc, "arc")})
    if (!text.empty()) errors.push_back(text);
  if (!errors.empty()) return errors;
  const auto count = [&](double along, std::int64_t given) {
    return given > 0 ? given : cells_along(along, cell_size);
  };
  n_cells_around_ = count(arc, circumferential_cells);
  const auto least = static_cast<std::int64_t>(std::ceil(sector_angle() / widest_cell * (1.0 - 1e-12)));
  if (n_cells_around_ < least)
    return {
        fmt::format("{} cell{} around {:g} degrees are too few; at least {} are needed, so that none is wider than 60 "
                    "degrees",
                    n_cells_around_, n_cells_around_ == 1 ? "" : "s", sector_angle() * 180.0 / pi, least)};
  radii_ = graded_lines(inner_radius, outer_radius, count(thickness, radial_cells), radial_ratio);
  z_ = graded_lines(0.0, length, count(length, axial_cells), axial_ratio);
  for (std::int64_t m = 0; m < n_around(); ++m) {
    const double azimuth = sector_angle() * (static_cast<double>(m) / static_cast<double>(n_cells_around_));
    // Exact zeros keep nodes on the planes of symmetry.
    const auto kept = [](double v) { return std::fabs(v) < 1e-15 ? 0.0 : v; };
    cosine_.push_back(kept(kerf::cos(azimuth)));
    sine_.push_back(kept(kerf::sin(azimuth)));
  }
  return {};
}

Vec3 TubeGenerator::node(std::int64_t i) const {
  const double r = radii_[static_cast<std::size_t>(i % n_radii())];
  const auto m = static_cast<std::size_t>(i / n_radii() % n_around());
  return {r * cosine_[m], r * sine_[m], z_[static_cast<std::size_t>(i / (n_radii() * n_around()))]};
}

ElementNodeIds TubeGenerator::element(std::int64_t e) const {
  const std::int64_t nr = n_radii() - 1, k = e % nr, m = e / nr % n_cells_around_;
  const std::int64_t bottom = e / (nr * n_cells_around_) * n_radii() * n_around(), up = n_radii() * n_around();
  const std::int64_t a = bottom + m * n_radii() + k, b = bottom + (m + 1) % n_around() * n_radii() + k;
  return {a, a + 1, b + 1, b, a + up, a + up + 1, b + up + 1, b + up};
}

std::vector<std::string> TubeGenerator::face_names() const {
  std::vector<std::string> names{"z_min", "z_max", "inner", "outer"};
  if (!is_closed()) names.push_back("symmetry_y");
  if (angle > 0.0) names.push_back("symmetry_end");
  if (sector == "quarter") names.push_back("symmetry_x");
  return names;
}

bool TubeGenerator::on_face(std::int64_t i, int face) const {
  const std::int64_t m = i / n_radii() % n_around(), layer = i / (n_radii() * n_around());
  switch (face) {
    case 0:
      return layer == 0;
    case 1:
      return layer == n_planes() - 1;
    case 2:
      return i % n_radii() == 0;
    case 3:
      return i % n_radii() == n_radii() - 1;
    case 4:  // both ends of a half lie on one plane
      return m == 0 || (sector == "half" && m == n_cells_around_);
    default:
      return m == n_cells_around_;
  }
}

}  // namespace

}  // namespace kerf

KERF_REGISTER(KERF_TYPE(kerf::TubeGenerator, "mesh", "tube",
                        "tube along z of hexahedra: whole, half, quarter or a sector of any angle"))
