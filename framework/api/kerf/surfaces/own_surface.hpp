// The surface that a slave itself belongs to, and the facets of other bodies that it cannot touch because they lie side
// by side with that surface.
#pragma once

#include <kerf/contact.hpp>
#include <kerf/lanes.hpp>

#include <cmath>

#include <kerf/surfaces/facet_slabs.hpp>

namespace kerf::surfaces {

/// Unit normal of the surface around slave i of a view; zero for a free node, which has no surface.
inline Vec3 own_normal(const ContactView& view, int i) {
  Vec3 own;
  for (const std::int32_t facet : view.around_slave(i)) {
    const std::int32_t* n = view.facet_nodes + 4 * static_cast<std::int64_t>(facet);
    own = own + cross(view.x(n[2]) - view.x(n[0]), view.x(n[3]) - view.x(n[1]));
  }
  const double length = norm(own);
  return length > 0.0 ? own * (1.0 / length) : Vec3{};
}

inline constexpr double same_way = 0.2;  // cosine between the normals of surfaces that cannot touch
inline constexpr double flush_height = 0.05;  // height over a facet's plane, in its longest edge

/// The lanes whose facets a node of the given own normal is beside: where two bodies are flush, the sides of one are as
/// close to the other's rim as its front.
inline unsigned beside(const FacetSlabs::Seen& seen, Vec3 own) {
  return mask_of((seen.along(own) > same_way) & (abs_of(seen.height) < flush_height * seen.size));
}
/// The same of one facet.
inline bool is_beside(const FacetSlabs& slabs, int facet, Vec3 own, Vec3 s) {
  const double height = dot(s - slabs.centre(facet), slabs.normal(facet));
  return dot(slabs.normal(facet), own) > same_way && std::fabs(height) < flush_height * slabs.size(facet);
}

}  // namespace kerf::surfaces
