// Contact of any exterior nodes with any exterior facets of the chosen parts, as elements erode.
//
// Every node is pushed out of each body that it is inside of, to the closest point of that body's surface, if it is no
// deeper than the facet's element is thick. Bodies are asked one by one: that a node is outside of one says nothing
// about another. Nothing is remembered from step to step, so nothing can be lost when facets vanish, appear or move to
// another rank. Facets are taken as four triangles round their centre, which closes the surface without gaps.
#include <kerf/contact_geometry.hpp>

#include <algorithm>
#include <span>

namespace {

using namespace kerf;

// A facet has four triangles: a register of most machines holds one number of each.
typedef double Four __attribute__((vector_size(32)));
typedef std::int64_t FourInt __attribute__((vector_size(32)));

Four root(Four a) { return Four{std::sqrt(a[0]), std::sqrt(a[1]), std::sqrt(a[2]), std::sqrt(a[3])}; }

struct Vectors {
  Four x, y, z;

  static Vectors all(Vec3 v) { return {Four{} + v.x, Four{} + v.y, Four{} + v.z}; }
  /// Each lane takes its successor's vector, the last one the first one's.
  Vectors turned() const {
    const auto turn = [](Four v) { return __builtin_shufflevector(v, v, 1, 2, 3, 0); };
    return {turn(x), turn(y), turn(z)};
  }
  Vec3 at(int lane) const { return {x[lane], y[lane], z[lane]}; }
  friend Vectors operator+(const Vectors& a, const Vectors& b) { return {a.x + b.x, a.y + b.y, a.z + b.z}; }
  friend Vectors operator-(const Vectors& a, const Vectors& b) { return {a.x - b.x, a.y - b.y, a.z - b.z}; }
  friend Vectors operator*(const Vectors& a, const Four& s) { return {a.x * s, a.y * s, a.z * s}; }
  friend Four dot(const Vectors& a, const Vectors& b) { return a.x * b.x + a.y * b.y + a.z * b.z; }
  friend Vectors cross(const Vectors& a, const Vectors& b) {
    return {a.y * b.z - a.z * b.y, a.z * b.x - a.x * b.z, a.x * b.y - a.y * b.x};
  }
};

/// Closest point of a triangle to a point (Ericson, Real-Time Collision Detection, 2005, section 5.1.5).
struct Closest {
  double a = 0.0, b = 0.0, c = 0.0;  // barycentric
  bool inside = false;  // interior to the triangle
};

Closest closest_on_triangle(Vec3 p, Vec3 a, Vec3 b, Vec3 c) {
  const Vec3 ab = b - a, ac = c - a, ap = p - a;
  const double d1 = dot(ab, ap), d2 = dot(ac, ap);
  if (d1 <= 0.0 && d2 <= 0.0) return {1, 0, 0, false};
  const Vec3 bp = p - b;
  const double d3 = dot(ab, bp), d4 = dot(ac, bp);
  if (d3 >= 0.0 && d4 <= d3) return {0, 1, 0, false};
  const double vc = d1 * d4 - d3 * d2;
  if (vc <= 0.0 && d1 >= 0.0 && d3 <= 0.0) {
    const double t = d1 - d3 > 0.0 ? d1 / (d1 - d3) : 0.0;
    return {1 - t, t, 0, false};
  }
  const Vec3 cp = p - c;
  const double d5 = dot(ab, cp), d6 = dot(ac, cp);
  if (d6 >= 0.0 && d5 <= d6) return {0, 0, 1, false};
  const double vb = d5 * d2 - d1 * d6;
  if (vb <= 0.0 && d2 >= 0.0 && d6 <= 0.0) {
    const double t = d2 - d6 > 0.0 ? d2 / (d2 - d6) : 0.0;
    return {1 - t, 0, t, false};
  }
  const double va = d3 * d6 - d5 * d4;
  if (va <= 0.0 && d4 - d3 >= 0.0 && d5 - d6 >= 0.0) {
    const double sum = (d4 - d3) + (d5 - d6);
    const double t = sum > 0.0 ? (d4 - d3) / sum : 0.0;
    return {0, 1 - t, t, false};
  }
  const double denominator = va + vb + vc;
  if (!(denominator > 0.0)) return {1, 0, 0, false};
  const double v = vb / denominator, w = vc / denominator;
  return {1 - v - w, v, w, true};
}

/// The four triangles of a facet side by side: corners x[k], x[k + 1], centre.
struct Triangles {
  Vectors corner;
  Vec3 centre;

