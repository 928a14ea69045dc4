// The butterfly section of round bodies: a bulged square core in a ring, all quadrilaterals.
//
// A node is named by a point (i, j) of the core's grid and a ring number k: k = 0 is the core itself, and for
// a point on the core's boundary k = 1 .. n_ring leads outwards to the rim. The same names serve the rounded
// end of a rod, where the core becomes a bulged cube (see reference_core).
#pragma once

#include <array>
#include <cstdint>
#include <string>
#include <vector>

#include "kerf/math.hpp"

namespace kerf {

/// Shape of the core relative to a section of radius one.
struct CoreShape {
  double axis = 0.0;  // distance of the middle of a side from the centre
  double corner = 0.0;  // coordinate x = y of a corner
};

/// Core whose cells and the ring's are about equally large, with n_core cells from the axis to its side.
CoreShape core_shape(int n_core, int n_ring);

class Section {
 public:
  struct Node {
    int i = 0, j = 0, k = 0;
  };

  Section() = default;
  /// `sector`: full, half (y >= 0) or quarter (x >= 0, y >= 0). Pre: n_core >= 1, n_ring >= 1.
  Section(const std::string& sector, int n_core, int n_ring);

  int n_core() const { return n_core_; }
  int n_ring() const { return n_ring_; }
  int n_nodes() const { return static_cast<int>(nodes_.size()); }
  int n_quads() const { return static_cast<int>(quads_.size()); }
  /// The quads of the core come first.
  int n_core_quads() const { return n_core_quads_; }
  /// The nodes of the core come first.
  int n_core_nodes() const { return n_core_nodes_; }

  const Node& name(int node) const { return nodes_[static_cast<std::size_t>(node)]; }
  /// Position in a section of radius one.
  double x(int node) const { return x_[static_cast<std::size_t>(node)]; }
  double y(int node) const { return y_[static_cast<std::size_t>(node)]; }
  /// Counter-clockwise.
  const std::array<int, 4>& quad(int q) const { return quads_[static_cast<std::size_t>(q)]; }
  /// Node with this name. Pre: it exists in this sector.
  int node_at(int i, int j, int k) const;
  bool on_core_boundary(int node) const;

  /// Position relative to radius one of a node of the bulged cube core and of the sphere around it, for
  /// `height` = 0 (equator) .. 1 (top of the cube); at height 0 this is the flat section.
  Vec3 reference_core(int i, int j, double height) const;
  Vec3 reference_rim(int i, int j, double height) const;

 private:
  void add_core();
  void add_ring();
  std::array<int, 2> boundary_point(int m) const;
  int core_index(int i, int j) const { return (j - j_first_) * (n_core_ - i_first_ + 1) + (i - i_first_); }

  int n_core_ = 1, n_ring_ = 1, i_first_ = 0, j_first_ = 0;
  int n_around_ = 0;  // nodes on one circle
  bool closed_ = false;  // the circle is complete
  int n_core_nodes_ = 0, n_core_quads_ = 0;
  CoreShape shape_;
  std::vector<Node> nodes_;
  std::vector<double> x_, y_;
  std::vector<std::array<int, 4>> quads_;
};

}  // namespace kerf
