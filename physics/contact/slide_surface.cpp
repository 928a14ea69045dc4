// The classical master/slave slide surface: nearest master node, segments round it, projection, touch.
//
// Sources: J.O. Hallquist, G.L. Goudreau & D.J. Benson, "Sliding interfaces with contact-impact in large-scale
// Lagrangian computations", CMAME 51 (1985) 107-137; penalty f K A^2 / V as used by Ren & Wang, Explosion and
// Shock Waves 25 (2005) 260-264.
#include <algorithm>
#include <bit>
#include <cmath>
#include <span>
#include <tuple>
#include <vector>

#include <kerf/surfaces/closing_pairs.hpp>
#include <kerf/surfaces/own_surface.hpp>
#include <kerf/surfaces/smooth_normal.hpp>

namespace {

using namespace kerf;
using namespace kerf::surfaces;

/// Where a node projects on four bilinear segments, side by side.
struct Projections {
  Four xi{}, eta{}, gap{};  // gap: distance along the normal, negative below the surface [m]
  FourVectors normal{};
  FourInt converged{};
};

/// What is linear in the natural coordinate of one pair of edges, at its value `a` and the other pair's value `b`.
struct Tangents {
  FourVectors along_xi, along_eta;

  Tangents(const FourVectors (&x)[4], Four a, Four b)
      : along_xi((x[1] - x[0]) * (1.0 - b) + (x[2] - x[3]) * (1.0 + b)),
        along_eta((x[3] - x[0]) * (1.0 - a) + (x[2] - x[1]) * (1.0 + a)) {}
};

inline FourVectors point_of(const FourVectors (&x)[4], Four a, Four b) {
  return (x[0] * ((1.0 - a) * (1.0 - b)) + x[1] * ((1.0 + a) * (1.0 - b)) + x[2] * ((1.0 + a) * (1.0 + b)) +
          x[3] * ((1.0 - a) * (1.0 + b))) *
         (Four{} + 0.25);
}

/// Newton iteration for the points where the segments' normals pass through the node (Hallquist et al. 1985,
/// eqs. 5-8); the fixed number of steps keeps the result independent of round-off in a stopping test. One piece of code
/// for all callers: inlined, it might be contracted in another way at each.
[[gnu::noinline]] void project(const FourVectors (&x)[4], Vec3 node, Projections& p) {
  const FourVectors s = all_four(node);
  const Four quarter = Four{} + 0.25, one = Four{} + 1.0, most = Four{} + 2.0;
  const FourVectors twist = (x[0] - x[1] + x[2] - x[3]) * quarter;
  const auto bounded = [most](Four v) {
    const Four below = v < most ? v : most;
    return below > -most ? below : -most;
  };
  p = {};
  p.converged = one > 0.0;
  for (int step = 0; step < 8; ++step) {
    const Tangents t(x, p.xi, p.eta);
    const FourVectors ra = t.along_xi * quarter, rb = t.along_eta * quarter, d = point_of(x, p.xi, p.eta) - s;
    const Four f1 = dot(ra, d), f2 = dot(rb, d);
    const Four h11 = dot(ra, ra), h22 = dot(rb, rb), h12 = dot(ra, rb) + dot(twist, d);
    const Four det = h11 * h22 - h12 * h12;
    p.converged &= det > 0.0;
    const Four inverse = 1.0 / (det > 0.0 ? det : one);
    p.xi = bounded(p.xi - (h22 * f1 - h12 * f2) * inverse);
    p.eta = bounded(p.eta - (h11 * f2 - h12 * f1) * inverse);
  }
  const Tangents t(x, p.xi, p.eta);
  const FourVectors n = cross(t.along_xi, t.along_eta);
  const Four length = root(dot(n, n));
  p.converged &= length > 0.0;
  p.normal = n * (1.0 / (length > 0.0 ? length : one));
  p.gap = dot(s - point_of(x, p.xi, p.eta), p.normal);
}

/// Where a node projects on a triangle.
struct TriangleProjection {
  double share[3] = {};  // barycentric; negative beyond an edge
  double gap = 0.0;  // distance along the normal, negative below the surface [m]
  Vec3 normal;
  bool has_area = false;

