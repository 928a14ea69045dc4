// Contact of any exterior nodes with any exterior facets of the chosen parts, as elements erode.
//
// Every node is pushed out of each body that it is inside of, to the closest point of that body's surface, if it is no
// deeper than the facet's element is thick. Bodies are asked one by one: that a node is outside of one says nothing
// about another. Nothing is remembered from step to step, so nothing can be lost when facets vanish, appear or move to
// another rank. Facets are taken as four triangles round their centre, which closes the surface without gaps.
#include <kerf/contact_geometry.hpp>

#include <algorithm>
#include <bit>
#include <span>

#include <kerf/surfaces/closing_pairs.hpp>
#include <kerf/surfaces/edge_touches.hpp>
#include <kerf/surfaces/own_surface.hpp>
#include <kerf/surfaces/smooth_normal.hpp>

namespace {

using namespace kerf;
using namespace kerf::surfaces;

struct ErodingSurface final : Contact {
  std::vector<std::string> parts;
  double penalty = 0.4, damping = 0.2, friction = 0.0, depth = 0.6, stability = 0.4;
  static constexpr double opposing = -0.2;  // cosine between the normals of surfaces that may touch
  static constexpr double straight_below = -0.95;  // cosine between the way to the closest point and the normal
  static constexpr double straight_enough = 0.925;  // cosine between the way to the closest point and the smooth normal
  static constexpr double straight_angle = 3.14159265358979323846;
  static constexpr double on_surface = 1e-9;  // depth that is round-off, in the facet's longest edge
  bool self_contact = true, edges = true;

  static void describe(Schema<ErodingSurface>& s) {
    s.texts(&ErodingSurface::parts, "parts", "parts or sets in contact with one another; all where absent").optional();
    s.boolean(&ErodingSurface::self_contact, "self_contact", "whether a part touches itself").by_default("true");
    s.real(&ErodingSurface::penalty, "penalty", "-", positive,
           "factor f of the stiffness f K A^2 / V with which a depth is taken back")
        .by_default("0.4");
    s.real(&ErodingSurface::stability, "stability", "-", between(0.0, 1.0),
           "upper bound of the stiffness with which a depth is taken back, in units of effective mass over dt squared")
        .by_default("0.4");
    s.real(&ErodingSurface::damping, "damping", "-", between(0.0, 1.0),
           "one minus the greatest speed at which a depth is taken back, over the speed at which the pair closed")
        .by_default("0.2");
    s.real(&ErodingSurface::friction, "friction", "-", non_negative, "Coulomb friction coefficient").by_default("0");
    s.real(&ErodingSurface::depth, "depth", "-", between(0.1, 1.0),
           "greatest penetration that is held, over the least of the thickness V/A of the facet's element, the "
           "facet's longest edge and the longest edge of the undeformed facet")
        .by_default("0.6");
    s.boolean(&ErodingSurface::edges, "edges", "whether sharp edges that cross touch, too").by_default("true");
    s.integer(&Contact::search_interval, "search_interval", positive, "cycles that candidates are looked for ahead")
        .by_default("10");
  }

  ContactRequest request() const override {
    ContactRequest r;
    r.slaves = parts;
    r.masters = parts;
    r.same_part = self_contact;
    r.free_nodes = true;
    return r;
  }

  // Whatever lies closer to a node than the facet that would push it must be a candidate too, for the closest facet
  // decides: the reach covers the depth of facets that were as large as this one. It does not change, so that no search
  // has to foresee how facets may stretch.
  double reach(const FacetBounds& facet) const override { return FacetSlabs::reach_of(depth, facet.edge); }

  void find_touches(const ContactView& view, ContactTouches& touches) const override {
    const FacetSlabs slabs(view, depth);
    const ClosingPairs pairs(view, slabs);
    Near near;
    for (int i = 0; i < view.n_slaves; ++i) {
      pairs.limit_step(i, touches);
      each_touch(view, i, slabs, near, [&](int facet, const Touch& t) {
        hold_or_let_go(view, i, slabs, penalty, smooth_touch(view, view.slave[i], facet, t, slabs, near), touches);
      });
    }
    if (edges) EdgeTouches(view, slabs, opposing).find(touches);
  }

  ContactResponse response() const override {
    return {.restitution = 1.0 - damping, .stability = stability, .friction = friction};
  }

