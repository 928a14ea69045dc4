// The classical master/slave slide surface: nearest master node, segments round it, projection, touch.
//
// Sources: J.O. Hallquist, G.L. Goudreau & D.J. Benson, "Sliding interfaces with contact-impact in large-scale
// Lagrangian computations", CMAME 51 (1985) 107-137; penalty f K A^2 / V as used by Ren & Wang, Explosion and
// Shock Waves 25 (2005) 260-264.
#include <kerf/contact_geometry.hpp>

namespace {

using namespace kerf;

/// Where a node projects on a bilinear segment.
struct Projection {
  double weights[4] = {};
  Vec3 point, normal;
  double xi = 0.0, eta = 0.0, gap = 0.0;  // gap: distance along the normal, negative below the surface [m]
  bool converged = false;
};

/// Newton iteration for the point where the segment's normal passes through the node (Hallquist et al. 1985,
/// eqs. 5-8); the fixed number of steps keeps the result independent of round-off in a stopping test.
Projection project(const Vec3 (&x)[4], Vec3 s) {
  Projection p;
  for (int step = 0; step < 8; ++step) {
    const double a = p.xi, b = p.eta;
    const Vec3 r = (x[0] * ((1 - a) * (1 - b)) + x[1] * ((1 + a) * (1 - b)) + x[2] * ((1 + a) * (1 + b)) +
                    x[3] * ((1 - a) * (1 + b))) *
                   0.25;
    const Vec3 ra = ((x[1] - x[0]) * (1 - b) + (x[2] - x[3]) * (1 + b)) * 0.25;
    const Vec3 rb = ((x[3] - x[0]) * (1 - a) + (x[2] - x[1]) * (1 + a)) * 0.25;
    const Vec3 rab = (x[0] - x[1] + x[2] - x[3]) * 0.25;
    const Vec3 d = r - s;
    const double f1 = dot(ra, d), f2 = dot(rb, d);
    const double h11 = dot(ra, ra), h22 = dot(rb, rb), h12 = dot(ra, rb) + dot(rab, d);
    const double det = h11 * h22 - h12 * h12;
    if (!(det > 0.0)) return p;
    p.xi = clamp_to(p.xi - (h22 * f1 - h12 * f2) / det, -2.0, 2.0);
    p.eta = clamp_to(p.eta - (h11 * f2 - h12 * f1) / det, -2.0, 2.0);
  }
  const double a = p.xi, b = p.eta;
  p.weights[0] = 0.25 * (1 - a) * (1 - b);
  p.weights[1] = 0.25 * (1 + a) * (1 - b);
  p.weights[2] = 0.25 * (1 + a) * (1 + b);
  p.weights[3] = 0.25 * (1 - a) * (1 + b);
  p.point = x[0] * p.weights[0] + x[1] * p.weights[1] + x[2] * p.weights[2] + x[3] * p.weights[3];
  const Vec3 ra = (x[1] - x[0]) * (1 - b) + (x[2] - x[3]) * (1 + b);
  const Vec3 rb = (x[3] - x[0]) * (1 - a) + (x[2] - x[1]) * (1 + a);
  const Vec3 n = cross(ra, rb);
  const double length = norm(n);
  if (!(length > 0.0)) return p;
  p.normal = n * (1.0 / length);
  p.gap = dot(s - p.point, p.normal);
  p.converged = true;
  return p;
}

struct SlideSurface final : Contact {
  std::vector<std::string> slave, master;
  static constexpr double stability = 0.4;  // of effective mass over dt squared
  double penalty = 0.1, damping = 0.0, friction = 0.0, overlap = 0.02, depth = 1.0;
  bool symmetric = false;