  /// How far the point is beyond the edges, in natural coordinates: these go from -1 to 1 where a share goes from 0
  /// to 1.
  double outside() const { return 2.0 * max_of(-min_of(share[0], min_of(share[1], share[2])), 0.0); }
};

/// One piece of code for all callers, as `project`.
[[gnu::noinline]] TriangleProjection project_on_triangle(Vec3 a, Vec3 b, Vec3 c, Vec3 node) {
  TriangleProjection p;
  const Vec3 twice = cross(b - a, c - a), to = node - a;
  const double square = dot(twice, twice);
  p.has_area = square > 0.0;
  if (!p.has_area) return p;
  p.normal = twice * (1.0 / std::sqrt(square));
  p.share[1] = dot(cross(to, c - a), twice) / square;
  p.share[2] = dot(cross(b - a, to), twice) / square;
  p.share[0] = 1.0 - p.share[1] - p.share[2];
  p.gap = dot(to, p.normal);
  return p;
}

/// A segment that holds a node.
struct Held {
  std::int32_t facet = -1;
  double xi = 0.0, eta = 0.0, gap = 0.0;
  Vec3 normal;
  double share[3] = {};  // in place of xi and eta, where the segment is a triangle
  bool is_triangle = false;

  ContactTouch touch(int node) const {
    ContactTouch t;
    t.node = node;
    t.facet = facet;
    t.weights[0] = 0.25 * (1.0 - xi) * (1.0 - eta);
    t.weights[1] = 0.25 * (1.0 + xi) * (1.0 - eta);
    t.weights[2] = 0.25 * (1.0 + xi) * (1.0 + eta);
    t.weights[3] = 0.25 * (1.0 - xi) * (1.0 + eta);
    if (is_triangle)
      for (int k = 0; k < 4; ++k) t.weights[k] = k < 3 ? share[k] : 0.0;
    t.direction = normal;
    t.depth = -gap;
    return t;
  }
};

/// Room for what is found about one slave, kept from one to the next.
struct Room {
  struct SomeFacets {
    Lanes square;  // of a distance that no point of a facet is closer than [m2]
  };
  std::vector<SomeFacets> least;  // of all candidates
  std::vector<std::int32_t> near, round;  // facets that may have the nearest node, and that have it
  std::int64_t nearest_id = -1;  // of the nearest node
};

struct SlideSurface final : Contact {
  std::vector<std::string> slave, master;
  static constexpr double stability = 0.4;  // of effective mass over dt squared
  double penalty = 0.1, damping = 0.0, friction = 0.0, overlap = 0.02, depth = 1.0;
  bool symmetric = false;

  static void describe(Schema<SlideSurface>& s) {
    s.texts(&SlideSurface::slave, "slave", "parts or sets whose exterior nodes are slaves");
    s.texts(&SlideSurface::master, "master", "parts or sets whose exterior facets are masters");
    s.real(&SlideSurface::penalty, "penalty", "-", positive,
           "factor f of the stiffness f K A^2 / V with which a depth is taken back")
        .by_default("0.1");
    s.real(&SlideSurface::damping, "damping", "-", between(0.0, 1.0),
           "one minus the greatest speed at which a depth is taken back, over the speed at which the pair closed")
        .by_default("0");
    s.real(&SlideSurface::friction, "friction", "-", non_negative, "Coulomb friction coefficient").by_default("0");
    s.boolean(&SlideSurface::symmetric, "symmetric", "a second pass with the roles exchanged").by_default("false");
    s.real(&SlideSurface::overlap, "overlap", "-", between(0.0, 0.5),
           "how far beyond its edges a segment still takes nodes, in natural coordinates")
        .by_default("0.02");
    s.real(
         &SlideSurface::depth, "depth", "-", between(0.1, 1.0),
         "greatest penetration that is held, over the least of the thickness V/A of the master element, the segment's "
         "longest edge and the longest edge of the undeformed segment")
        .by_default("1");
    s.integer(&Contact::search_interval, "search_interval", positive, "cycles that candidates are looked for ahead")
        .by_default("10");
    s.rule("slave", "name at least one slave and one master",
           [](const SlideSurface& c) { return !c.slave.empty() && !c.master.empty(); });
  }

  ContactRequest request() const override {
    ContactRequest r;
    r.slaves = slave;
    r.masters = master;
    r.symmetric = symmetric;
    r.same_part = true;
    return r;
  }

  // From a point of a bilinear segment to its nearest corner it is no farther than an edge is long: with natural
  // coordinates u and v of at most a half from there, the way is u e1 + (1 - u) v e2 + u v e3.
  double reach(const FacetBounds& facet) const override {
    return facet.longest_edge + FacetSlabs::reach_of(depth, facet.edge);
  }

  double sight(const FacetBounds& facet) const override { return FacetSlabs::reach_of(depth, facet.edge); }