  explicit Triangles(const FacetGeometry& g) : centre(g.centre) {
    for (int k = 0; k < 4; ++k) {
      corner.x[k] = g.x[k].x;
      corner.y[k] = g.x[k].y;
      corner.z[k] = g.x[k].z;
    }
  }
};

/// Closest points of four triangles to one point, all at once: the same choices and the same arithmetic, lane by lane,
/// as closest_on_triangle.
struct FourClosest {
  Four a, b, c;  // barycentric
  FourInt inside;  // interior to the triangle
  Vectors way;  // from the closest point to the node
  Four square;  // of its length [m2]

  FourClosest(const Vectors& corner, const Vectors& next, const Vectors& centre, const Vectors& p) {
    const Vectors ab = next - corner, ac = centre - corner, ap = p - corner, bp = p - next, cp = p - centre;
    const Four d1 = dot(ab, ap), d2 = dot(ac, ap), d3 = dot(ab, bp), d4 = dot(ac, bp), d5 = dot(ab, cp),
               d6 = dot(ac, cp);
    const Four vc = d1 * d4 - d3 * d2, vb = d5 * d2 - d1 * d6, va = d3 * d6 - d5 * d4;
    // Whatever comes first wins.
    const FourInt at_a = (d1 <= 0.0) & (d2 <= 0.0);
    FourInt before = at_a;
    const auto first = [&before](FourInt holds) {
      const FourInt is_first = holds & ~before;
      before |= holds;
      return is_first;
    };
    const FourInt at_b = first((d3 >= 0.0) & (d4 <= d3)), on_ab = first((vc <= 0.0) & (d1 >= 0.0) & (d3 <= 0.0));
    const FourInt at_c = first((d6 >= 0.0) & (d5 <= d6)), on_ac = first((vb <= 0.0) & (d2 >= 0.0) & (d6 <= 0.0));
    const FourInt on_bc = first((va <= 0.0) & (d4 - d3 >= 0.0) & (d5 - d6 >= 0.0));
    const Four over = on_ab ? d1 : on_ac ? d2 : on_bc ? d4 - d3 : vb;
    const Four under = on_ab ? d1 - d3 : on_ac ? d2 - d6 : on_bc ? (d4 - d3) + (d5 - d6) : va + vb + vc;
    const FourInt sound = under > 0.0;
    const Four zero{}, one = zero + 1.0;
    const Four t = sound ? over / under : zero, w = vc / under;
    inside = sound & ~before;
    // Without a sound denominator the corner stands for the inside.
    const FourInt corner_a = at_a | ~(before | sound), corner_b = at_b, corner_c = at_c;
    a = corner_a ? one : (corner_b | corner_c | on_bc) ? zero : inside ? one - t - w : one - t;
    b = corner_b ? one : (corner_a | corner_c | on_ac) ? zero : on_bc ? one - t : t;
    c = corner_c ? one : (corner_a | corner_b | on_ab) ? zero : inside ? w : t;
    way = p - (corner * a + next * b + centre * c);
    square = dot(way, way);
  }
};

/// The closest point of a facet, and on which side of it the node lies.
struct Touch {
  double weights[4] = {};
  Vec3 direction;  // outward unit vector from the node to the point if below, from the point if above
  double distance = 1e300;  // [m]
  double side = 0.0;  // cosine between (node - point) and the normal there; negative below
  double lowest = 1.0;  // the least side of all triangles that hold the point
};

Touch touch_facet(const Triangles& facet, double size, Vec3 s) {
  const Vectors next = facet.corner.turned(), centre = Vectors::all(facet.centre);
  const FourClosest closest(facet.corner, next, centre, Vectors::all(s));
  const Vectors twice = cross(next - facet.corner, centre - facet.corner);
  const Four length = root(dot(twice, twice)), zero{};
  const Vectors normal = twice * (1.0 / length);
  const Four distance = root(closest.square);
  const Four side = distance > 0.0 ? dot(closest.way, normal) / distance : zero;
  double least = closest.square[0];
  for (int k = 1; k < 4; ++k) least = min_of(closest.square[k], least);
  // Two triangles share the closest point on an edge: the one that faces the node decides the side.
  const double limit = std::sqrt(least) + 1e-9 * size;
  const FourInt counts = (closest.square <= limit * limit) & (length > 0.0);
  int found = -1;
  double lowest = 1.0;
  for (int k = 0; k < 4; ++k) {
    if (counts[k] == 0) continue;
    lowest = min_of(lowest, side[k]);
    if (found < 0 || std::fabs(side[k]) > std::fabs(side[found])) found = k;
  }
  Touch best;
  if (found < 0) return best;
  const int k = found;
  best.weights[k] = closest.a[k] + 0.25 * closest.c[k];
  best.weights[(k + 1) % 4] = closest.b[k] + 0.25 * closest.c[k];
  best.weights[(k + 2) % 4] = 0.25 * closest.c[k];
  best.weights[(k + 3) % 4] = 0.25 * closest.c[k];
  best.distance = distance[k];
  best.side = side[k];
  best.direction = closest.inside[k] != 0 || !(distance[k] > 0.0)
                       ? normal.at(k)
                       : closest.way.at(k) * ((side[k] < 0.0 ? -1.0 : 1.0) / distance[k]);
  best.lowest = lowest;
  return best;
}

struct ErodingSurface final : Contact {
  std::vector<std::string> parts;
  double penalty = 0.4, damping = 0.2, friction = 0.0, depth = 0.6, stability = 0.4;
  static constexpr double same_way = 0.2;  // cosine between the normals of surfaces that cannot touch
  static constexpr double opposing = -0.2;  // cosine between the normals of surfaces that may touch
  static constexpr double straight_below = -0.95;  // cosine between the way to the closest point and the normal
  static constexpr double flush = 0.05;  // height over a facet's plane, in its longest edge
  static constexpr double straight_angle = 3.14159265358979323846;
  bool self_contact = true;

