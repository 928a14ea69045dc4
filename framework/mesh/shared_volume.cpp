// Cuts a cell by planes and keeps what is left as a list of polygons.
#include "mesh/shared_volume.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "core/assert.hpp"

namespace kerf {

namespace {

/// A face of the polyhedron, counter-clockwise seen from outside. Only corners that are there are set and copied: a
/// cell has many faces, and most of them have four corners.
class Polygon {
 public:
  static constexpr int capacity = 32;
  int n = 0;

  Polygon() {}
  Polygon(const Polygon& other) { *this = other; }
  Polygon& operator=(const Polygon& other) {
    n = other.n;
    std::copy_n(other.corner_, 3 * n, corner_);
    return *this;
  }
  void add(Vec3 x) {
    KERF_ASSERT(n < capacity, "a cell that is cut by six planes has polygons of few corners");
    put(n++, x);
  }
  void put(int i, Vec3 x) {
    for (int d = 0; d < 3; ++d) corner_[3 * i + d] = x[d];
  }
  Vec3 at(int i) const { return {corner_[3 * i], corner_[3 * i + 1], corner_[3 * i + 2]}; }

 private:
  double corner_[3 * capacity];
};

/// The closed surface of what is left of a cell.
class Polyhedron {
 public:
  /// `origin` is taken from all positions, so that round-off is that of a cell's size.
  Polyhedron(const Cell& cell, Vec3 origin) : origin_(origin) {
    for (int f = 0; f < cell.shape->n_faces; ++f) {
      const auto& corners = cell.shape->face[f];
      Polygon& face = face_[static_cast<std::size_t>(n_++)];
      for (int k = 0; k < (corners[3] == corners[2] ? 3 : 4); ++k)
        face.add(cell.x[static_cast<std::size_t>(corners[k])] - origin);
    }
  }

  /// Keeps what lies at dot(normal, x) < offset.
  void cut(Vec3 normal, double offset) {
    const double local = offset - dot(normal, origin_);
    if (lies_below(normal, local)) return;
    Polygon cap;
    int n_kept = 0;
    for (int f = 0; f < n_; ++f) {
      const Polygon rest = part_below(face_[static_cast<std::size_t>(f)], normal, local, cap);
      if (rest.n >= 3) face_[static_cast<std::size_t>(n_kept++)] = rest;
    }
    n_ = n_kept;
    if (n_ == 0 || cap.n < 3) return;
    sort_round(cap, normal);
    KERF_ASSERT(n_ < static_cast<int>(face_.size()), "six planes add six faces at most");
    face_[static_cast<std::size_t>(n_++)] = cap;
  }

  SharedVolume measure() const {
    SharedVolume shared;
    const double far = std::numeric_limits<double>::infinity();
    Vec3 low{far, far, far}, high{-far, -far, -far};
    for (int f = 0; f < n_; ++f) {
      const Polygon& face = face_[static_cast<std::size_t>(f)];
      for (int k = 2; k < face.n; ++k) shared.volume += dot(face.at(0), cross(face.at(k - 1), face.at(k))) / 6.0;
      for (int k = 0; k < face.n; ++k)
        for (int d = 0; d < 3; ++d) {
          low[d] = std::min(low[d], face.at(k)[d]);
          high[d] = std::max(high[d], face.at(k)[d]);
        }
    }
    shared.volume = std::max(shared.volume, 0.0);
    shared.low = low + origin_;
    shared.high = high + origin_;
    return shared;
  }

 private:
  bool lies_below(Vec3 normal, double offset) const {
    for (int f = 0; f < n_; ++f) {
      const Polygon& face = face_[static_cast<std::size_t>(f)];
      for (int k = 0; k < face.n; ++k)
        if (dot(normal, face.at(k)) > offset) return false;
    }
    return true;
  }