  int penetrations(const ContactView& view, std::vector<int>& nodes, std::vector<double>& depths) const override {
    const FacetSlabs slabs(view, depth);
    Near near;
    for (int i = 0; i < view.n_slaves; ++i) {
      double deepest = 0.0;
      each_touch(view, i, slabs, near, [&](int facet, const Touch& t) {
        if (t.distance >= 1e-6 * slabs.size(facet)) deepest = max_of(deepest, t.distance);
      });
      if (!(deepest > 0.0)) continue;
      nodes.push_back(view.slave[i]);
      depths.push_back(deepest);
    }
    return static_cast<int>(nodes.size());
  }

 private:
  /// The facets of one body that a node may be within reach of.
  struct Near {
    struct Facet {
      std::int32_t facet;
      double least_square;  // [m2]
    };
    struct Found {
      std::int32_t facet;
      Touch touch;
      Vec3 point;  // of the facet, that is closest to the node [m]
    };
    std::vector<Facet> facets;
    std::vector<Found> found;  // the closest ones: several, where points of the surface are equally close
    int first = -1;  // the facet that is probably closest
    double least_flush = 1e300;  // of those that are left out as flush [m2]
    std::vector<std::int32_t> round;  // facets round one corner
  };

  /// The touch of a node with a surface. Where the surface is smooth, it is at the point where the node passes through
  /// the facet, or below which it is already at the start of the step, and along the normal without jumps: the closest
  /// point to the end of the way jumps from one facet to the next, and interfaces under pressure would buckle.
  static ContactTouch smooth_touch(const ContactView& view, int node, int facet, const Touch& t,
                                   const FacetSlabs& slabs, Near& near) {
    ContactTouch touch;
    touch.node = node;
    touch.facet = facet;
    for (int k = 0; k < 4; ++k) touch.weights[k] = t.weights[k];
    touch.direction = t.direction;
    touch.depth = t.distance;
    Touch entry = t;
    if (closing_speed(view, touch) > 0.0)
      entry = touch_facet(Triangles(view, facet), slabs.size(facet), point_of_entry(view, touch));
    ContactTouch smooth = touch;
    for (int k = 0; k < 4; ++k) smooth.weights[k] = entry.weights[k];
    smooth.direction = normal_near(view, view.x(node), facet, entry, slabs, near);
    const double along = dot(smooth.direction, t.direction);
    if (along < straight_enough) return touch;  // at an edge of the body
    const double depth = depth_of(view, smooth);
    if (!(depth > 0.0)) return touch;  // it slides past the facet
    smooth.depth = max_of(depth, t.distance * along);
    return smooth;
  }

  /// The normal without jumps at the point of a facet that is closest to where the node enters. Facets round its corner
  /// count within their reach of the node, since others are listed or not by chance.
  static Vec3 normal_near(const ContactView& view, Vec3 s, int facet, const Touch& t, const FacetSlabs& slabs,
                          Near& near) {
    const std::int32_t* n = view.facet_nodes + 4 * static_cast<std::int64_t>(facet);
    const CornerPoint p = CornerPoint::of_weights(t.weights, n_corners(n) == 3);
    near.round.clear();
    const std::int32_t corner = n[p.corner];
    for (const auto& [f, least_square] : near.facets) {
      if (!has_corner(view, f, corner)) continue;
      if (f == facet || touch_facet(Triangles(view, f), slabs.size(f), s).distance <= slabs.reach(f))
        near.round.push_back(f);
    }
    return smooth_normal(view, slabs, near.round, facet, p);
  }

  /// Calls `push(facet, touch)` for every body that a slave is to be pushed out of. Candidates are sorted by facet id,
  /// hence by part.
  template <class Push>
  void each_touch(const ContactView& view, int i, const FacetSlabs& slabs, Near& near, const Push& push) const {
    const Vec3 s = view.x(view.slave[i]);
    Vec3 own;
    bool has_own = false;
    const std::span<const std::int32_t> row = view.candidates_of(i);
    const std::int32_t *from = row.data(), *end = from + row.size();
    while (from != end) {
      const std::int32_t* to = from;
      while (to != end && view.facet_body[*to] == view.facet_body[*from]) ++to;
      // A free node has no facets of its own: to it, the surface of its part is closed like another body's.
      const bool same_part = view.facet_body[*from] == view.node_body[view.slave[i]] && !view.around_slave(i).empty();
      // Most slaves are near no facet of a body that could push them, and cost no more than this.
      const bool any = FacetSlabs::until({from, to}, [&](const std::int32_t* some, unsigned in_use) {
        const FacetSlabs::Seen seen(slabs, some, s);
        unsigned pushing = seen.may_push() & in_use;
        if (pushing == 0) return false;
        pushing &= seen.within_reach(seen.least_square());
        if (pushing == 0) return false;
        if (!has_own) own = own_normal(view, i);
        has_own = true;
        return !same_part || (pushing & mask_of(seen.along(own) < opposing)) != 0;
      });
      if (any) {
        locate(view, view.slave[i], own, same_part, {from, to}, slabs, near);
        for (const auto& found : near.found) push(found.facet, found.touch);
      }
      from = to;
    }
  }

