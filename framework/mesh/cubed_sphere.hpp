// The surface of a cube as a grid of quadrilaterals, and its image on the unit sphere.
//
// A node is named by a point (i, j, k) of the cube's grid, each from -n to n, or from 0 where the sphere is cut off at
// a plane of symmetry. Lines of equal angle on the sphere (Ronchi, Iacono & Paolucci 1996) keep cells about equally
// large.
#pragma once

#include <array>
#include <string>
#include <vector>

#include "kerf/math.hpp"

namespace kerf {

class CubedSphere {
 public:
  struct Node {
    int i = 0, j = 0, k = 0;
  };

  CubedSphere() = default;
  /// `sector`: full, half (y >= 0), quarter (x >= 0, y >= 0) or eighth (x, y, z >= 0); `n` cells over 45 degrees.
  /// Pre: n >= 1.
  CubedSphere(const std::string& sector, int n);

  int n() const { return n_; }
  int n_nodes() const { return static_cast<int>(nodes_.size()); }
  int n_quads() const { return static_cast<int>(quads_.size()); }
  const Node& name(int node) const { return nodes_[static_cast<std::size_t>(node)]; }
  /// Counter-clockwise, seen from outside.
  const std::array<int, 4>& quad(int q) const { return quads_[static_cast<std::size_t>(q)]; }
  /// Least grid coordinate along an axis: -n or 0.
  int first(int axis) const { return first_[static_cast<std::size_t>(axis)]; }
  bool on_surface(int i, int j, int k) const;
  /// Pre: on_surface(i, j, k).
  int node_at(int i, int j, int k) const;

  /// Point of the unit sphere. Pre: some coordinate is -n or n.
  Vec3 direction(const Node& name) const;
  /// "symmetry_y", "symmetry_x", "symmetry_z": the planes at which the sphere is cut off.
  const std::vector<std::string>& cut_names() const { return cut_names_; }
  /// Whether a node of the grid lies on a cut, an index into cut_names().
  bool on_cut(const Node& name, int cut) const;

 private:
  void add_face(int axis, bool at_end);
  /// Place in node_of_ of a point of a face.
  std::size_t place(int face, int a, int b) const {
    return static_cast<std::size_t>((face * (2 * n_ + 1) + a + n_) * (2 * n_ + 1) + b + n_);
  }

  int n_ = 1;
  std::array<int, 3> first_{};
  std::vector<Node> nodes_;
  std::vector<std::array<int, 4>> quads_;
  std::vector<int> node_of_;  // by face and place on it
  std::vector<std::string> cut_names_;
};

}  // namespace kerf