  /// What is left of a face; where its edges cross the plane goes to `cap`. Sutherland & Hodgman, Commun. ACM 17
  /// (1974).
  static Polygon part_below(const Polygon& face, Vec3 normal, double offset, Polygon& cap) {
    Polygon rest;
    for (int k = 0; k < face.n; ++k) {
      const Vec3 a = face.at(k), b = face.at(k + 1 == face.n ? 0 : k + 1);
      const double over_a = dot(normal, a) - offset, over_b = dot(normal, b) - offset;
      if (over_a <= 0.0) rest.add(a);
      if ((over_a <= 0.0) == (over_b <= 0.0)) continue;
      const Vec3 crossing = a + (b - a) * (over_a / (over_a - over_b));
      rest.add(crossing);
      if (over_a <= 0.0) cap.add(crossing);  // the face beyond the edge comes along it the other way round
    }
    return rest;
  }

  /// Puts the corners of a convex polygon in their order round the normal.
  static void sort_round(Polygon& cap, Vec3 normal) {
    Vec3 centre;
    for (int k = 0; k < cap.n; ++k) centre = centre + cap.at(k) * (1.0 / cap.n);
    const Vec3 least = std::fabs(normal.x) <= std::fabs(normal.y) && std::fabs(normal.x) <= std::fabs(normal.z)
                           ? Vec3{1.0, 0.0, 0.0}
                       : std::fabs(normal.y) <= std::fabs(normal.z) ? Vec3{0.0, 1.0, 0.0}
                                                                    : Vec3{0.0, 0.0, 1.0};
    const Vec3 e1 = cross(normal, least), e2 = cross(normal, e1);
    std::array<std::pair<double, int>, Polygon::capacity> order;
    for (int k = 0; k < cap.n; ++k) {
      const Vec3 d = cap.at(k) - centre;
      order[static_cast<std::size_t>(k)] = {kerf::atan2(dot(d, e2), dot(d, e1)), k};
    }
    std::sort(order.begin(), order.begin() + cap.n);
    const Polygon unsorted = cap;
    for (int k = 0; k < cap.n; ++k) cap.put(k, unsorted.at(order[static_cast<std::size_t>(k)].second));
  }

  Vec3 origin_;
  int n_ = 0;
  std::array<Polygon, 2 * Shape::most_faces> face_;
};

/// Whether all corners lie at or beyond one of the planes, each moved inwards by `inwards` and its warp times `sign`.
bool beyond_a_plane(const Cell& cell, const FacePlanes& planes, double inwards, double sign) {
  for (std::size_t f = 0; f < Shape::most_faces; ++f) {
    if (dot(planes.normal[f], planes.normal[f]) == 0.0) continue;
    double lowest = std::numeric_limits<double>::infinity();
    for (int k = 0; k < cell.shape->n_nodes; ++k)
      lowest = min_of(lowest, dot(planes.normal[f], cell.x[static_cast<std::size_t>(k)]));
    if (lowest >= planes.offset[f] - inwards - sign * planes.warp[f]) return true;
  }
  return false;
}

}  // namespace

FacePlanes::FacePlanes(const Cell& cell) {
  for (std::size_t f = 0; f < static_cast<std::size_t>(cell.shape->n_faces); ++f) {
    const auto at = [&](int k) { return cell.x[static_cast<std::size_t>(cell.shape->face[f][k])]; };
    const Vec3 area = cross(at(2) - at(0), at(3) - at(1));
    const double size = norm(area);
    normal[f] = size > 0.0 ? area * (1.0 / size) : Vec3{};
    offset[f] = dot(normal[f], (at(0) + at(1) + at(2) + at(3)) * 0.25);
    for (int k = 0; k < 4; ++k) warp[f] = max_of(warp[f], std::fabs(dot(normal[f], at(k)) - offset[f]));
    greatest_warp = max_of(greatest_warp, warp[f]);
  }
}

SharedVolume shared_volume(const Cell& a, const FacePlanes& planes_of_a, const Cell& b, const FacePlanes& planes_of_b,
                           double tolerance) {
  if (beyond_a_plane(a, planes_of_b, tolerance, 1.0) || beyond_a_plane(b, planes_of_a, tolerance, -1.0)) return {};
  Polyhedron left(a, b.x[0]);
  for (std::size_t f = 0; f < Shape::most_faces; ++f)
    if (dot(planes_of_b.normal[f], planes_of_b.normal[f]) > 0.0)
      left.cut(planes_of_b.normal[f], planes_of_b.offset[f] - tolerance - planes_of_b.warp[f]);
  return left.measure();
}

}  // namespace kerf
