// Axis-aligned boxes of hexahedra.
#include "block_generator.hpp"

#include <algorithm>
#include <cmath>

#include <fmt/format.h>

#include "kerf/meshes/grading.hpp"
#include "kerf/plugin.hpp"

namespace kerf {

namespace {

constexpr const char* axis_names = "xyz";
// Lengths that should meet but were written with different units or digits may differ by this much.
constexpr double meeting_tolerance = 1e-9;
// The number of cells of a box must fit 64 bits.
constexpr std::int64_t most_cells = 2'000'000;

}  // namespace

void GradingInput::describe(Schema<GradingInput>& s) {
  s.real(&GradingInput::to, "to", "m", positive, "where the stretch ends, measured from the box's corner");
  s.integer(&GradingInput::cells, "cells", between(1, most_cells), "cells of the stretch");
  s.real(&GradingInput::ratio, "ratio", "-", positive, "size of its last cell over that of its first")
      .by_default("1.0");
}

void RefineAxisInput::describe(Schema<RefineAxisInput>& s) {
  s.real(&RefineAxisInput::from, "from", "m", non_negative, "where the fine cells begin, from the box's corner");
  s.real(&RefineAxisInput::to, "to", "m", positive, "where they end");
  s.real(&RefineAxisInput::size, "size", "m", positive, "size of the fine cells");
  s.real(&RefineAxisInput::growth, "growth", "-", Range{1.0, 10.0, true, false},
         "largest ratio of neighbouring cells outside, up to the box's cell size")
      .by_default("1.15");
  s.rule("to", "the fine cells must end after they begin", [](const RefineAxisInput& r) { return r.to > r.from; });
}

void RefineZoneInput::describe(Schema<RefineZoneInput>& s) {
  s.vector(&RefineZoneInput::center, "center", "m", any_value, "middle of the fine zone, from the box's corner");
  s.vector(
      &RefineZoneInput::size, "size", "m", non_negative,
      "extent of the fine zone; zero along an axis that is not refined, and what sticks out of the box is cut off");
  s.real(&RefineZoneInput::factor, "factor", "-", Range{1.0, 1000.0, true, false},
         "how many times smaller the cells in the zone are");
  s.real(&RefineZoneInput::growth, "growth", "-", Range{1.0, 10.0, true, false},
         "largest ratio of neighbouring cells outside, up to the box's cell size")
      .by_default("1.15");
  s.rule("size", "the fine zone has no extent along any axis",
         [](const RefineZoneInput& z) { return z.size.x > 0.0 || z.size.y > 0.0 || z.size.z > 0.0; });
}

void BlockGenerator::describe(Schema<BlockGenerator>& s) {
  using B = BlockGenerator;
  s.vector(&B::size, "size", "m", positive, "lengths of the edges");
  s.vector(&B::origin, "origin", "m", any_value, "corner with the least coordinates").by_default("[0, 0, 0] m");
  s.integers(&B::cells, "cells", between(1, most_cells),
             "number of cells along x, y and z (the coarse ones, if refined)")
      .optional();
  s.real(&B::cell_size, "cell_size", "m", positive, "cell size aimed at along all axes").optional();
  s.block_list(&B::grading_x, "grading_x", "stretches of cells along x in place of uniform ones").optional();
  s.block_list(&B::grading_y, "grading_y", "stretches of cells along y in place of uniform ones").optional();
  s.block_list(&B::grading_z, "grading_z", "stretches of cells along z in place of uniform ones").optional();
  s.optional_block(&B::refine_x, "refine_x", "fine cells in an interval of x");
  s.optional_block(&B::refine_y, "refine_y", "fine cells in an interval of y");
  s.optional_block(&B::refine_z, "refine_z", "fine cells in an interval of z");
  s.optional_block(&B::refine, "refine", "fine cells in a zone, given by its middle and extent");
  s.rule("cells", "cells takes three whole numbers, along x, y and z",
         [](const B& b) { return b.cells.empty() || b.cells.size() == 3; });
  s.rule("size", "give either cells or cell_size (neither is needed where all three axes have a grading)",
         [](const B& b) {
           const bool all_graded = !b.grading_x.empty() && !b.grading_y.empty() && !b.grading_z.empty();
           const int given = (b.cells.empty() ? 0 : 1) + (b.cell_size > 0.0 ? 1 : 0);
           return given == 1 || (given == 0 && all_graded);
         });
}

std::vector<std::string> BlockGenerator::prepare() {
  std::vector<std::string> errors;
  for (int axis = 0; axis < 3; ++axis) {
    auto lines = axis_lines(axis, errors);
    for (double& x : lines) x += origin[axis];
    const auto a = static_cast<std::size_t>(axis);
    n_[a] = static_cast<std::int64_t>(lines.size());
    lines_[a] = std::move(lines);
  }
  return errors;
}

std::vector<double> BlockGenerator::axis_lines(int axis, std::vector<std::string>& errors) const {
  const char name = axis_names[axis];
  const double length = size[axis];
  const bool graded = !grading(axis).empty();
  const RefineAxisInput* zone = refinement(axis);
  const bool in_zone = refine && refine->size[axis] > 0.0;
  if (graded + (zone != nullptr) + in_zone > 1) {
    errors.push_back(fmt::format("along {0} only one of grading_{0}, refine_{0} and refine can be used", name));
    return {0.0, length};
  }
  if (graded) return graded_axis(axis, errors);

  if (cell_size > length)
    errors.push_back(
        fmt::format("cell_size ({:g} m) is larger than the box along {} ({:g} m)", cell_size, name, length));
  if (cell_size > 0.0 && length / cell_size > static_cast<double>(most_cells)) {
    errors.push_back(fmt::format("cell_size ({:g} m) makes {:.3g} cells along {} ({:g} m); at most {} are possible",
                                 cell_size, length / cell_size, name, length, most_cells));
    return {0.0, length};
  }
  const std::int64_t n = cells.empty() ? cells_along(length, cell_size) : cells[static_cast<std::size_t>(axis)];
  const double coarse = length / static_cast<double>(n);
  if (zone) return refined_axis(axis, coarse, *zone, errors);
  if (in_zone) return zone_axis(axis, coarse, errors);
  return graded_lines(0.0, length, n, 1.0);
}

std::vector<double> BlockGenerator::graded_axis(int axis, std::vector<std::string>& errors) const {
  const double length = size[axis];
  std::vector<double> lines{0.0};
  for (const auto& stretch : grading(axis)) {
    if (stretch->to <= lines.back()) {
      errors.push_back(fmt::format("grading_{}: the stretch to {:g} m ends before it begins ({:g} m)", axis_names[axis],
                                   stretch->to, lines.back()));
      return {0.0, length};
    }
    const auto part = graded_lines(lines.back(), stretch->to, stretch->cells, stretch->ratio);
    lines.insert(lines.end(), part.begin() + 1, part.end());
  }
  if (std::abs(lines.back() - length) > meeting_tolerance * length) {
    errors.push_back(fmt::format("grading_{0}: the last stretch ends at {1:g} m, but the box is {2:g} m long along {0}",
                                 axis_names[axis], lines.back(), length));
    return {0.0, length};
  }
  lines.back() = length;
  return lines;
}

std::vector<double> BlockGenerator::refined_axis(int axis, double coarse, const RefineAxisInput& zone,
                                                 std::vector<std::string>& errors) const {
  const char name = axis_names[axis];
  const double length = size[axis];
  const std::size_t n_errors = errors.size();
  if (zone.to > length * (1.0 + meeting_tolerance))
    errors.push_back(
        fmt::format("refine_{0}: the fine cells end at {1:g} m, outside the box, which is {2:g} m long "
                    "along {0}",
                    name, zone.to, length));
  if (zone.size > coarse * (1.0 + meeting_tolerance))
    errors.push_back(
        fmt::format("refine_{}: the fine cells ({:g} m) are larger than the others ({:g} m)", name, zone.size, coarse));
  if (zone.size > (zone.to - zone.from) * (1.0 + meeting_tolerance))
    errors.push_back(fmt::format("refine_{}: cells of {:g} m do not fit between {:g} m and {:g} m", name, zone.size,
                                 zone.from, zone.to));
  if (errors.size() > n_errors) return {0.0, length};
  return refined_lines(length,
                       {zone.from, std::min(zone.to, length), std::min(zone.size, coarse), zone.growth, coarse});
}

std::vector<double> BlockGenerator::zone_axis(int axis, double coarse, std::vector<std::string>& errors) const {
  const double length = size[axis];
  const double half = 0.5 * refine->size[axis];
  const double from = std::max(0.0, refine->center[axis] - half), to = std::min(length, refine->center[axis] + half);
  if (!(to > from)) {
    errors.push_back(
        fmt::format("refine: the zone lies outside the box along {} (0 to {:g} m)", axis_names[axis], length));
    return {0.0, length};
  }
  return refined_lines(length, {from, to, coarse / refine->factor, refine->growth, coarse});
}

ElementNodeIds BlockGenerator::element(std::int64_t e) const {
  const std::int64_t nx = n_[0] - 1, ny = n_[1] - 1;
  const std::int64_t i = e % nx, j = e / nx % ny, k = e / (nx * ny);
  const std::int64_t a = (k * n_[1] + j) * n_[0] + i, up = n_[0] * n_[1];
  return {a, a + 1, a + n_[0] + 1, a + n_[0], a + up, a + up + 1, a + up + n_[0] + 1, a + up + n_[0]};
}

std::vector<std::string> BlockGenerator::face_names() const {
  return {"x_min", "x_max", "y_min", "y_max", "z_min", "z_max"};
}

bool BlockGenerator::on_face(std::int64_t i, int face) const {
  const auto axis = static_cast<std::size_t>(face / 2);
  const std::int64_t line = axis == 0 ? i % n_[0] : axis == 1 ? i / n_[0] % n_[1] : i / (n_[0] * n_[1]);
  return line == (face % 2 == 0 ? 0 : n_[axis] - 1);
}

}  // namespace kerf

KERF_REGISTER(KERF_TYPE(kerf::BlockGenerator, "mesh", "block",
                        "axis-aligned box of hexahedra, uniform, graded or refined in intervals of each axis"))