  void find_touches(const ContactView& view, ContactTouches& touches) const override {
    const FacetSlabs slabs(view, depth);
    const ClosingPairs pairs(view, slabs);
    Room room;
    for (int i = 0; i < view.n_slaves; ++i) {
      pairs.limit_step(i, touches);
      const Held held = locate(view, i, slabs, room);
      if (held.facet >= 0 && held.gap < 0.0)
        hold_or_let_go(view, i, slabs, penalty, touch_of(view, view.slave[i], slabs, room, held), touches);
    }
  }

  ContactResponse response() const override {
    return {.restitution = 1.0 - damping, .stability = stability, .friction = friction};
  }

  int penetrations(const ContactView& view, std::vector<int>& nodes, std::vector<double>& depths) const override {
    const FacetSlabs slabs(view, depth);
    Room room;
    for (int i = 0; i < view.n_slaves; ++i) {
      const Held held = locate(view, i, slabs, room);
      if (held.facet < 0 || held.gap > -1e-6 * slabs.size(held.facet)) continue;
      nodes.push_back(view.slave[i]);
      depths.push_back(-held.gap);
    }
    return static_cast<int>(nodes.size());
  }

 private:
  /// Steps 1 to 3: the nearest master node, the segments round it, the projection.
  Held locate(const ContactView& view, int i, const FacetSlabs& slabs, Room& room) const {
    const Vec3 s = view.x(view.slave[i]);
    const std::span<const std::int32_t> facets = view.candidates_of(i);
    const int likely = likely_nearest(facets, s, slabs, room);
    if (likely < 0) return {};
    list_round(view, facets, likely, s, slabs, room);
    const Vec3 own = own_normal(view, i);
    std::erase_if(room.round, [&](std::int32_t f) { return is_beside(slabs, f, own, s); });
    return best_of(view, room.round, s, slabs);
  }

  /// The touch of a node that will be below a segment: at the point where it passes through the surface, or that it is
  /// below already at the start of the step. The point below its end may be far from there, and jumps from one segment
  /// to the next, so that bodies without strength would buckle.
  ContactTouch touch_of(const ContactView& view, int node, const FacetSlabs& slabs, Room& room, const Held& end) const {
    ContactTouch touch = end.touch(node);
    if (!(closing_speed(view, touch) > 0.0)) return touch;
    const Vec3 entry = point_of_entry(view, touch);
    // What slides past an edge has not come through the side of the body.
    std::erase_if(room.round, [&](std::int32_t f) { return is_folded(slabs, f, end.facet); });
    Held held = best_of(view, room.round, entry, slabs);
    if (held.facet < 0) return touch;
    held.normal = normal_at(view, slabs, room, held);
    touch = held.touch(node);
    touch.depth = depth_of(view, touch);
    return touch;
  }

  static Vec3 normal_at(const ContactView& view, const FacetSlabs& slabs, const Room& room, const Held& held) {
    const std::int32_t* corner = view.facet_nodes + 4 * static_cast<std::int64_t>(held.facet);
    int k = 0;
    while (k < n_corners(corner) - 1 && view.node_id[corner[k]] != room.nearest_id) ++k;
    const CornerPoint point =
        held.is_triangle ? CornerPoint::of_triangle(held.share, k) : CornerPoint::of_quad(held.xi, held.eta, k);
    return smooth_normal(view, slabs, room.round, held.facet, point);
  }

  /// The facet that probably has the nearest master node, with what no facet is closer than; or -1 where none can hold
  /// the node, which is the case for most.
  int likely_nearest(std::span<const std::int32_t> facets, Vec3 s, const FacetSlabs& slabs, Room& room) const {
    const double stretch = (1.0 + overlap) * (1.0 + overlap) * (1.0 + 1e-6);  // of segments beyond their edges
    room.least.clear();
    int likely = -1;
    double closest = 1e300;
    bool any = false;
    FacetSlabs::until(facets, [&](const std::int32_t* some, unsigned in_use) {
      const FacetSlabs::Seen seen(slabs, some, s);
      const Lanes least = seen.least_square(), from_centre = seen.across + seen.height * seen.height;
      const Lanes held = 1.01 * FacetSlabs::sight * seen.deepest, warp = stretch * seen.warp;
      const Lanes most = stretch * seen.radius + held;
      any = any || (mask_of((seen.height <= 1e-6 * seen.size + warp) & (seen.height >= -held - warp) &
                            (seen.across <= most * most)) &
                    in_use) != 0;
      room.least.push_back({least});
      for (unsigned closer = mask_of(from_centre < closest) & in_use; closer != 0; closer &= closer - 1) {
        const int l = std::countr_zero(closer);
        if (!(from_centre[l] < closest)) continue;
        closest = from_centre[l];
        likely = some[l];
      }
      return false;
    });
    return any ? likely : -1;
  }

