// A mesh generator outside of Kerf's tree: a round rod along z whose radius changes evenly from one end to the other.
#include <kerf/mesh.hpp>
#include <kerf/meshes/butterfly_section.hpp>
#include <kerf/meshes/grading.hpp>
#include <kerf/plugin.hpp>

/// Layers of the butterfly section, each as wide as the rod is there.
struct TaperedRod final : kerf::MeshGenerator {
  double radius = 0.0, end_radius = 0.0, length = 0.0, cell_size = 0.0, ratio = 1.0;  // [m], the last one [-]
  std::string sector = "full";

  static void describe(kerf::Schema<TaperedRod>& s) {
    s.real(&TaperedRod::radius, "radius", "m", kerf::positive, "radius at z = 0");
    s.real(&TaperedRod::end_radius, "end_radius", "m", kerf::positive, "radius at the other end");
    s.real(&TaperedRod::length, "length", "m", kerf::positive, "length along z");
    s.real(&TaperedRod::cell_size, "cell_size", "m", kerf::positive, "size of cells, about");
    s.real(&TaperedRod::ratio, "ratio", "-", kerf::positive, "length of the last cell along z over that of the first")
        .by_default("1");
    s.choice(&TaperedRod::sector, "sector", {"full", "half", "quarter"}, "half has y >= 0, quarter x >= 0 as well")
        .by_default("full");
  }

  std::vector<std::string> prepare() override {
    const double widest = radius > end_radius ? radius : end_radius;
    if (widest < 2.0 * cell_size) return {"`cell_size` must be at most half of the greater radius"};
    const std::int64_t across = kerf::cells_along(widest, cell_size), core = across / 2;
    section_ = kerf::ButterflySection(sector, static_cast<int>(core), static_cast<int>(across - core));
    z_ = kerf::graded_lines(0.0, length, kerf::cells_along(length, cell_size), ratio);
    return {};
  }
  std::int64_t n_nodes() const override { return section_.n_nodes() * n_planes(); }
  std::int64_t n_elements() const override { return section_.n_quads() * (n_planes() - 1); }
  kerf::Vec3 node(std::int64_t i) const override {
    const int flat = static_cast<int>(i % section_.n_nodes());
    const double z = z_[static_cast<std::size_t>(i / section_.n_nodes())];
    const double r = radius + (end_radius - radius) * (z / length);
    return {r * section_.x(flat), r * section_.y(flat), z};
  }
  kerf::ElementNodeIds element(std::int64_t e) const override {
    const auto& quad = section_.quad(static_cast<int>(e % section_.n_quads()));
    const std::int64_t below = e / section_.n_quads() * section_.n_nodes(), above = below + section_.n_nodes();
    return {below + quad[0], below + quad[1], below + quad[2], below + quad[3],
            above + quad[0], above + quad[1], above + quad[2], above + quad[3]};
  }
  std::vector<std::string> face_names() const override {
    return {"z_min", "z_max", "lateral", "symmetry_y", "symmetry_x"};
  }
  bool on_face(std::int64_t i, int face) const override {
    const auto& name = section_.name(static_cast<int>(i % section_.n_nodes()));
    switch (face) {
      case 0:
        return i < section_.n_nodes();
      case 1:
        return i >= section_.n_nodes() * (n_planes() - 1);
      case 2:
        return name.k == section_.n_ring();
      case 3:
        return sector != "full" && name.j == 0;
      default:
        return sector == "quarter" && name.i == 0;
    }
  }

 private:
  std::int64_t n_planes() const { return static_cast<std::int64_t>(z_.size()); }

  kerf::ButterflySection section_;
  std::vector<double> z_;  // [m]
};

KERF_MESH(TaperedRod, "tapered_rod", "round rod whose radius changes evenly along z")
