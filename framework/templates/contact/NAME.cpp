// Contact that takes every facet as a plane parallelogram. Simple and fast, for smooth surfaces.
//
// The law finds out which nodes touch which facets; the engine answers all touches alike, by impulses.
#include <kerf/contact_geometry.hpp>

namespace {

using namespace kerf;

/// A node below a facet, not deeper than `depth` times its cell, touches it along its normal.
struct @TYPE@ final : Contact {
  std::vector<std::string> slave, master;
  double depth = 0.5, friction = 0.0;  // [-]
  static constexpr double sight = 1.25;  // over the greatest depth that is held, so that what is let go is seen

  static void describe(Schema<@TYPE@>& s) {
    s.texts(&@TYPE@::slave, "slave", "parts or sets whose exterior nodes are slaves");
    s.texts(&@TYPE@::master, "master", "parts or sets whose exterior facets are masters");
    s.real(&@TYPE@::depth, "depth", "-", positive,
           "greatest depth that is held, over the lesser of V/A and the longest edge of the facet")
        .by_default("0.5");
    s.real(&@TYPE@::friction, "friction", "-", non_negative, "coefficient of Coulomb friction").by_default("0");
    s.integer(&Contact::search_interval, "search_interval", positive, "cycles that candidates are looked for ahead")
        .by_default("10");
  }

  ContactRequest request() const override {
    ContactRequest r;
    r.slaves = slave;
    r.masters = master;
    return r;
  }
  double reach(const FacetBounds& facet) const override { return sight * depth * facet.thickness; }

  void find_touches(const ContactView& view, ContactTouches& touches) const override {
    for (int i = 0; i < view.n_slaves; ++i) {
      Foot foot;
      const int facet = locate(view, i, foot);
      if (facet < 0) continue;
      const FacetGeometry g(view, facet);
      ContactTouch touch;
      touch.node = view.slave[i];
      touch.facet = facet;
      for (int k = 0; k < 4; ++k) touch.weights[k] = foot.weights[k];
      touch.direction = g.normal;
      touch.depth = foot.depth;
      const double closing = closing_speed(view, touch);
      if (foot.depth <= deepest(g)) {
        touches.add(touch);
        touches.limit_step(0.5 * deepest(g), closing);
      } else if (foot.depth - closing * view.dt <= deepest(g)) {  // it was less deep at the start of the step
        touches.let_go(touch.node, foot.depth);
      }
    }
  }
  ContactResponse response() const override {
    // No rebound: nodes fall from one plane to the next, so that a depth is partly one of the description. To take it
    // back would bring energy into the model, where an impact without rebound cannot.
    return {.restitution = 0.0, .friction = friction};
  }

  int penetrations(const ContactView& view, std::vector<int>& nodes, std::vector<double>& depths) const override {
    for (int i = 0; i < view.n_slaves; ++i) {
      Foot foot;
      const int facet = locate(view, i, foot);
      if (facet < 0 || foot.depth < 1e-6 * FacetGeometry(view, facet).size) continue;
      nodes.push_back(view.slave[i]);
      depths.push_back(foot.depth);
    }
    return static_cast<int>(nodes.size());
  }

 private:
  /// Where a node stands below a facet.
  struct Foot {
    double weights[4] = {}, depth = 0.0;  // [-], [m]
  };

  double deepest(const FacetGeometry& g) const { return depth * min_of(g.thickness, g.size); }

  /// The facet that the node is least deep below, or -1; ties go to the lower facet id, which comes first.
  int locate(const ContactView& view, int i, Foot& best) const {
    int found = -1;
    for (const std::int32_t facet : view.candidates_of(i)) {
      Foot foot;
      if (!below(FacetGeometry(view, facet), view.x(view.slave[i]), foot)) continue;
      if (found >= 0 && !(foot.depth < best.depth)) continue;
      found = facet;
      best = foot;
    }
    return found;
  }

  /// Natural coordinates a, b in the parallelogram of the mean edges, by least squares; bilinear weights from them.
  bool below(const FacetGeometry& g, Vec3 x, Foot& foot) const {
    const Vec3 ea = (g.x[1] - g.x[0] + g.x[2] - g.x[3]) * 0.25, eb = (g.x[3] - g.x[0] + g.x[2] - g.x[1]) * 0.25;
    const Vec3 d = x - g.centre;
    foot.depth = -dot(d, g.normal);
    if (!(foot.depth > 0.0 && foot.depth <= sight * deepest(g))) return false;
    const double aa = dot(ea, ea), bb = dot(eb, eb), ab = dot(ea, eb), da = dot(d, ea), db = dot(d, eb);
    const double determinant = aa * bb - ab * ab;
    if (!(determinant > 0.0)) return false;
    const double a = (bb * da - ab * db) / determinant, b = (aa * db - ab * da) / determinant;
    if (!(std::fabs(a) <= 1.0 && std::fabs(b) <= 1.0)) return false;
    foot.weights[0] = 0.25 * (1 - a) * (1 - b);
    foot.weights[1] = 0.25 * (1 + a) * (1 - b);
    foot.weights[2] = 0.25 * (1 + a) * (1 + b);
    foot.weights[3] = 0.25 * (1 - a) * (1 + b);
    Vec3 point;  // of the facet itself, which may be warped
    for (int k = 0; k < 4; ++k) point = point + foot.weights[k] * g.x[k];
    foot.depth = dot(point - x, g.normal);
    return foot.depth > 0.0;
  }
};

}  // namespace

KERF_CONTACT(@TYPE@, "@NAME@", "nodes against facets, taken as plane parallelograms, with friction")