  /// Whether a surface with one normal may touch one of the same body with another.
  static bool faces(Vec3 own, Vec3 normal) { return dot(own, own) == 0.0 || dot(own, normal) < opposing; }

  /// Finds the facet of one body that the node is to be pushed out of. The closest one decides; among facets that share
  /// the closest point, the one that faces the node; ties go to the lower facet id, which comes first. Where different
  /// points are equally close, the node is pushed away from each of them, so that what is symmetric stays so.
  void locate(const ContactView& view, int node, Vec3 own, bool same_part, std::span<const std::int32_t> facets,
              const FacetSlabs& slabs, Near& near) const {
    const Vec3 s = view.x(node);
    list_near(s, own, same_part, facets, slabs, near);
    find_closest(view, s, slabs, near);
    std::erase_if(near.found,
                  [&](Near::Found& found) { return !is_inside(view, s, own, same_part, facets, slabs, near, found); });
  }

  /// Whether a node is inside of a body, and near enough to its closest point to be pushed out there. Refines the touch
  /// where that point is on an edge.
  bool is_inside(const ContactView& view, Vec3 s, Vec3 own, bool same_part, std::span<const std::int32_t> facets,
                 const FacetSlabs& slabs, const Near& near, Near::Found& found) const {
    Touch& t = found.touch;
    if (t.distance > FacetSlabs::sight * slabs.deepest(found.facet)) return false;
    if (t.distance < on_surface * slabs.size(found.facet)) return false;
    // Within one body the facets around the node are no candidates, so the surface has gaps there: only what is
    // straight below a facet that faces the node is believed to be inside.
    if (same_part) return t.side < straight_below && faces(own, slabs.normal(found.facet));
    if (std::fabs(t.side) > 1.0 - 1e-9) return t.side < 0.0;
    // Below an edge or a corner the surface as a whole decides; mostly all facets that hold the point agree.
    const double around = t.distance + 1e-6 * slabs.size(found.facet);
    if (t.lowest >= 0.0 && near.least_flush > around * around) return false;
    const Vec3 away = s - found.point;
    if (!(dot(away, normal_at(view, facets, slabs, found.point, t.distance)) < 0.0)) return false;
    // A node on the edge itself is off it by round-off alone: length and direction must be those of one vector.
    t.distance = norm(away);
    if (!(t.distance > 0.0)) return false;
    t.direction = away * (-1.0 / t.distance);
    return true;
  }

  /// Lists the facets of one body that the node may be within reach of, and which of them is probably closest.
  void list_near(Vec3 s, Vec3 own, bool same_part, std::span<const std::int32_t> facets, const FacetSlabs& slabs,
                 Near& near) const {
    near.facets.clear();
    near.first = -1;
    near.least_flush = 1e300;
    double least = 1e300;
    FacetSlabs::until(facets, [&](const std::int32_t* some, unsigned in_use) {
      const FacetSlabs::Seen seen(slabs, some, s);
      const Lanes square = seen.least_square();
      unsigned near_by = seen.within_reach(square) & in_use;
      if (near_by == 0) return false;
      const unsigned flush = same_part ? 0u : beside(seen, own);
      for (; near_by != 0; near_by &= near_by - 1) {
        const int l = std::countr_zero(near_by);
        if ((flush >> l & 1u) != 0) {
          near.least_flush = min_of(near.least_flush, square[l]);
          continue;
        }
        near.facets.push_back({some[l], square[l]});
        if (square[l] < least) near.first = some[l];
        least = min_of(least, square[l]);
      }
      return false;
    });
  }

