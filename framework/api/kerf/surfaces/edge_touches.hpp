// Touches of the edges of one surface with those of another: where two sharp edges cross, bodies may share volume
// though no node of one is inside of the other.
//
// A pair is found by one of the four end nodes, through its candidate facets. All numbers of a pair are computed in an
// order that ids alone decide about, so every rank that sees a pair gets the same bits, and only one of them reports
// it.
#pragma once

#include <bit>
#include <cmath>
#include <cstdint>
#include <span>
#include <utility>
#include <vector>

#include <kerf/contact_geometry.hpp>

#include <kerf/surfaces/closing_pairs.hpp>
#include <kerf/surfaces/facet_slabs.hpp>

namespace kerf::surfaces {

/// A convex edge where two facets of one body meet at an angle, and the wedge that the body fills there: that of the
/// two triangles which the edge forms with the facets' centres.
struct SharpEdge {
  static constexpr double smooth = 0.8660254037844386;  // cosine of 30 degrees, between the normals of two facets

  std::int32_t node[2] = {}, facet[2] = {};  // both by ascending id
  Vec3 from, along;  // place of the first node, and way to the second [m]
  Vec3 normal[2],
      inward[2];  // unit vectors across the edge: out of each triangle's plane, and in it away from the edge
  double reach = 0.0, deepest = 0.0;  // the lesser of the two facets' [m]

  /// Whether the way across this edge and another leads out of this body: its triangles both go down on either side,
  /// and what is below the edge is in the wedge, or the wedge is at least not far. A triangle at right angles to the
  /// way goes down with either sign of round-off.
  bool leads_out(Vec3 way) const {
    constexpr double grazing = 0.02, steep = 0.5;
    const double down = -max_of(dot(way, inward[0]), dot(way, inward[1]));
    const double steepest = -min_of(dot(way, inward[0]), dot(way, inward[1]));
    const double below = min_of(dot(way, normal[0]), dot(way, normal[1]));
    return down >= -grazing && (below >= -grazing || steepest >= steep);
  }
  /// Whether a point is in the wedge, given the way from it to the edge.
  bool covers(Vec3 way) const { return dot(way, normal[0]) >= 0.0 && dot(way, normal[1]) >= 0.0; }
  Vec3 mean_normal() const {
    const Vec3 sum = normal[0] + normal[1];
    return sum * (1.0 / norm(sum));
  }
};

/// Finds the touches of edges, slave by slave.
class EdgeTouches {
 public:
  /// `opposing` is the cosine between the mean normals below which edges of one part may touch.
  EdgeTouches(const ContactView& view, const FacetSlabs& slabs, double opposing)
      : view_(view), slabs_(slabs), opposing_(opposing) {}

  /// Adds the touches of all slaves of the view.
  void find(ContactTouches& touches) {
    for (int i = 0; i < view_.n_slaves; ++i) find(i, touches);
  }

 private:
  static constexpr double overshoot = 1.0;  // of edges beyond their ends, over the depth, up to which they cross
  static constexpr double least_angle = 0.03;  // square of the sine between edges that cross; others count as parallel

  /// Adds the touches that a slave is to report.
  void find(int i, ContactTouches& touches) {
    const std::span<const std::int32_t> around = view_.around_slave(i);
    if (!may_be_sharp(around)) return;
    slave_ = view_.slave[i];
    list_near(i);
    if (near_.size() < 2) return;
    list_own(around);
    if (own_.empty()) return;
    std::erase_if(near_, [&](const Near& n) { return !is_passed(n); });
    for (std::size_t a = 0; a < near_.size(); ++a)
      for (std::size_t b = a + 1; b < near_.size(); ++b) {
        if (!is_sharp(near_[a].facet, near_[b].facet)) continue;
        SharpEdge other;
        if (!edge_of(near_[a].facet, near_[b].facet, other)) continue;
        for (const SharpEdge& own : own_) touch(own, other, touches);
      }
  }

  /// Closest points of two edges. The first of them has the node with the lowest id.
  struct Crossing {
    double s = 0.0, t = 0.0;  // places on the edges, from 0 to 1
    Vec3 p, q;  // on the first and on the second [m]
    Vec3 out;  // unit vector out of the second body
    double depth = 0.0;  // [m]
  };

  struct Near {
    std::int32_t facet;
    double height, highest;  // of the slave over it, and of what may be taken to be below it [m]
  };

  /// The corners of a facet round the slave that come after and before it.
  struct Neighbours {
    std::int32_t facet, next, previous;
  };

  /// False where all facets round a node face nearly the same way.
  bool may_be_sharp(std::span<const std::int32_t> around) const {
    constexpr double nearly = 0.9659258262890683;  // cosine of 15 degrees, half of those between smooth facets
    if (around.size() < 2) return false;
    const Vec3 first = slabs_.normal(around.front());
    for (const std::int32_t f : around.subspan(1))
      if (dot(first, slabs_.normal(f)) < nearly) return true;
    return false;
  }

