// The surface of a cube as a grid of quadrilaterals, and its image on the unit sphere.
//
// A node is named by a point (i, j, k) of the cube's grid, each from -n to n, or from 0 where the sphere is cut off at
// a plane of symmetry. Lines of equal angle on the sphere (Ronchi, Iacono & Paolucci 1996) keep cells about equally
// large.
#pragma once

#include <array>
#include <cstdlib>
#include <string>
#include <vector>

#include "kerf/functions.hpp"
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

// ---- how it is done

namespace detail::cubed {

// tan(pi/4 t) with the sign of i; exactly one at the edges, so that the faces of the cube meet in the same bits.
inline double tangent(int i, int n) {
  const int size = std::abs(i);
  const double t = size == n ? 1.0 : kerf::tan(0.78539816339744830962 * size / n);
  return i < 0 ? -t : t;
}

// The first face that a point of the surface lies on: x max, x min, y max, ...
inline int face_of(int i, int j, int k, int n) {
  return i == n ? 0 : i == -n ? 1 : j == n ? 2 : j == -n ? 3 : k == n ? 4 : 5;
}

}  // namespace detail::cubed

inline CubedSphere::CubedSphere(const std::string& sector, int n) : n_(n) {
  first_ = {sector == "full" || sector == "half" ? -n : 0, sector == "full" ? -n : 0, sector == "eighth" ? 0 : -n};
  if (first_[1] == 0) cut_names_.push_back("symmetry_y");
  if (first_[0] == 0) cut_names_.push_back("symmetry_x");
  if (first_[2] == 0) cut_names_.push_back("symmetry_z");
  node_of_.assign(static_cast<std::size_t>(6 * (2 * n + 1) * (2 * n + 1)), -1);
  for (int axis = 0; axis < 3; ++axis) {
    add_face(axis, true);
    if (first_[static_cast<std::size_t>(axis)] < 0) add_face(axis, false);
  }
}

// The face whose coordinate `axis` is n or -n; a and b are the two coordinates after it, in turn.
inline void CubedSphere::add_face(int axis, bool at_end) {
  const auto point = [&](int a, int b) {
    Node p;
    int* const c[3] = {&p.i, &p.j, &p.k};
    *c[axis] = at_end ? n_ : -n_;
    *c[(axis + 1) % 3] = a;
    *c[(axis + 2) % 3] = b;
    return p;
  };
  const int a0 = first((axis + 1) % 3), b0 = first((axis + 2) % 3);
  const int own = 2 * axis + (at_end ? 0 : 1);
  for (int b = b0; b <= n_; ++b)
    for (int a = a0; a <= n_; ++a) {
      const Node p = point(a, b);
      if (detail::cubed::face_of(p.i, p.j, p.k, n_) != own) continue;  // an edge that belongs to a face before
      node_of_[place(own, a, b)] = n_nodes();
      nodes_.push_back(p);
    }
  const auto index = [&](int a, int b) {
    const Node p = point(a, b);
    return node_at(p.i, p.j, p.k);
  };
  for (int b = b0; b < n_; ++b)
    for (int a = a0; a < n_; ++a) {
      std::array<int, 4> quad{index(a, b), index(a + 1, b), index(a + 1, b + 1), index(a, b + 1)};
      if (!at_end) quad = {quad[0], quad[3], quad[2], quad[1]};
      quads_.push_back(quad);
    }
}

inline bool CubedSphere::on_surface(int i, int j, int k) const {
  return std::abs(i) == n_ || std::abs(j) == n_ || std::abs(k) == n_;
}

inline int CubedSphere::node_at(int i, int j, int k) const {
  const int face = detail::cubed::face_of(i, j, k, n_);
  const std::array<int, 3> c{i, j, k};
  const auto axis = static_cast<std::size_t>(face / 2);
  return node_of_[place(face, c[(axis + 1) % 3], c[(axis + 2) % 3])];
}

inline Vec3 CubedSphere::direction(const Node& name) const {
  const Vec3 p{detail::cubed::tangent(name.i, n_), detail::cubed::tangent(name.j, n_),
               detail::cubed::tangent(name.k, n_)};
  return p * (1.0 / norm(p));
}

inline bool CubedSphere::on_cut(const Node& name, int cut) const {
  const std::string& which = cut_names_[static_cast<std::size_t>(cut)];
  return (which.back() == 'y' ? name.j : which.back() == 'x' ? name.i : name.k) == 0;
}

}  // namespace kerf