  /// Finds the closest of the near facets within their own reach. Most need not be looked at after the likely one.
  void find_closest(const ContactView& view, Vec3 s, const FacetSlabs& slabs, Near& near) const {
    near.found.clear();
    if (near.first < 0) return;
    const auto touch = [&](int f) { return touch_facet(Triangles(view, f), slabs.size(f), s); };
    const Touch guess = touch(near.first);
    const bool counts = guess.distance <= slabs.reach(near.first);
    const double enough = counts ? guess.distance + 1e-6 * slabs.size(near.first) : 1e150;
    double least = 1e300, size = 0.0;
    for (const auto& [f, least_square] : near.facets) {
      if (least_square > enough * enough) continue;
      const Touch t = f == near.first ? guess : touch(f);
      if (!(t.distance <= slabs.reach(f))) continue;
      const double tolerance = 1e-9 * max_of(slabs.size(f), size);
      if (t.distance > least + tolerance) continue;
      if (t.distance < least - tolerance) near.found.clear();
      if (near.found.empty()) {
        least = t.distance;
        size = slabs.size(f);
      }
      add_closest({f, t, point_of(view, f, t)}, tolerance, near.found);
    }
  }

  static Vec3 point_of(const ContactView& view, int facet, const Touch& t) {
    const std::int32_t* corners = view.facet_nodes + 4 * static_cast<std::int64_t>(facet);
    Vec3 point;
    for (int k = 0; k < 4; ++k) point = point + view.x(corners[k]) * t.weights[k];
    return point;
  }

  /// Adds one of several equally close facets; of facets that share the closest point, the one that faces the node is
  /// kept.
  static void add_closest(const Near::Found& next, double tolerance, std::vector<Near::Found>& found) {
    for (Near::Found& other : found) {
      const Vec3 d = next.point - other.point;
      if (!(dot(d, d) <= tolerance * tolerance)) continue;
      const double lowest = min_of(other.touch.lowest, next.touch.lowest);
      if (std::fabs(next.touch.side) > std::fabs(other.touch.side)) other = next;
      other.touch.lowest = lowest;
      return;
    }
    found.push_back(next);
  }

  /// Sum of the normals of all triangles that hold a point of a body's surface, each weighted by the angle that it
  /// takes up there: a point near an edge or a corner is inside just where it lies below this normal (Baerentzen &
  /// Aanaes, "Signed distance computation using the angle weighted pseudonormal", IEEE TVCG 11 (2005) 243-253).
  Vec3 normal_at(const ContactView& view, std::span<const std::int32_t> facets, const FacetSlabs& slabs, Vec3 point,
                 double distance) const {
    Vec3 sum;
    for (const std::int32_t f : facets) {
      // Whether a facet that is out of its own reach is listed is a matter of chance.
      if (distance > slabs.reach(f)) continue;
      const double size = slabs.size(f), tolerance = 1e-7 * size;
      const Vec3 d = point - slabs.centre(f);
      if (!(dot(d, d) < 2.0 * size * size)) continue;
      const FacetGeometry g(view, f);
      for (int k = 0; k < 4; ++k) {
        const Vec3 corner[3] = {g.x[k], g.x[(k + 1) % 4], g.centre};
        const Closest c = closest_on_triangle(point, corner[0], corner[1], corner[2]);
        if (norm(corner[0] * c.a + corner[1] * c.b + corner[2] * c.c - point) > tolerance) continue;
        const Vec3 twice = cross(corner[1] - corner[0], corner[2] - corner[0]);
        const double length = norm(twice);
        if (!(length > 0.0)) continue;
        double angle = straight_angle;
        for (int m = 0; m < 3; ++m)
          if (norm(point - corner[m]) <= tolerance)
            angle = angle_at(corner[m], corner[(m + 1) % 3], corner[(m + 2) % 3]);
        sum = sum + twice * (angle / length);
      }
    }
    return sum;
  }

  static double angle_at(Vec3 corner, Vec3 a, Vec3 b) {
    const Vec3 u = a - corner, v = b - corner;
    return kerf::acos(clamp_to(dot(u, v) / (norm(u) * norm(v)), -1.0, 1.0));
  }
};

}  // namespace

KERF_CONTACT(ErodingSurface, "eroding_surface",
             "any exterior facets against any exterior nodes, with facets opened by erosion and free nodes")