  std::int64_t id_of(int node) const { return view_.node_id[node]; }

  bool is_sharp(std::int32_t f, std::int32_t g) const {
    return dot(slabs_.normal(f), slabs_.normal(g)) < SharpEdge::smooth;
  }

  /// Lists the candidates that may be within their reach.
  void list_near(int i) {
    const Vec3 s = view_.x(slave_);
    near_.clear();
    FacetSlabs::until(view_.candidates_of(i), [&](const std::int32_t* some, unsigned in_use) {
      const FacetSlabs::Seen seen(slabs_, some, s);
      unsigned near_by = seen.within_reach(seen.least_square()) & in_use;
      for (; near_by != 0; near_by &= near_by - 1) {
        const int l = std::countr_zero(near_by);
        near_.push_back({some[l], seen.height[l], 3.0 * seen.warp[l] + 0.03 * seen.deepest[l]});
      }
      return false;
    });
  }

  /// Whether a point of one of the slave's edges may be below a facet, as it is in a wedge.
  bool is_passed(const Near& n) const {
    double lowest = n.height;
    for (const SharpEdge& e : own_) {
      const Vec3 end = e.node[0] == slave_ ? e.from + e.along : e.from;
      lowest = min_of(lowest, dot(end - slabs_.centre(n.facet), slabs_.normal(n.facet)));
    }
    return lowest <= n.highest;
  }

  /// Lists the sharp edges that end in the slave.
  void list_own(std::span<const std::int32_t> around) {
    own_.clear();
    ring_.clear();
    for (const std::int32_t f : around) {
      const std::int32_t* n = view_.facet_nodes + 4 * static_cast<std::int64_t>(f);
      int k = 0;
      while (k < 3 && n[k] != slave_) ++k;
      const bool is_repeated = k == 2 && n[3] == n[2];  // the last corner of a triangle
      ring_.push_back({f, n[(k + (is_repeated ? 2 : 1)) % 4], n[(k + 3) % 4]});
    }
    for (const Neighbours& f : ring_) {
      std::int32_t beyond = -1;  // the facet beyond the edge to the next corner
      int n_facets = 0;
      for (const Neighbours& g : ring_) {
        if (g.previous == f.next) beyond = g.facet;
        n_facets += g.previous == f.next || g.next == f.next ? 1 : 0;
      }
      SharpEdge e;
      if (n_facets == 2 && beyond >= 0 && is_sharp(f.facet, beyond) && build(f.facet, beyond, slave_, f.next, e))
        own_.push_back(e);
    }
  }

  bool holds(std::int32_t facet, const SharpEdge& e) const {
    const std::int32_t* n = view_.facet_nodes + 4 * static_cast<std::int64_t>(facet);
    int held = 0;
    for (int k = 0; k < n_corners(n); ++k) held += n[k] == e.node[0] || n[k] == e.node[1] ? 1 : 0;
    return held == 2;
  }

  /// The edge that two facets share, in opposite senses, if it is convex and neither triangle is degenerate.
  bool edge_of(std::int32_t f, std::int32_t g, SharpEdge& e) const {
    const std::int32_t *m = view_.facet_nodes + 4 * static_cast<std::int64_t>(f),
                       *n = view_.facet_nodes + 4 * static_cast<std::int64_t>(g);
    for (int k = 0; k < 4; ++k)
      for (int l = 0; l < 4; ++l)
        if (m[k] == n[(l + 1) % 4] && m[(k + 1) % 4] == n[l] && n[l] != m[k])
          return build(f, g, m[k], m[(k + 1) % 4], e);
    return false;
  }

  /// `f` goes round from node `a` to node `b`, and `g` the other way.
  bool build(std::int32_t f, std::int32_t g, std::int32_t a, std::int32_t b, SharpEdge& e) const {
    double sense = 1.0;
    if (id_of(a) > id_of(b)) {
      std::swap(a, b);
      sense = -sense;
    }
    if (view_.facet_id[f] > view_.facet_id[g]) {
      std::swap(f, g);
      sense = -sense;
    }
    e.node[0] = a;
    e.node[1] = b;
    e.facet[0] = f;
    e.facet[1] = g;
    e.from = view_.x(a);
    e.along = view_.x(b) - e.from;
    const double square = dot(e.along, e.along);
    if (!(square > 0.0)) return false;
    const Vec3 unit = e.along * (1.0 / std::sqrt(square));
    for (int k = 0; k < 2; ++k) {
      const Vec3 way = slabs_.centre(e.facet[k]) - e.from, across = way - unit * dot(way, unit);
      const double length = norm(across);
      if (!(length > 0.0)) return false;
      e.inward[k] = across * (1.0 / length);
      e.normal[k] = cross(unit, e.inward[k]) * (k == 0 ? sense : -sense);
    }
    e.reach = min_of(slabs_.reach(f), slabs_.reach(g));
    e.deepest = min_of(slabs_.deepest(f), slabs_.deepest(g));
    return dot(e.normal[0], e.inward[1]) < 0.0;
  }

