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

/// A point of a facet in natural coordinates, and the corner in whose quarter it lies.
struct NaturalPoint {
  double xi = 0.0, eta = 0.0;
  int corner = 0;
};

/// The normal at a point of a facet, given all facets round the corner that is nearest to it. With the normals of
/// single facets, bodies without strength would buckle, since a node on an edge would be pushed sideways by whichever
/// facet it falls to. In the quarter round the corner the normal is bilinear between the mean normals of all facets
/// round that corner, of the two facets along either edge, and of the facet itself. Facets that are folded against it
/// do not count.
inline Vec3 smooth_normal(const ContactView& view, const FacetSlabs& slabs, const std::vector<std::int32_t>& round,
                          std::int32_t facet, const NaturalPoint& p) {
  const std::int32_t* corner = view.facet_nodes + 4 * static_cast<std::int64_t>(facet);
  const bool is_right = p.corner == 1 || p.corner == 2, is_upper = p.corner >= 2;
  const int beside_xi = is_upper ? 5 - p.corner : 1 - p.corner, beside_eta = 3 - p.corner;
  const Vec3 own = slabs.normal(facet);
  Vec3 at_corner, across_xi = own, across_eta = own;
  for (const std::int32_t f : round) {
    const Vec3 normal = slabs.normal(f);
    if (is_folded(slabs, f, facet)) continue;
    at_corner = at_corner + normal;
    if (f == facet) continue;
    if (has_corner(view, f, corner[beside_xi])) across_xi = own + normal;
    if (has_corner(view, f, corner[beside_eta])) across_eta = own + normal;
  }
  const auto unit = [](Vec3 v) { return v * (1.0 / norm(v)); };
  const double u = clamp_to(is_right ? 1.0 - p.xi : 1.0 + p.xi, 0.0, 1.0);
  const double v = clamp_to(is_upper ? 1.0 - p.eta : 1.0 + p.eta, 0.0, 1.0);
  return unit(unit(at_corner) * ((1.0 - u) * (1.0 - v)) + unit(across_xi) * (u * (1.0 - v)) +
              unit(across_eta) * ((1.0 - u) * v) + own * (u * v));
}

}  // namespace kerf::surfaces
