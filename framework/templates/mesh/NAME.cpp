// A block of hexahedra with a wavy upper face: the start of instabilities, and of jets that shocks drive out of
// grooves.
#include <kerf/functions.hpp>
#include <kerf/mesh.hpp>
#include <kerf/plugin.hpp>

namespace {

using namespace kerf;

/// The box [0, size] whose face z_max is at z = size_z + a sin(2 pi n x / size_x); nodes between the faces are moved in
/// proportion to their height. x runs fastest in the numbering.
struct @TYPE@ final : MeshGenerator {
  Vec3 size, origin;  // [m]
  std::vector<std::int64_t> cells;
  double amplitude = 0.0;  // [m]
  std::int64_t waves = 1;

  static void describe(Schema<@TYPE@>& s) {
    s.vector(&@TYPE@::size, "size", "m", positive,
             "lengths of the edges, z from the lower face to the mean of the wave");
    s.vector(&@TYPE@::origin, "origin", "m", any_value, "corner of least coordinates").by_default("[0, 0, 0] m");
    s.integers(&@TYPE@::cells, "cells", between(1, 2000000), "number of cells along x, y and z");
    s.real(&@TYPE@::amplitude, "amplitude", "m", non_negative, "height of the wave's crests over its mean");
    s.integer(&@TYPE@::waves, "waves", positive, "whole waves along x").by_default("1");
    s.rule("cells", "cells takes three whole numbers, along x, y and z",
           [](const @TYPE@& m) { return m.cells.size() == 3; });
    s.rule("cells", "a wave takes at least four cells along x",
           [](const @TYPE@& m) { return m.cells.size() != 3 || m.cells[0] >= 4 * m.waves; });
    s.rule("amplitude", "amplitude must be less than the height of the block",
           [](const @TYPE@& m) { return m.amplitude < m.size.z; });
  }
  std::vector<std::string> prepare() override { return {}; }  // the rules above have said all

  std::int64_t n_nodes() const override { return (cells[0] + 1) * (cells[1] + 1) * (cells[2] + 1); }
  std::int64_t n_elements() const override { return cells[0] * cells[1] * cells[2]; }
  Vec3 node(std::int64_t i) const override {
    const double x = share(i, 0), y = share(i, 1), z = share(i, 2);
    const double top = size.z + amplitude * kerf::sin(2.0 * pi * static_cast<double>(waves) * x);
    return origin + Vec3{size.x * x, size.y * y, top * z};
  }
  ElementNodeIds element(std::int64_t e) const override {
    const std::int64_t i = e % cells[0], j = e / cells[0] % cells[1], k = e / (cells[0] * cells[1]);
    const std::int64_t row = cells[0] + 1, layer = row * (cells[1] + 1), a = k * layer + j * row + i;
    return {a, a + 1, a + row + 1, a + row, a + layer, a + layer + 1, a + layer + row + 1, a + layer + row};
  }
  std::vector<std::string> face_names() const override {
    return {"x_min", "x_max", "y_min", "y_max", "z_min", "z_max"};
  }
  bool on_face(std::int64_t i, int face) const override {
    return line(i, face / 2) == (face % 2 == 0 ? 0 : cells[static_cast<std::size_t>(face / 2)]);
  }

 private:
  static constexpr double pi = 3.14159265358979324;
  /// The place of a node along an axis, in cells.
  std::int64_t line(std::int64_t i, int axis) const {
    const std::int64_t row = cells[0] + 1, layer = row * (cells[1] + 1);
    return axis == 0 ? i % row : axis == 1 ? i % layer / row : i / layer;
  }
  /// The same from 0 to 1.
  double share(std::int64_t i, int axis) const {
    return static_cast<double>(line(i, axis)) / static_cast<double>(cells[static_cast<std::size_t>(axis)]);
  }
};

}  // namespace

KERF_REGISTER(KERF_TYPE(@TYPE@, "mesh", "@NAME@", "block of hexahedra with a wavy upper face"))