  /// Lists the segments round the nearest master node; ties go to the lower id. Only corners within the reach of their
  /// segments count, since others are listed or not by chance.
  void list_round(const ContactView& view, std::span<const std::int32_t> facets, int likely, Vec3 s,
                  const FacetSlabs& slabs, Room& room) const {
    double nearest = 1e300;
    std::int64_t nearest_id = -1;
    const auto sees = [&](std::int32_t f, double square) {
      const double reach = slabs.size(f) + slabs.reach(f);
      return square <= reach * reach;
    };
    const auto compare_corners = [&](std::int32_t f) {
      for (int k = 0; k < 4; ++k) {
        const std::int32_t n = view.facet_nodes[4 * static_cast<std::int64_t>(f) + k];
        const Vec3 d = view.x(n) - s;
        const double square = dot(d, d);
        if (square > nearest || (square == nearest && view.node_id[n] >= nearest_id) || !sees(f, square)) continue;
        nearest = square;
        nearest_id = view.node_id[n];
      }
    };
    compare_corners(likely);
    room.near.clear();
    for (std::size_t k = 0; k < facets.size(); ++k) {
      if (room.least[k / register_lanes].square[k % register_lanes] > nearest) continue;
      compare_corners(facets[k]);
      room.near.push_back(facets[k]);
    }
    room.nearest_id = nearest_id;
    room.round.clear();
    for (const std::int32_t f : room.near) {
      const std::int32_t* n = view.facet_nodes + 4 * static_cast<std::int64_t>(f);
      bool round = false;
      for (int k = 0; k < 4; ++k) round = round || view.node_id[n[k]] == nearest_id;
      if (round && sees(f, nearest)) room.round.push_back(f);
    }
  }

  /// The bilinear coordinates of a triangle are not unique at the corner that it repeats, so it has its own. False
  /// where it has no area.
  static bool hold_on_triangle(const ContactView& view, Vec3 s, Held& held, double& outside) {
    const std::int32_t* n = view.facet_nodes + 4 * static_cast<std::int64_t>(held.facet);
    const TriangleProjection p = project_on_triangle(view.x(n[0]), view.x(n[1]), view.x(n[2]), s);
    held.is_triangle = true;
    std::copy_n(p.share, 3, held.share);
    held.gap = p.gap;
    held.normal = p.normal;
    outside = p.outside();
    return p.has_area;
  }

  /// The segment that holds the node: one that is not too deep below before one that is, then the one that holds it
  /// best within its edges, then the one nearest to its surface, then the one of the lower id, which comes first.
  Held best_of(const ContactView& view, const std::vector<std::int32_t>& segments, Vec3 s,
               const FacetSlabs& slabs) const {
    Held best;
    bool best_deep = true;
    double best_outside = 1e300;
    for (std::size_t first = 0; first < segments.size(); first += 4) {
      FourVectors x[4];
      const auto segment = [&](std::size_t l) { return segments[std::min(first + l, segments.size() - 1)]; };
      for (std::size_t k = 0; k < 4; ++k) {
        Four row[4];
        for (std::size_t l = 0; l < 4; ++l)
          row[l] = detail::row_of(view.position, view.facet_nodes[4 * static_cast<std::size_t>(segment(l)) + k]);
        x[k] = transposed(row);
      }
      Projections p;
      project(x, s, p);
      for (int l = 0; l < 4 && first + static_cast<std::size_t>(l) < segments.size(); ++l) {
        const std::int32_t f = segment(static_cast<std::size_t>(l));
        Held found{f, p.xi[l], p.eta[l], p.gap[l], p.normal.at(l)};
        double outside = max_of(max_of(std::fabs(p.xi[l]), std::fabs(p.eta[l])) - 1.0, 0.0);
        bool is_sound = p.converged[l] != 0;
        if (n_corners(view.facet_nodes + 4 * static_cast<std::int64_t>(f)) == 3) [[unlikely]]
          is_sound = hold_on_triangle(view, s, found, outside);
        if (!is_sound || outside > overlap || -found.gap > FacetSlabs::sight * slabs.deepest(f)) continue;
        const bool deep = -found.gap > slabs.deepest(f);
        const auto rank = [](bool is_deep, double out, double gap) { return std::tuple(is_deep, out, std::fabs(gap)); };
        if (best.facet >= 0 && !(rank(deep, outside, found.gap) < rank(best_deep, best_outside, best.gap))) continue;
        best = found;
        best_deep = deep;
        best_outside = outside;
      }
    }
    return best;
  }
};

}  // namespace

KERF_CONTACT(SlideSurface, "slide_surface",
             "classical master/slave slide surface; depths are taken back with stiffness f K A^2 / V")
