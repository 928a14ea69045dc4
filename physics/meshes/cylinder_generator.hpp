// Solid rods along z meshed with hexahedra: butterfly section, flat, conical, ogival or round nose.
#pragma once

#include <array>
#include <cstdint>
#include <string>
#include <vector>

#include "kerf/mesh.hpp"
#include "kerf/meshes/butterfly_section.hpp"
#include "nose.hpp"

namespace kerf {

/// Shape of the end at z = length.
struct NoseInput {
  std::string type = "flat";
  double length = 0.0;  // [m], zero where absent
  double caliber_radius_head = 0.0;  // zero where absent
  double tip_radius_fraction = -1.0;  // negative where absent
  static void describe(Schema<NoseInput>& s);
};

/// Layers of the section from z = 0 upwards, narrowed in the nose; a nose that is not cut off flat ends in a
/// cap, half of a sphere mesh: there the core's sides close in on a bulged top which the ring also covers.
///
/// Nodes are numbered layer by layer, then the inside of the cap's cover from the core outwards.
class CylinderGenerator final : public MeshGenerator {
 public:
  double radius = 0.0, length = 0.0;  // [m]
  double cell_size = 0.0;  // [m], zero where counts are given
  std::int64_t core_cells = 0, ring_cells = 0, axial_cells = 0;
  double axial_ratio = 1.0;
  bool exact_section = false;
  std::string sector = "full";
  NoseInput nose;

  static void describe(Schema<CylinderGenerator>& s);

  std::vector<std::string> prepare() override;
  std::int64_t n_nodes() const override { return n_layers_ * section_.n_nodes() + n_cover_nodes(); }
  std::int64_t n_elements() const override {
    return (n_layers_ - 1) * section_.n_quads() + (has_cap() ? section_.n_ring() * section_.n_core_quads() : 0);
  }
  Vec3 node(std::int64_t i) const override;
  ElementNodeIds element(std::int64_t e) const override;
  std::vector<std::string> face_names() const override;
  bool on_face(std::int64_t i, int face) const override;

 private:
  /// A flat layer of nodes.
  struct Plane {
    double z = 0.0, radius = 0.0;  // [m]
  };
  /// Where a node is: layer and name in the section; the cover's nodes lie on the last layer with k > 0.
  struct Place {
    std::int64_t layer = 0;
    ButterflySection::Node name;
  };

  bool has_cap() const { return n_layers_ > static_cast<std::int64_t>(planes_.size()); }
  std::int64_t n_cover_nodes() const {
    return has_cap() ? section_.n_ring() * static_cast<std::int64_t>(inside_core_.size()) : 0;
  }
  std::vector<std::string> check() const;
  NoseProfile make_profile() const;
  void lay_planes(double nominal);
  void lay_cap();
  Place place(std::int64_t i) const;
  Vec3 cap_point(const ButterflySection::Node& name, double height) const;
  Vec3 onto_cap(Vec3 reference) const;
  std::int64_t cover_node(int section_node, int k) const;

  ButterflySection section_;
  NoseProfile profile_;
  std::vector<Plane> planes_;
  std::int64_t n_layers_ = 0;  // of nodes: the planes, then the layers of the cap
  double nose_base_ = 0.0, cap_arc_ = 0.0;  // [m] z of the nose's base; arc length at which the cap starts
  double stretch_ = 1.0;  // of the section, for exact_section
  std::vector<int> inside_core_;  // core nodes that are not on its boundary
  std::vector<int> inside_index_;  // core node -> position in inside_core_, or -1
};

}  // namespace kerf
