// The butterfly section of round bodies: a bulged square core in a ring, all quadrilaterals.
//
// A node is named by a point (i, j) of the core's grid and a ring number k: k = 0 is the core itself, and for
// a point on the core's boundary k = 1 .. n_ring leads outwards to the rim. The same names serve the rounded
// end of a rod, where the core becomes a bulged cube (see reference_core).
#pragma once

#include <array>
#include <cmath>
#include <cstdint>
#include <cstdlib>
#include <string>
#include <vector>

#include "kerf/functions.hpp"
#include "kerf/math.hpp"

namespace kerf {

/// Shape of the core relative to a section of radius one.
struct CoreShape {
  double axis = 0.0;  // distance of the middle of a side from the centre
  double corner = 0.0;  // coordinate x = y of a corner
};

/// Core whose cells and the ring's are about equally large, with n_core cells from the axis to its side.
CoreShape core_shape(int n_core, int n_ring);

class ButterflySection {
 public:
  struct Node {
    int i = 0, j = 0, k = 0;
  };

  ButterflySection() = default;
  /// `sector`: full, half (y >= 0) or quarter (x >= 0, y >= 0). Pre: n_core >= 1, n_ring >= 1.
  ButterflySection(const std::string& sector, int n_core, int n_ring);

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

// ---- how it is done

namespace detail::butterfly {

inline constexpr double quarter_pi = 0.78539816339744830962;

// tan(pi/4 t), exactly one at the end so that the four sides of the core meet in the same bits.
inline double tangent(double t) { return t == 1.0 ? 1.0 : kerf::tan(quarter_pi * t); }

inline double with_sign_of(double magnitude, int i) { return i < 0 ? -magnitude : i > 0 ? magnitude : 0.0; }

}  // namespace detail::butterfly

inline CoreShape core_shape(int n_core, int n_ring) {
  CoreShape shape;
  // Along the diagonal, edges of the core's sides and of the ring are equally long: c/n = (1 - sqrt2 c)/m.
  shape.corner = n_core / (n_ring + std::sqrt(2.0) * n_core);
  // The side bulges by 15 degrees at its ends, so that the three cells which meet at a corner share 360
  // degrees equally: side x = axis - (axis - corner) t^2 has slope 2 (axis - corner) / corner there.
  shape.axis = shape.corner * (1.0 + 0.5 * kerf::tan(detail::butterfly::quarter_pi / 3.0));
  return shape;
}

inline ButterflySection::ButterflySection(const std::string& sector, int n_core, int n_ring)
    : n_core_(n_core),
      n_ring_(n_ring),
      i_first_(sector == "quarter" ? 0 : -n_core),
      j_first_(sector == "full" ? -n_core : 0),
      closed_(sector == "full"),
      shape_(core_shape(n_core, n_ring)) {
  n_around_ = sector == "full" ? 8 * n_core : sector == "half" ? 4 * n_core + 1 : 2 * n_core + 1;
  add_core();
  add_ring();
  for (const Node& node : nodes_) {
    const Vec3 inner = reference_core(node.i, node.j, 0.0);
    const Vec3 rim = node.k > 0 ? reference_rim(node.i, node.j, 0.0) : inner;
    const double t = static_cast<double>(node.k) / n_ring_;
    x_.push_back(inner.x * (1.0 - t) + rim.x * t);
    y_.push_back(inner.y * (1.0 - t) + rim.y * t);
  }
}

inline void ButterflySection::add_core() {
  for (int j = j_first_; j <= n_core_; ++j)
    for (int i = i_first_; i <= n_core_; ++i) nodes_.push_back({i, j, 0});
  for (int j = j_first_; j < n_core_; ++j)
    for (int i = i_first_; i < n_core_; ++i)
      quads_.push_back({core_index(i, j), core_index(i + 1, j), core_index(i + 1, j + 1), core_index(i, j + 1)});
  n_core_nodes_ = static_cast<int>(nodes_.size());
  n_core_quads_ = static_cast<int>(quads_.size());
}

inline void ButterflySection::add_ring() {
  for (int k = 1; k <= n_ring_; ++k)
    for (int m = 0; m < n_around_; ++m) {
      const auto [i, j] = boundary_point(m);
      nodes_.push_back({i, j, k});
    }
  const int n_sides = closed_ ? n_around_ : n_around_ - 1;
  for (int k = 0; k < n_ring_; ++k)
    for (int m = 0; m < n_sides; ++m) {
      const auto [i, j] = boundary_point(m);
      const auto [in, jn] = boundary_point((m + 1) % n_around_);
      quads_.push_back({node_at(i, j, k), node_at(i, j, k + 1), node_at(in, jn, k + 1), node_at(in, jn, k)});
    }
}

// Point m of the core's boundary, counter-clockwise from (n, 0).
inline std::array<int, 2> ButterflySection::boundary_point(int m) const {
  const int n = n_core_;
  if (m <= n) return {n, m};
  if (m <= 3 * n) return {2 * n - m, n};
  if (m <= 5 * n) return {-n, 4 * n - m};
  if (m <= 7 * n) return {m - 6 * n, -n};
  return {n, m - 8 * n};
}

inline int ButterflySection::node_at(int i, int j, int k) const {
  if (k == 0) return core_index(i, j);
  const int n = n_core_;
  int m = 0;
  if (i == n)
    m = j >= 0 ? j : 8 * n + j;
  else if (j == n)
    m = 2 * n - i;
  else if (i == -n)
    m = 4 * n - j;
  else
    m = 6 * n + i;
  return n_core_nodes_ + (k - 1) * n_around_ + m;
}

inline bool ButterflySection::on_core_boundary(int node) const {
  const Node& n = name(node);
  return std::abs(n.i) == n_core_ || std::abs(n.j) == n_core_;
}

inline Vec3 ButterflySection::reference_core(int i, int j, double height) const {
  const double u = std::abs(static_cast<double>(i)) / n_core_, v = std::abs(static_cast<double>(j)) / n_core_;
  const double bulge = shape_.axis - shape_.corner;
  // Each face of the cube recedes quadratically from its middle to its edges.
  const double x = u * (shape_.axis - bulge * (v * v + height * height));
  const double y = v * (shape_.axis - bulge * (u * u + height * height));
  const double z = height * (shape_.axis - bulge * (u * u + v * v));
  return {detail::butterfly::with_sign_of(x, i), detail::butterfly::with_sign_of(y, j), z};
}

inline Vec3 ButterflySection::reference_rim(int i, int j, double height) const {
  const double x = detail::butterfly::tangent(std::abs(static_cast<double>(i)) / n_core_);
  const double y = detail::butterfly::tangent(std::abs(static_cast<double>(j)) / n_core_);
  const double z = detail::butterfly::tangent(height);
  const double r = std::sqrt(x * x + y * y + z * z);
  return {detail::butterfly::with_sign_of(x / r, i), detail::butterfly::with_sign_of(y / r, j), z / r};
}

}  // namespace kerf
