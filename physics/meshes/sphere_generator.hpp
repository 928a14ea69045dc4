// Solid spheres of hexahedra: a bulged cube at the centre, in shells of the cubed sphere.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "kerf/mesh.hpp"
#include "kerf/meshes/cubed_sphere.hpp"

namespace kerf {

/// The core's nodes come first, row by row; then the shells from the core outwards.
class SphereGenerator final : public MeshGenerator {
 public:
  double radius = 0.0;  // [m]
  double cell_size = 0.0;  // [m], zero where counts are given
  std::int64_t core_cells = 0, ring_cells = 0;
  std::string sector = "full";

  static void describe(Schema<SphereGenerator>& s);

  std::vector<std::string> prepare() override;
  std::int64_t n_nodes() const override { return n_core_nodes_ + n_ring_ * surface_.n_nodes(); }
  std::int64_t n_elements() const override {
    return n_core_elements_ + n_ring_ * static_cast<std::int64_t>(surface_.n_quads());
  }
  Vec3 node(std::int64_t i) const override;
  ElementNodeIds element(std::int64_t e) const override;
  std::vector<std::string> face_names() const override;
  bool on_face(std::int64_t i, int face) const override;

 private:
  /// Where a node is: a point of the cube's grid, and the shell; 0 is the core.
  struct Place {
    CubedSphere::Node name;
    std::int64_t shell = 0;
  };
  Place place(std::int64_t i) const;
  std::int64_t core_index(const CubedSphere::Node& p) const;
  std::int64_t index(int surface_node, std::int64_t shell) const;
  /// In a sphere of radius one.
  Vec3 core_point(const CubedSphere::Node& p) const;

  CubedSphere surface_;
  std::int64_t n_ring_ = 1, n_core_nodes_ = 0, n_core_elements_ = 0;
  std::int64_t n_[3] = {};  // nodes of the core along the axes
  double middle_ = 0.0;  // distance of the middle of a face of the core from the centre, over the radius
};

}  // namespace kerf