  static void describe(Schema<SlideSurface>& s) {
    s.texts(&SlideSurface::slave, "slave", "parts or sets whose exterior nodes are slaves");
    s.texts(&SlideSurface::master, "master", "parts or sets whose exterior facets are masters");
    s.real(&SlideSurface::penalty, "penalty", "-", positive, "factor f of the stiffness f K A^2 / V with which a depth is taken back")
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
         &SlideSurface::depth, "depth", "-", positive,
         "greatest penetration that is held, over the lesser of the thickness V/A of the master element and the "
         "segment's longest edge")
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

  // The nearest master node of a node below a segment is at most the segment's diagonal and the depth away.
  double reach(const FacetBounds& facet) const override {
    return 1.5 * facet.longest_edge + depth * min_of(facet.thickness, facet.longest_edge);
  }

  void find_touches(const ContactView& view, ContactTouches& touches) const override {
    for (int i = 0; i < view.n_slaves; ++i) {
      Projection p;
      const int facet = locate(view, i, p);
      if (facet < 0 || p.gap >= 0.0) continue;
      const FacetGeometry g(view, facet);
      ContactTouch touch;
      touch.node = view.slave[i];
      touch.facet = facet;
      for (int k = 0; k < 4; ++k) touch.weights[k] = p.weights[k];
      touch.direction = p.normal;
      touch.depth = -p.gap;
      touch.stiffness = penalty * view.facet_bulk_modulus[facet] * g.area / g.thickness;  // f K A^2 / V
      touches.add(touch);
    }
  }

  ContactResponse response() const override {
    return {.restitution = 1.0 - damping, .stability = stability, .friction = friction};
  }

  int penetrations(const ContactView& view, std::vector<int>& nodes, std::vector<double>& depths) const override {
    for (int i = 0; i < view.n_slaves; ++i) {
      Projection p;
      const int facet = locate(view, i, p);
      if (facet < 0 || p.gap > -1e-6 * FacetGeometry(view, facet).size) continue;
      nodes.push_back(view.slave[i]);
      depths.push_back(-p.gap);
    }
    return static_cast<int>(nodes.size());
  }

 private:
  /// Steps 1 to 3: the nearest master node, the segments round it, the projection. Returns the facet, or -1.
  int locate(const ContactView& view, int i, Projection& best) const {
    const int node = view.slave[i];
    const Vec3 s = view.x(node);
    const std::span<const std::int32_t> facets = view.candidates_of(i);
    // 1. Global search: the nearest master node; ties go to the lower id.
    double nearest = 1e300;
    std::int64_t nearest_id = -1;
    for (const std::int32_t f : facets)
      for (int k = 0; k < 4; ++k) {
        const std::int32_t n = view.facet_nodes[4 * f + k];
        const Vec3 d = view.x(n) - s;
        const double distance = dot(d, d);
        if (distance < nearest || (distance == nearest && view.node_id[n] < nearest_id)) {
          nearest = distance;
          nearest_id = view.node_id[n];
        }
      }
    // 2. Local search: the master segments round that node; 3. projection: the one that holds the node deepest
    // within its edges, then nearest to its surface; ties go to the lower id, which comes first.
    int found = -1;
    double best_outside = 1e300;
    for (const std::int32_t f : facets) {
      const std::int32_t* n = view.facet_nodes + 4 * f;
      bool round = false;
      for (int k = 0; k < 4; ++k) round = round || view.node_id[n[k]] == nearest_id;
      if (!round) continue;
      const FacetGeometry g(view, f);
      const Projection p = project(g.x, s);
      const double outside = max_of(max_of(std::fabs(p.xi), std::fabs(p.eta)) - 1.0, 0.0);
      if (!p.converged || outside > overlap || -p.gap > depth * min_of(g.thickness, g.size)) continue;
      if (outside < best_outside || (outside == best_outside && std::fabs(p.gap) < std::fabs(best.gap))) {
        best_outside = outside;
        best = p;
        found = f;
      }
    }
    return found;
  }
};

}  // namespace

KERF_CONTACT(SlideSurface, "slide_surface", "classical master/slave slide surface; depths are taken back with stiffness f K A^2 / V")
