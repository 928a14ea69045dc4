// Touches without jumps from one facet to the next: where a node enters a surface, and the normal there.
#pragma once

#include <kerf/contact_geometry.hpp>

#include <cstdint>
#include <vector>

#include <kerf/surfaces/facet_slabs.hpp>

namespace kerf::surfaces {

/// Whether an edge between two facets is one of the body, and not just one of the mesh.
inline bool is_folded(const FacetSlabs& slabs, std::int32_t a, std::int32_t b) {
  return dot(slabs.normal(a), slabs.normal(b)) < 0.7;
}

inline bool has_corner(const ContactView& view, std::int32_t facet, std::int32_t node) {
  const std::int32_t* n = view.facet_nodes + 4 * static_cast<std::int64_t>(facet);
  return n[0] == node || n[1] == node || n[2] == node || n[3] == node;
}

/// Where the node of a touch passes through the surface, or where it starts if it is below already; where it ends if it
/// does not close [m].
inline Vec3 point_of_entry(const ContactView& view, const ContactTouch& t) {
  const Vec3 s = view.x(t.node), v = relative_velocity(view, t);
  const double closing = -dot(v, t.direction);
  return closing > 0.0 ? s - v * min_of(t.depth / closing, view.dt) : s;
}

/// How far the node of a touch is below the point with the touch's weights, along its direction [m].
inline double depth_of(const ContactView& view, const ContactTouch& t) {
  const std::int32_t* n = view.facet_nodes + 4 * static_cast<std::int64_t>(t.facet);
  Vec3 below = view.x(t.node) * -1.0;
  for (int k = 0; k < 4; ++k) below = below + view.x(n[k]) * t.weights[k];
  return dot(below, t.direction);
}

/// A point in the share of a facet that belongs to one of its corners. The coordinates u and v run along the edges to
/// two other corners, from 0 at the corner to 1 halfway to them; at 1 and 1 is the middle of the facet.
struct CornerPoint {
  int corner = 0, beside_u = 1, beside_v = 3;
  double u = 0.0, v = 0.0;

  /// Of a quadrilateral, from natural coordinates; the corner need not be the nearest one.
  static CornerPoint of_quad(double xi, double eta, int corner) {
    const bool is_right = corner == 1 || corner == 2, is_upper = corner >= 2;
    return {corner, is_upper ? 5 - corner : 1 - corner, 3 - corner, clamp_to(is_right ? 1.0 - xi : 1.0 + xi, 0.0, 1.0),
            clamp_to(is_upper ? 1.0 - eta : 1.0 + eta, 0.0, 1.0)};
  }
  /// Of a triangle, from barycentric coordinates. On the line between the shares of two corners, which leads from the
  /// middle of an edge to that of the triangle, both have u or v of one, and the other coordinate is the same.
  static CornerPoint of_triangle(const double (&share)[3], int corner) {
    const int next = (corner + 1) % 3, last = (corner + 2) % 3;
    const auto along = [&](int other) {
      const double both = share[corner] + share[other];
      return both > 0.0 ? clamp_to(2.0 * share[other] / both, 0.0, 1.0) : 1.0;
    };
    return {corner, next, last, along(next), along(last)};
  }
  /// Of a facet with these weights of its four corners, of which a triangle repeats the last one. In the share of the
  /// corner with the greatest weight.
  static CornerPoint of_weights(const double (&w)[4], bool is_triangle) {
    if (is_triangle) {
      const double share[3] = {w[0], w[1], w[2] + w[3]};
      const int corner = share[1] > share[0] ? (share[2] > share[1] ? 2 : 1) : (share[2] > share[0] ? 2 : 0);
      return of_triangle(share, corner);
    }
    const double xi = w[1] + w[2] - w[0] - w[3], eta = w[2] + w[3] - w[0] - w[1];
    return of_quad(xi, eta, eta > 0.0 ? (xi > 0.0 ? 2 : 3) : (xi > 0.0 ? 1 : 0));
  }
};

/// The normal at a point of a facet, given all facets round the corner that is nearest to it. With the normals of
/// single facets, bodies without strength would buckle, since a node on an edge would be pushed sideways by whichever
/// facet it falls to. In the share of the corner the normal is bilinear between the mean normals of all facets round
/// that corner, of the two facets along either edge, and of the facet itself. Facets that are folded against it do not
/// count.
inline Vec3 smooth_normal(const ContactView& view, const FacetSlabs& slabs, const std::vector<std::int32_t>& round,
                          std::int32_t facet, const CornerPoint& p) {
  const std::int32_t* corner = view.facet_nodes + 4 * static_cast<std::int64_t>(facet);
  const Vec3 own = slabs.normal(facet);
  Vec3 at_corner, across_u = own, across_v = own;
  for (const std::int32_t f : round) {
    const Vec3 normal = slabs.normal(f);
    if (is_folded(slabs, f, facet)) continue;
    at_corner = at_corner + normal;
    if (f == facet) continue;
    if (has_corner(view, f, corner[p.beside_u])) across_u = own + normal;
    if (has_corner(view, f, corner[p.beside_v])) across_v = own + normal;
  }
  const auto unit = [](Vec3 v) { return v * (1.0 / norm(v)); };
  const double u = p.u, v = p.v;
  return unit(unit(at_corner) * ((1.0 - u) * (1.0 - v)) + unit(across_u) * (u * (1.0 - v)) +
              unit(across_v) * ((1.0 - u) * v) + own * (u * v));
}

}  // namespace kerf::surfaces
