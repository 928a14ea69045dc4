// A contact law outside of Kerf's tree: nodes meet the closest point of the closest facet, with friction. Simpler than
// Kerf's own laws: no edges, and normals that jump from one facet to the next.
#include <kerf/surfaces/closing_pairs.hpp>
#include <kerf/surfaces/own_surface.hpp>

using kerf::surfaces::ClosingPairs;
using kerf::surfaces::FacetSlabs;
using kerf::surfaces::Touch;

struct ClosestPoint final : kerf::Contact {
  std::vector<std::string> slave, master;
  double penalty = 0.1, friction = 0.0;
  static constexpr double deepest = 0.5;  // that is held, over the least of thickness and edge of a facet

  static void describe(kerf::Schema<ClosestPoint>& s) {
    s.texts(&ClosestPoint::slave, "slave", "parts or sets whose exterior nodes are slaves");
    s.texts(&ClosestPoint::master, "master", "parts or sets whose exterior facets are masters");
    s.real(&ClosestPoint::penalty, "penalty", "-", kerf::positive, "factor f of the stiffness f K A^2 / V")
        .by_default("0.1");
    s.real(&ClosestPoint::friction, "friction", "-", kerf::non_negative, "Coulomb coefficient").by_default("0");
    s.integer(&Contact::search_interval, "search_interval", kerf::positive,
              "cycles that candidates are looked for ahead")
        .by_default("10");
  }

  kerf::ContactRequest request() const override {
    kerf::ContactRequest r;
    r.slaves = slave;
    r.masters = master;
    return r;
  }
  double reach(const kerf::FacetBounds& facet) const override { return FacetSlabs::reach_of(deepest, facet.edge); }
  kerf::ContactResponse response() const override {
    return {.restitution = 0.8, .stability = 0.4, .friction = friction};
  }

  void find_touches(const kerf::ContactView& view, kerf::ContactTouches& touches) const override {
    const FacetSlabs slabs(view, deepest);
    const ClosingPairs pairs(view, slabs);
    for (int i = 0; i < view.n_slaves; ++i) {
      pairs.limit_step(i, touches);
      Touch found;
      if (const int facet = closest(view, i, slabs, found); facet >= 0)
        hold_or_let_go(view, i, slabs, penalty, touch_of(view.slave[i], facet, found), touches);
    }
  }

  int penetrations(const kerf::ContactView& view, std::vector<int>& nodes, std::vector<double>& depths) const override {
    const FacetSlabs slabs(view, deepest);
    for (int i = 0; i < view.n_slaves; ++i) {
      Touch found;
      const int facet = closest(view, i, slabs, found);
      if (facet < 0 || found.distance < 1e-6 * slabs.size(facet)) continue;
      nodes.push_back(view.slave[i]);
      depths.push_back(found.distance);
    }
    return static_cast<int>(nodes.size());
  }

 private:
  /// The facet whose closest point is nearest, if the node is below it; -1 where there is none. Facets are sorted by
  /// id, so that of equally near ones the lowest wins on any number of ranks.
  static int closest(const kerf::ContactView& view, int i, const FacetSlabs& slabs, Touch& best) {
    const kerf::Vec3 s = view.x(view.slave[i]), own = kerf::surfaces::own_normal(view, i);
    int found = -1;
    for (const std::int32_t facet : view.candidates_of(i)) {
      if (kerf::surfaces::is_beside(slabs, facet, own, s)) continue;
      const Touch touch = touch_facet(kerf::surfaces::Triangles(view, facet), slabs.size(facet), s);
      if (touch.distance > slabs.reach(facet) || !(touch.distance < best.distance)) continue;
      best = touch;
      found = facet;
    }
    return found >= 0 && best.side < 0.0 ? found : -1;
  }
  static kerf::ContactTouch touch_of(int node, int facet, const Touch& found) {
    kerf::ContactTouch touch;
    touch.node = node;
    touch.facet = facet;
    for (int k = 0; k < 4; ++k) touch.weights[k] = found.weights[k];
    touch.direction = found.direction;
    touch.depth = found.distance;
    return touch;
  }
};

KERF_CONTACT(ClosestPoint, "closest_point", "nodes meet the closest point of the closest facet")
