// What is left of a face of a body, the holes in it, and how wide they are: for measures.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <iterator>
#include <numeric>
#include <set>
#include <unordered_map>
#include <unordered_set>
#include <vector>

#include "kerf/bodies/measured_bodies.hpp"

namespace kerf::bodies {

/// The edge of a hole in a piece of surface.
struct Rim {
  std::vector<std::int32_t> vertices;  // in order around the hole
  double reference_area = 0.0;  // enclosed by the undeformed rim [m2]
};

/// What is left of a face of a body, and the holes in it.
struct FaceRest {
  std::vector<std::int32_t> facets;  // of the largest piece that is connected through edges
  std::vector<Rim> holes, outlines;
};

/// The rest of a face that was flat, with this outward normal, before anything happened. Facets that are not connected
/// through edges with the largest connected piece count as gone; so does what they enclose.
FaceRest rest_of_face(const BodySurface& surface, const std::vector<std::int32_t>& facets, Vec3 normal);

/// What a face has lost, compared with the undeformed face.
struct FaceLoss {
  bool any = false;
  double largest_at_outline = 0.0;  // undeformed area of the largest loss that reaches the face's outline [m2]
};
FaceLoss loss_of_face(const BodySurface& surface, const FaceRest& rest, const BodySurface& undeformed, Vec3 normal);

/// Whether the walls that begin at one rim lead to another without crossing the excluded facets.
bool walls_connect(const BodySurface& surface, const std::vector<bool>& excluded, const std::vector<Rim>& from,
                   const std::vector<Rim>& to);

/// Caliper (Feret) diameters and the area of a closed line, projected on a plane.
struct Opening {
  double largest = not_measurable, smallest = not_measurable;  // [m]
  double area = not_measurable;  // [m2]
};
Opening measure_opening(const std::vector<Vec3>& line, Vec3 normal);

/// Area of the convex hull of points that are projected on a plane [m2].
double hull_area(const std::vector<Vec3>& points, Vec3 normal);

/// Those of the points that are corners of their convex hull, seen along a normal.
std::vector<Vec3> hull_of(const std::vector<Vec3>& points, Vec3 normal);

// ---- how it is done

namespace hole_detail {

/// Half-edges of some facets of a surface: directed edge -> facet and corner where it starts.
class HalfEdges {
 public:
  HalfEdges(const BodySurface& surface, const std::vector<std::int32_t>& facets) : surface_(&surface) {
    for (const std::int32_t f : facets)
      for (int k = 0; k < 4; ++k) starts_.emplace(key(vertex(f, k), vertex(f, k + 1)), Corner{f, k});
  }
  struct Corner {
    std::int32_t facet;
    int corner;
  };
  static std::uint64_t key(std::int32_t a, std::int32_t b) {
    return static_cast<std::uint64_t>(static_cast<std::uint32_t>(a)) << 32 | static_cast<std::uint32_t>(b);
  }
  std::int32_t vertex(std::int32_t facet, int corner) const {
    return surface_->facets[static_cast<std::size_t>(facet)][static_cast<std::size_t>(corner & 3)];
  }
  const Corner* find(std::int32_t a, std::int32_t b) const {
    const auto at = starts_.find(key(a, b));
    return at == starts_.end() ? nullptr : &at->second;
  }
  /// The half-edge on the other side of the edge that starts at a corner; null on a boundary.
  const Corner* opposite(Corner c) const { return find(vertex(c.facet, c.corner + 1), vertex(c.facet, c.corner)); }
  std::size_t size() const { return starts_.size(); }