  /// Whether two edges cross with a depth. What crosses deeper than a step can lead to is no matter of edges any more.
  static bool cross_inside(const SharpEdge& a, const SharpEdge& b, Crossing& c) {
    const Vec3 between = a.from - b.from;
    const double aa = dot(a.along, a.along), bb = dot(b.along, b.along), ab = dot(a.along, b.along);
    const double fa = dot(a.along, between), fb = dot(b.along, between), det = aa * bb - ab * ab;
    if (!(det > least_angle * aa * bb)) return false;
    c.s = (ab * fb - fa * bb) / det;
    c.t = (aa * fb - ab * fa) / det;
    if (!is_near_edge(c.s) || !is_near_edge(c.t)) return false;
    const double s = c.s, t = c.t;
    c.s = clamp_to(s, 0.0, 1.0);
    c.t = clamp_to(t, 0.0, 1.0);
    c.p = a.from + a.along * c.s;
    c.q = b.from + b.along * c.t;
    const Vec3 across = cross(a.along, b.along), way = c.q - c.p;
    c.out = across * (1.0 / norm(across));
    if (dot(c.out, b.normal[0] + b.normal[1]) < 0.0) c.out = c.out * -1.0;
    c.depth = dot(way, c.out);
    if (!(c.depth > 0.0 && c.depth <= 2.0 * min_of(a.deepest, b.deepest))) return false;
    const Vec3 past = way - c.out * c.depth;
    if (dot(past, past) > overshoot * overshoot * c.depth * c.depth) return false;
    if ((c.s != s && !b.covers(way)) || (c.t != t && !a.covers(way * -1.0))) return false;
    return b.leads_out(c.out) && a.leads_out(c.out * -1.0);
  }
  /// Where a line of edges bends, edges that are below the surface cross beyond the ends of both: as far as the depth
  /// times the tangent of the angle. It is the end that touches then, and it has to be inside.
  static bool is_near_edge(double place) { return place >= -0.5 && place <= 1.5; }

  /// Of the four end nodes that surely have the other edge's facets among their candidates, the one with the lowest id
  /// reports the pair.
  int reporter(const SharpEdge& a, const SharpEdge& b, const Crossing& c) const {
    int found = -1;
    const auto ask = [&](int node, Vec3 point, double reach) {
      const Vec3 d = view_.x(node) - point;
      if (dot(d, d) <= reach * reach && (found < 0 || id_of(node) < id_of(found))) found = node;
    };
    for (int k = 0; k < 2; ++k) {
      ask(a.node[k], c.q, b.reach);
      ask(b.node[k], c.p, a.reach);
    }
    return found;
  }

  /// Whether a third facet, which is surely among the candidates, holds an edge: then it bounds no simple wedge.
  bool is_shared(const SharpEdge& e, Vec3 point) const {
    const Vec3 d = view_.x(slave_) - point;
    for (const auto& [f, height, highest] : near_)
      if (f != e.facet[0] && f != e.facet[1] && holds(f, e) && dot(d, d) <= slabs_.reach(f) * slabs_.reach(f))
        return true;
    return false;
  }

  void touch(const SharpEdge& own, const SharpEdge& other, ContactTouches& touches) const {
    const bool own_first = id_of(own.node[0]) < id_of(other.node[0]);
    const SharpEdge &a = own_first ? own : other, &b = own_first ? other : own;
    Crossing c;
    if (!cross_inside(a, b, c)) return;
    if (view_.facet_body[own.facet[0]] == view_.facet_body[other.facet[0]] &&
        !(dot(own.mean_normal(), other.mean_normal()) < opposing_))
      return;
    if (reporter(a, b, c) != slave_ || is_shared(other, own_first ? c.q : c.p)) return;
    const double at_own = own_first ? c.s : c.t, at_other = own_first ? c.t : c.s;
    ContactTouch t;
    t.node = own.node[0];
    t.second = own.node[1];
    t.second_weight = at_own;
    t.facet = other.facet[0];
    const std::int32_t* n = view_.facet_nodes + 4 * static_cast<std::int64_t>(t.facet);
    for (int k = 0; k < n_corners(n); ++k)
      t.weights[k] = n[k] == other.node[0] ? 1.0 - at_other : n[k] == other.node[1] ? at_other : 0.0;
    t.direction = own_first ? c.out : c.out * -1.0;
    t.depth = c.depth;
    // No depth is taken back. Whether a pair crosses depends on the shape of two wedges, which may come and go: what is
    // pushed out of a depth that was gained meanwhile would get energy that contact has never taken.
    t.stiffness = 0.0;
    add_or_let_go(view_, t, min_of(own.deepest, other.deepest), touches);
  }

  const ContactView& view_;
  const FacetSlabs& slabs_;
  double opposing_;
  std::int32_t slave_ = -1;
  std::vector<SharpEdge> own_;  // that end in the slave
  std::vector<Near> near_;  // facets
  std::vector<Neighbours> ring_;  // round the slave
};

}  // namespace kerf::surfaces