  static void describe(Schema<ErodingSurface>& s) {
    s.texts(&ErodingSurface::parts, "parts", "parts or sets in contact with one another; all where absent").optional();
    s.boolean(&ErodingSurface::self_contact, "self_contact", "whether a part touches itself").by_default("true");
    s.real(&ErodingSurface::penalty, "penalty", "-", positive, "factor f of the penalty stiffness f K A^2 / V")
        .by_default("0.4");
    s.real(&ErodingSurface::stability, "stability", "-", between(0.0, 1.0),
           "upper bound of the stiffness, in units of effective mass over dt squared")
        .by_default("0.4");
    s.real(&ErodingSurface::damping, "damping", "-", between(0.0, 1.0),
           "damping of the normal motion, as a fraction of critical; takes the energy of nodes that are found deep "
           "inside at "
           "once, when elements round them erode")
        .by_default("0.2");
    s.real(&ErodingSurface::friction, "friction", "-", non_negative, "Coulomb friction coefficient").by_default("0");
    s.real(&ErodingSurface::depth, "depth", "-", between(0.1, 1.0),
           "greatest penetration that is pushed back, over the lesser of the thickness V/A of the facet's element and "
           "the "
           "facet's longest edge")
        .by_default("0.6");
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
  // decides: the reach covers the depth of facets as large as this one.
  double reach(double longest_edge, double /*thickness*/) const override { return depth * longest_edge; }

  void add_forces(const ContactView& view, ContactForces& forces) const override {
    const Measured facets = measure(view);
    Near near;
    for (int i = 0; i < view.n_slaves; ++i) {
      each_touch(view, i, facets, near, [&](int facet, const Touch& t) {
        const int node = view.slave[i];
        const FacetGeometry& g = facets.geometry[facet];
        const std::int32_t* n = view.facet_nodes + 4 * static_cast<std::int64_t>(facet);
        const double mass = effective_mass(view, node, n, t.weights);
        const double stiffness = min_of(penalty * view.facet_bulk_modulus[facet] * g.area / g.thickness,
                                        stability * mass / (view.dt * view.dt));
        const Vec3 v = relative_velocity(view, node, n, t.weights);
        forces.add(node, n, t.weights,
                   penalty_force({stiffness, damping, friction}, t.distance, t.direction, v, mass, view.dt));
      });
    }
  }

  int penetrations(const ContactView& view, std::vector<int>& nodes, std::vector<double>& depths) const override {
    const Measured facets = measure(view);
    Near near;
    for (int i = 0; i < view.n_slaves; ++i) {
      double deepest = 0.0;
      each_touch(view, i, facets, near, [&](int facet, const Touch& t) {
        if (t.distance >= 1e-6 * facets.geometry[facet].size) deepest = max_of(deepest, t.distance);
      });
      if (!(deepest > 0.0)) continue;
      nodes.push_back(view.slave[i]);
      depths.push_back(deepest);
    }
    return static_cast<int>(nodes.size());
  }

 private:
  /// The flat cylinder that holds a facet's four triangles, and what else decides about most nodes, side by side.
  struct Slab {
    Vec3 centre, normal;
    double radius = 0.0, warp = 0.0;  // across the normal and along it [m]
    double size = 0.0, deepest = 0.0;  // longest edge, greatest penetration [m]

    Slab(const FacetGeometry& g, double depth)
        : centre(g.centre), normal(g.normal), size(g.size), deepest(depth * min_of(g.thickness, g.size)) {
      for (int k = 0; k < 4; ++k) {
        const Vec3 d = g.x[k] - g.centre;
        radius = max_of(radius, dot(d, d));
        warp = max_of(warp, std::fabs(dot(d, g.normal)));
      }
      radius = std::sqrt(radius);
    }
    /// Square of a distance that no point of the facet is closer to `s` than [m2].
    double least_square(Vec3 s) const {
      const Vec3 d = s - centre;
      const double height = dot(d, normal), over = max_of(std::fabs(height) - warp, 0.0);
      const double across = dot(d, d) - height * height;
      const double beside = across > radius * radius ? std::sqrt(across) - radius : 0.0;
      return (over * over + beside * beside) * (1.0 - 1e-6);  // far more than round-off
    }
    /// Whether the facet is taken to be able to push a node at `s`. A way to the closest point that is not straight
    /// leads sideways by the depth at most. Below a facet that is folded is below its mean plane, here.
    bool may_push(Vec3 s) const {
      const Vec3 d = s - centre;
      const double height = dot(d, normal), across = radius + deepest;
      return (height <= 1e-6 * size + warp) & (height >= -1.01 * deepest - warp) &
             (dot(d, d) - height * height <= across * across);
    }
  };
  struct Measured {
    std::vector<Slab> slab;
    std::vector<FacetGeometry> geometry;
    std::vector<Triangles> triangles;

    Touch touch(std::int32_t facet, Vec3 s) const { return touch_facet(triangles[facet], geometry[facet].size, s); }
  };

  /// The facets of one body that a node may be within reach of.
  struct Near {
    struct Facet {
      std::int32_t facet;
      double least_square;  // [m2]
    };
    std::vector<Facet> facets;
    int first = -1;  // the facet that is probably closest
    double least_flush = 1e300;  // of those that are left out as flush [m2]
  };

  Measured measure(const ContactView& view) const {
    Measured m;
    m.slab.reserve(static_cast<std::size_t>(view.n_facets));
    m.geometry.reserve(static_cast<std::size_t>(view.n_facets));
    m.triangles.reserve(static_cast<std::size_t>(view.n_facets));
    for (int f = 0; f < view.n_facets; ++f) {
      m.geometry.emplace_back(view, f);
      m.slab.emplace_back(m.geometry.back(), depth);
      m.triangles.emplace_back(m.geometry.back());
    }
    return m;
  }

  /// Calls `push(facet, touch)` for every body that a slave is to be pushed out of. Candidates are sorted by facet id,
  /// hence by part.
  template <class Push>
  void each_touch(const ContactView& view, int i, const Measured& facets, Near& near, const Push& push) const {
    const Vec3 s = view.x(view.slave[i]);
    Vec3 own;
    bool has_own = false;
    const std::span<const std::int32_t> row = view.candidates_of(i);
    const std::int32_t *from = row.data(), *end = from + row.size();
    while (from != end) {
      const std::int32_t* to = from;
      while (to != end && view.facet_part[*to] == view.facet_part[*from]) ++to;
      const bool same_part = view.facet_part[*from] == view.node_part[view.slave[i]];
      // Most slaves are near no facet of a body that could push them, and cost no more than this.
      const bool any = std::any_of(from, to, [&](std::int32_t f) {
        if (!facets.slab[f].may_push(s)) return false;
        const double within = reach(facets.slab[f].size, 0.0);
        if (facets.slab[f].least_square(s) > within * within) return false;
        if (!has_own) own = own_normal(view, i);
        has_own = true;
        return !same_part || faces(own, facets.slab[f].normal);
      });
      Touch t;
      const int facet = any ? locate(view, view.slave[i], own, {from, to}, facets, near, t) : -1;
      if (facet >= 0) push(facet, t);
      from = to;
    }
  }

  /// Whether a surface with one normal may touch one of the same body with another.
  static bool faces(Vec3 own, Vec3 normal) { return dot(own, own) == 0.0 || dot(own, normal) < opposing; }

  /// The facet of one body that the node is to be pushed out of, or -1. The closest facet decides; among facets that
  /// share the closest point, the one that faces the node; ties go to the lower facet id, which comes first.
  int locate(const ContactView& view, int node, Vec3 own, std::span<const std::int32_t> facets,
             const Measured& measured, Near& near, Touch& best) const {
    const Vec3 s = view.x(node);
    const bool same_part = view.facet_part[facets.front()] == view.node_part[node];
    list_near(s, own, same_part, facets, measured, near);
    const int found = closest_of(near, s, measured, best);
    if (found < 0) return -1;
    const FacetGeometry& g = measured.geometry[found];
    if (best.distance > depth * min_of(g.thickness, g.size)) return -1;
    // Within one body the facets around the node are no candidates, so the surface has gaps there: only what is
    // straight below a facet that faces the node is believed to be inside.
    if (same_part) return best.side < straight_below && faces(own, g.normal) ? found : -1;
    if (std::fabs(best.side) > 1.0 - 1e-9) return best.side < 0.0 ? found : -1;
    // Below an edge or a corner the surface as a whole decides; mostly all facets that hold the point agree.
    const double around = best.distance + 1e-6 * g.size;
    if (best.lowest >= 0.0 && near.least_flush > around * around) return -1;
    Vec3 point;
    for (int k = 0; k < 4; ++k) point = point + g.x[k] * best.weights[k];
    const Vec3 away = s - point;
    if (!(dot(away, normal_at(facets, measured, point, best.distance)) < 0.0)) return -1;
    // A node on the edge itself is off it by round-off alone: length and direction must be those of one vector.
    best.distance = norm(away);
    if (!(best.distance > 0.0)) return -1;
    best.direction = away * (-1.0 / best.distance);
    return found;
  }

  /// Lists the facets of one body that the node may be within reach of, and which of them is probably closest.
  void list_near(Vec3 s, Vec3 own, bool same_part, std::span<const std::int32_t> facets, const Measured& measured,
                 Near& near) const {
    near.facets.clear();
    near.first = -1;
    near.least_flush = 1e300;
    double least = 1e300;
    for (const std::int32_t f : facets) {
      const Slab& g = measured.slab[f];
      const double within = reach(g.size, 0.0), square = g.least_square(s);
      if (square > within * within) continue;
      // Where two bodies are flush, the sides of one are as close to the other's rim as its front.
      if (!same_part && dot(own, g.normal) > same_way && std::fabs(dot(s - g.centre, g.normal)) < flush * g.size) {
        near.least_flush = min_of(near.least_flush, square);
        continue;
      }
      near.facets.push_back({f, square});
      if (square < least) near.first = f;
      least = min_of(least, square);
    }
  }

  /// The closest of the near facets within its own reach, or -1. Most need not be looked at after the likely one.
  int closest_of(const Near& near, Vec3 s, const Measured& measured, Touch& best) const {
    if (near.first < 0) return -1;
    const FacetGeometry& likely = measured.geometry[near.first];
    const Touch guess = measured.touch(near.first, s);
    const bool counts = guess.distance <= reach(likely.size, likely.thickness);
    const double enough = counts ? guess.distance + 1e-6 * likely.size : 1e150;
    int found = -1;
    double found_size = 0.0;
    for (const auto& [f, least_square] : near.facets) {
      if (least_square > enough * enough) continue;
      const FacetGeometry& g = measured.geometry[f];
      const Touch t = f == near.first ? guess : measured.touch(f, s);
      if (!(t.distance <= reach(g.size, g.thickness))) continue;
      const double tolerance = 1e-9 * max_of(g.size, found_size);
      const bool nearer = found < 0 || t.distance < best.distance - tolerance;
      const bool same = !nearer && t.distance <= best.distance + tolerance;
      if (!nearer && !same) continue;
      const double lowest = same ? min_of(best.lowest, t.lowest) : t.lowest;
      if (nearer || std::fabs(t.side) > std::fabs(best.side)) {
        best = t;
        found = f;
        found_size = g.size;
      }
      best.lowest = lowest;
    }
    return found;
  }

  /// Sum of the normals of all triangles that hold a point of a body's surface, each weighted by the angle that it
  /// takes up there: a point near an edge or a corner is inside just where it lies below this normal (Baerentzen &
  /// Aanaes, "Signed distance computation using the angle weighted pseudonormal", IEEE TVCG 11 (2005) 243-253).
  Vec3 normal_at(std::span<const std::int32_t> facets, const Measured& measured, Vec3 point, double distance) const {
    Vec3 sum;
    for (const std::int32_t f : facets) {
      const FacetGeometry& g = measured.geometry[f];
      // Whether a facet that is out of its own reach is listed is a matter of chance.
      if (distance > reach(g.size, g.thickness)) continue;
      const double tolerance = 1e-7 * g.size;
      const Vec3 d = point - g.centre;
      if (!(dot(d, d) < 2.0 * g.size * g.size)) continue;
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
    return std::acos(clamp_to(dot(u, v) / (norm(u) * norm(v)), -1.0, 1.0));
  }

  /// Unit normal of the surface around a slave, zero for a free node, which has no surface.
  Vec3 own_normal(const ContactView& view, int i) const {
    Vec3 own;
    for (const std::int32_t facet : view.around_slave(i)) {
      const std::int32_t* n = view.facet_nodes + 4 * static_cast<std::int64_t>(facet);
      own = own + cross(view.x(n[2]) - view.x(n[0]), view.x(n[3]) - view.x(n[1]));
    }
    const double length = norm(own);
    return length > 0.0 ? own * (1.0 / length) : Vec3{};
  }
};

}  // namespace

KERF_CONTACT(ErodingSurface, "eroding_surface",
             "any exterior facets against any exterior nodes, with facets opened by erosion and free nodes")
