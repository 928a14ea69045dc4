// What keeps nodes from passing through facets within one step, and what becomes of touches that are too deep: the same
// for all laws.
#pragma once

#include <kerf/contact_geometry.hpp>

#include <bit>
#include <cstdint>

#include <kerf/surfaces/closest_points.hpp>
#include <kerf/surfaces/facet_slabs.hpp>

namespace kerf::surfaces {

/// Pairs of nodes and facets that may close so fast that the next step must be bounded.
class ClosingPairs {
 public:
  /// Both must outlive this.
  ClosingPairs(const ContactView& view, const FacetSlabs& slabs)
      : view_(view), slabs_(slabs), fast_(fastest_pair(view) * view.dt > slow * slabs.least_deepest()) {
    if (fast_) drifts_.measure(view, slabs);
  }

  /// Keeps a slave from going far into a facet, or out of its sight, in the step after the coming one. Only facets
  /// within their reach count, since others are listed or not by chance.
  void limit_step(int i, ContactTouches& touches) const {
    if (!fast_) return;
    const int node = view_.slave[i];
    const Vec3 s = view_.x(node), v = view_.v(node);
    FacetSlabs::until(view_.candidates_of(i), [&](const std::int32_t* some, unsigned in_use) {
      const Lanes closing = drifts_.closing(some, v);
      if ((mask_of(closing > Lanes{}) & in_use) == 0) return false;
      const FacetSlabs::Seen seen(slabs_, some, s);
      const Lanes sight = FacetSlabs::sight * seen.deepest, height = seen.height;
      const Lanes way =
          min_of(first_depth * seen.deepest + max_of(height, Lanes{}), max_of(sight + height, 0.1 * seen.deepest));
      // A pair that would not shorten the step needs no closest point. What is nearly equal is left to limit_step,
      // whose minimum does not depend on the order of slaves.
      unsigned close = mask_of((closing * view_.dt > slow * seen.deepest) & (height >= -sight) &
                               (way * (1.0 - 1e-12) < touches.longest_step() * closing));
      close &= seen.within_reach(seen.least_square()) & in_use;
      for (; close != 0; close &= close - 1) {
        const int l = std::countr_zero(close);
        if (touch_facet(Triangles(view_, some[l]), slabs_.size(some[l]), s).distance <= slabs_.reach(some[l]))
          touches.limit_step(way[l], closing[l]);
      }
      return false;
    });
  }

 private:
  static constexpr double first_depth = 0.5;  // that a step may lead to below the surface, over the deepest
  static constexpr double slow = 0.2;  // way in a step, over the deepest, that is no danger

  /// Bound of the speed of any node relative to any facet [m/s].
  static double fastest_pair(const ContactView& view) {
    double low[4] = {1e300, 1e300, 1e300, 1e300}, high[4] = {-1e300, -1e300, -1e300, -1e300};
    for (int n = 0; n < view.n_nodes; ++n)
      for (int d = 0; d < 4; ++d) {
        const double v = view.velocity[4 * static_cast<std::int64_t>(n) + d];
        low[d] = min_of(low[d], v);
        high[d] = max_of(high[d], v);
      }
    return view.n_nodes > 0 ? norm(Vec3{high[0] - low[0], high[1] - low[1], high[2] - low[2]}) : 0.0;
  }

  const ContactView& view_;
  const FacetSlabs& slabs_;
  FacetDrifts drifts_;
  bool fast_;
};

/// Whether the mesh of slave i is finer than that of a facet of the given area, by the mean area of the facets round
/// it; among nearly equal ones, the part with the lower number counts as finer. A free node has no mesh, and counts as
/// finer.
inline bool is_finer(const ContactView& view, int i, int facet, double facet_area) {
  constexpr double nearly_equal = 1.3;  // ratio of areas
  double area = 0.0;
  for (const std::int32_t f : view.around_slave(i)) area += FacetGeometry(view, f).area;
  const double other = facet_area * static_cast<double>(view.around_slave(i).size());
  if (area * nearly_equal < other) return true;
  if (area > other * nearly_equal) return false;
  return view.around_slave(i).empty() || view.node_body[view.slave[i]] < view.facet_body[facet];
}

/// Adds a touch. Where what touches comes to lie deeper than is held, lets it go in place of that.
inline void add_or_let_go(const ContactView& view, const ContactTouch& touch, double deepest, ContactTouches& touches) {
  if (touch.depth <= deepest)
    touches.add(touch);
  else if (touch.depth - closing_speed(view, touch) * view.dt <= deepest)
    touches.let_go(touch.node, touch.depth);
}

/// The same of a slave, with the stiffness f K A^2 / V of a penalty f.
inline void hold_or_let_go(const ContactView& view, int i, const FacetSlabs& slabs, double penalty, ContactTouch touch,
                           ContactTouches& touches) {
  const FacetGeometry g(view, touch.facet);
  touch.stiffness = penalty * view.facet_bulk_modulus[touch.facet] * g.area / g.thickness;
  touch.carried = is_finer(view, i, touch.facet, g.area);
  add_or_let_go(view, touch, slabs.deepest(touch.facet), touches);
}

}  // namespace kerf::surfaces
