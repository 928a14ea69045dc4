// The butterfly section of round bodies.
#include "mesh/section.hpp"

#include <cmath>
#include <cstdlib>

#include "kerf/functions.hpp"

namespace kerf {

namespace {

constexpr double quarter_pi = 0.78539816339744830962;

// tan(pi/4 t), exactly one at the end so that the four sides of the core meet in the same bits.
double tangent(double t) { return t == 1.0 ? 1.0 : kerf::tan(quarter_pi * t); }

double with_sign_of(double magnitude, int i) { return i < 0 ? -magnitude : i > 0 ? magnitude : 0.0; }

}  // namespace

CoreShape core_shape(int n_core, int n_ring) {
  CoreShape shape;
  // Along the diagonal, edges of the core's sides and of the ring are equally long: c/n = (1 - sqrt2 c)/m.
  shape.corner = n_core / (n_ring + std::sqrt(2.0) * n_core);
  // The side bulges by 15 degrees at its ends, so that the three cells which meet at a corner share 360
  // degrees equally: side x = axis - (axis - corner) t^2 has slope 2 (axis - corner) / corner there.
  shape.axis = shape.corner * (1.0 + 0.5 * kerf::tan(quarter_pi / 3.0));
  return shape;
}

Section::Section(const std::string& sector, int n_core, int n_ring)
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

void Section::add_core() {
  for (int j = j_first_; j <= n_core_; ++j)
    for (int i = i_first_; i <= n_core_; ++i) nodes_.push_back({i, j, 0});
  for (int j = j_first_; j < n_core_; ++j)
    for (int i = i_first_; i < n_core_; ++i)
      quads_.push_back({core_index(i, j), core_index(i + 1, j), core_index(i + 1, j + 1), core_index(i, j + 1)});
  n_core_nodes_ = static_cast<int>(nodes_.size());
  n_core_quads_ = static_cast<int>(quads_.size());
}

void Section::add_ring() {
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
std::array<int, 2> Section::boundary_point(int m) const {
  const int n = n_core_;
  if (m <= n) return {n, m};
  if (m <= 3 * n) return {2 * n - m, n};
  if (m <= 5 * n) return {-n, 4 * n - m};
  if (m <= 7 * n) return {m - 6 * n, -n};
  return {n, m - 8 * n};
}

int Section::node_at(int i, int j, int k) const {
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

bool Section::on_core_boundary(int node) const {
  const Node& n = name(node);
  return std::abs(n.i) == n_core_ || std::abs(n.j) == n_core_;
}

Vec3 Section::reference_core(int i, int j, double height) const {
  const double u = std::abs(static_cast<double>(i)) / n_core_, v = std::abs(static_cast<double>(j)) / n_core_;
  const double bulge = shape_.axis - shape_.corner;
  // Each face of the cube recedes quadratically from its middle to its edges.
  const double x = u * (shape_.axis - bulge * (v * v + height * height));
  const double y = v * (shape_.axis - bulge * (u * u + height * height));
  const double z = height * (shape_.axis - bulge * (u * u + v * v));
  return {with_sign_of(x, i), with_sign_of(y, j), z};
}

Vec3 Section::reference_rim(int i, int j, double height) const {
  const double x = tangent(std::abs(static_cast<double>(i)) / n_core_);
  const double y = tangent(std::abs(static_cast<double>(j)) / n_core_);
  const double z = tangent(height);
  const double r = std::sqrt(x * x + y * y + z * z);
  return {with_sign_of(x / r, i), with_sign_of(y / r, j), z / r};
}

}  // namespace kerf