 private:
  const BodySurface* surface_;
  std::unordered_map<std::uint64_t, Corner> starts_;
};

inline Vec3 facet_area(const std::vector<Vec3>& x, const std::array<std::int32_t, 4>& f) {
  const auto at = [&](int k) { return x[static_cast<std::size_t>(f[static_cast<std::size_t>(k)])]; };
  return 0.5 * cross(at(2) - at(0), at(3) - at(1));
}

/// The labels of a facet's vertices, ascending: what the same facet has in every surface.
inline std::array<std::int64_t, 4> labels_of(const BodySurface& surface, std::int32_t facet) {
  std::array<std::int64_t, 4> labels{};
  for (std::size_t k = 0; k < 4; ++k)
    labels[k] = surface.label[static_cast<std::size_t>(surface.facets[static_cast<std::size_t>(facet)][k])];
  std::sort(labels.begin(), labels.end());
  return labels;
}

/// Facets that are connected through edges, and their reference area.
struct Piece {
  std::vector<std::int32_t> facets;
  double area = 0.0;  // [m2]
};

inline std::vector<Piece> connected_pieces(const BodySurface& surface, const std::vector<std::int32_t>& facets) {
  const HalfEdges edges(surface, facets);
  std::unordered_set<std::int32_t> seen;
  std::vector<Piece> pieces;
  for (const std::int32_t start : facets) {
    if (!seen.insert(start).second) continue;
    Piece piece{{start}};
    for (std::size_t i = 0; i < piece.facets.size(); ++i) {
      const std::int32_t f = piece.facets[i];
      piece.area += norm(facet_area(surface.reference, surface.facets[static_cast<std::size_t>(f)]));
      for (int k = 0; k < 4; ++k) {
        const HalfEdges::Corner* other = edges.opposite({f, k});
        if (other != nullptr && seen.insert(other->facet).second) piece.facets.push_back(other->facet);
      }
    }
    pieces.push_back(std::move(piece));
  }
  return pieces;
}

/// Facets of the largest piece that is connected through edges, by reference area; the first of equals.
inline std::vector<std::int32_t> largest_piece(const BodySurface& surface, const std::vector<std::int32_t>& facets) {
  std::vector<Piece> pieces = connected_pieces(surface, facets);
  const auto best =
      std::max_element(pieces.begin(), pieces.end(), [](const Piece& a, const Piece& b) { return a.area < b.area; });
  if (best == pieces.end()) return {};
  std::sort(best->facets.begin(), best->facets.end());
  return std::move(best->facets);
}

/// Follows a boundary from a half-edge, with the facets on the left. Where two boundaries touch at a vertex it
/// stays with the facets it came along, so that holes that touch at a corner are one hole.
inline std::vector<HalfEdges::Corner> follow_boundary(const HalfEdges& edges, HalfEdges::Corner start) {
  std::vector<HalfEdges::Corner> line{start};
  while (line.size() <= edges.size()) {
    HalfEdges::Corner next{line.back().facet, (line.back().corner + 1) & 3};
    for (std::size_t turns = 0; turns < edges.size(); ++turns) {
      const HalfEdges::Corner* other = edges.opposite(next);
      if (other == nullptr) break;
      next = {other->facet, (other->corner + 1) & 3};
    }
    if (next.facet == start.facet && next.corner == start.corner) break;
    line.push_back(next);
  }
  return line;
}

inline double enclosed_area(const std::vector<Vec3>& line, Vec3 normal) {
  Vec3 sum;
  for (std::size_t i = 0; i < line.size(); ++i)
    sum = sum + cross(line[i] - line[0], line[(i + 1) % line.size()] - line[0]);
  return 0.5 * dot(sum, normal);
}

inline std::unordered_set<std::uint64_t> edges_of(const std::vector<Rim>& rims) {
  std::unordered_set<std::uint64_t> edges;
  for (const Rim& rim : rims) {
    for (std::size_t i = 0; i < rim.vertices.size(); ++i) {
      const std::int32_t a = rim.vertices[i], b = rim.vertices[(i + 1) % rim.vertices.size()];
      edges.insert(HalfEdges::key(std::min(a, b), std::max(a, b)));
    }
  }
  return edges;
}

struct Point {
  double x, y;
  std::size_t number = 0;  // in the list that it comes from
};

inline double turn(Point a, Point b, Point c) { return (b.x - a.x) * (c.y - a.y) - (b.y - a.y) * (c.x - a.x); }

/// Convex hull, counter-clockwise. A.M. Andrew, Inf. Process. Lett. 9 (1979) 216-219.
inline std::vector<Point> convex_hull(std::vector<Point> points) {
  std::sort(points.begin(), points.end(), [](Point a, Point b) { return a.x != b.x ? a.x < b.x : a.y < b.y; });
  std::vector<Point> hull;
  for (int pass = 0; pass < 2; ++pass) {
    const std::size_t base = hull.size();
    for (const Point p : points) {
      while (hull.size() >= base + 2 && turn(hull[hull.size() - 2], hull.back(), p) <= 0.0) hull.pop_back();
      hull.push_back(p);
    }
    hull.pop_back();
    std::reverse(points.begin(), points.end());
  }
  return hull;
}

/// The convex hull of points that are projected on the plane with this normal.
inline std::vector<Point> projected_hull(const std::vector<Vec3>& line, Vec3 n) {
  const Vec3 least = std::fabs(n.x) <= std::fabs(n.y) && std::fabs(n.x) <= std::fabs(n.z) ? Vec3{1.0, 0.0, 0.0}
                     : std::fabs(n.y) <= std::fabs(n.z)                                   ? Vec3{0.0, 1.0, 0.0}
                                                                                          : Vec3{0.0, 0.0, 1.0};
  const Vec3 e1 = unit(cross(n, least)), e2 = cross(n, e1);
  std::vector<Point> points;
  for (const Vec3 x : line) points.push_back({dot(x, e1), dot(x, e2), points.size()});
  return convex_hull(points);
}

}  // namespace hole_detail

inline FaceRest rest_of_face(const BodySurface& surface, const std::vector<std::int32_t>& facets, Vec3 normal) {
  FaceRest rest;
  rest.facets = hole_detail::largest_piece(surface, facets);
  const hole_detail::HalfEdges edges(surface, rest.facets);
  std::unordered_set<std::uint64_t> done;
  for (const std::int32_t f : rest.facets) {
    for (int k = 0; k < 4; ++k) {
      const hole_detail::HalfEdges::Corner start{f, k};
      if (edges.opposite(start) != nullptr) continue;
      if (done.contains(hole_detail::HalfEdges::key(edges.vertex(f, k), edges.vertex(f, k + 1)))) continue;
      Rim rim;
      std::vector<Vec3> line;
      for (const hole_detail::HalfEdges::Corner c : hole_detail::follow_boundary(edges, start)) {
        done.insert(hole_detail::HalfEdges::key(edges.vertex(c.facet, c.corner), edges.vertex(c.facet, c.corner + 1)));
        rim.vertices.push_back(edges.vertex(c.facet, c.corner));
        line.push_back(surface.reference[static_cast<std::size_t>(rim.vertices.back())]);
      }
      // Facets lie on the left: around the outline the area is positive, around a hole negative.
      rim.reference_area = -hole_detail::enclosed_area(line, normal);
      (rim.reference_area > 0.0 ? rest.holes : rest.outlines).push_back(std::move(rim));
    }
  }
  return rest;
}

inline FaceLoss loss_of_face(const BodySurface& surface, const FaceRest& rest, const BodySurface& undeformed,
                             Vec3 normal) {
  std::set<std::array<std::int64_t, 4>> left;
  for (const std::int32_t f : rest.facets) left.insert(hole_detail::labels_of(surface, f));
  std::vector<std::int32_t> all(undeformed.facets.size()), gone;
  std::iota(all.begin(), all.end(), 0);
  std::copy_if(all.begin(), all.end(), std::back_inserter(gone),
               [&](std::int32_t f) { return !left.contains(hole_detail::labels_of(undeformed, f)); });
  FaceLoss loss;
  loss.any = !gone.empty();
  const std::unordered_set<std::uint64_t> outline =
      hole_detail::edges_of(rest_of_face(undeformed, all, normal).outlines);
  for (const hole_detail::Piece& piece : hole_detail::connected_pieces(undeformed, gone)) {
    bool at_outline = false;
    for (const std::int32_t f : piece.facets)
      for (std::size_t k = 0; k < 4; ++k) {
        const std::int32_t a = undeformed.facets[static_cast<std::size_t>(f)][k],
                           b = undeformed.facets[static_cast<std::size_t>(f)][(k + 1) & 3];
        at_outline = at_outline || outline.contains(hole_detail::HalfEdges::key(std::min(a, b), std::max(a, b)));
      }
    if (at_outline) loss.largest_at_outline = std::max(loss.largest_at_outline, piece.area);
  }
  return loss;
}

inline bool walls_connect(const BodySurface& surface, const std::vector<bool>& excluded, const std::vector<Rim>& from,
                          const std::vector<Rim>& to) {
  std::unordered_map<std::uint64_t, std::vector<std::int32_t>> around;  // facets at each edge
  const auto key_at = [&](std::size_t facet, std::size_t k) {
    const std::int32_t a = surface.facets[facet][k], b = surface.facets[facet][(k + 1) & 3];
    return hole_detail::HalfEdges::key(std::min(a, b), std::max(a, b));
  };
  for (std::size_t f = 0; f < surface.facets.size(); ++f)
    if (!excluded[f])
      for (std::size_t k = 0; k < 4; ++k) around[key_at(f, k)].push_back(static_cast<std::int32_t>(f));

  const std::unordered_set<std::uint64_t> goal = hole_detail::edges_of(to), start = hole_detail::edges_of(from);
  std::vector<bool> seen(surface.facets.size(), false);
  std::vector<std::int32_t> queue;
  const auto visit = [&](std::uint64_t edge) {
    const auto at = around.find(edge);
    if (at == around.end()) return;
    for (const std::int32_t f : at->second) {
      if (seen[static_cast<std::size_t>(f)]) continue;
      seen[static_cast<std::size_t>(f)] = true;
      queue.push_back(f);
    }
  };
  for (const std::uint64_t edge : start) visit(edge);
  for (std::size_t i = 0; i < queue.size(); ++i) {
    for (std::size_t k = 0; k < 4; ++k) {
      const std::uint64_t edge = key_at(static_cast<std::size_t>(queue[i]), k);
      if (goal.contains(edge)) return true;
      visit(edge);
    }
  }
  return false;
}

inline Opening measure_opening(const std::vector<Vec3>& line, Vec3 normal) {
  const Vec3 n = unit(normal);
  const std::vector<hole_detail::Point> hull = hole_detail::projected_hull(line, n);
  if (hull.size() < 3) return {};
  Opening o;
  o.largest = 0.0;
  o.smallest = std::numeric_limits<double>::infinity();
  // The least width of a convex polygon is attained with one caliper along an edge.
  for (std::size_t i = 0; i < hull.size(); ++i) {
    const hole_detail::Point a = hull[i], b = hull[(i + 1) % hull.size()];
    const double edge = kerf::hypot(b.x - a.x, b.y - a.y);
    double width = 0.0;
    for (const hole_detail::Point p : hull) {
      o.largest = std::max(o.largest, kerf::hypot(p.x - a.x, p.y - a.y));
      width = std::max(width, hole_detail::turn(a, b, p) / edge);
    }
    o.smallest = std::min(o.smallest, width);
  }
  o.area = std::fabs(hole_detail::enclosed_area(line, n));
  return o;
}

inline double hull_area(const std::vector<Vec3>& points, Vec3 normal) {
  if (points.empty()) return 0.0;
  const std::vector<hole_detail::Point> hull = hole_detail::projected_hull(points, unit(normal));
  double twice = 0.0;
  for (std::size_t i = 1; i + 1 < hull.size(); ++i) twice += hole_detail::turn(hull[0], hull[i], hull[i + 1]);
  return 0.5 * twice;
}

inline std::vector<Vec3> hull_of(const std::vector<Vec3>& points, Vec3 normal) {
  if (points.size() <= 3) return points;
  std::vector<Vec3> corners;
  for (const hole_detail::Point p : hole_detail::projected_hull(points, unit(normal)))
    corners.push_back(points[p.number]);
  if (corners.empty()) corners.push_back(points.front());  // all lie at one place
  return corners;
}

}  // namespace kerf::bodies
