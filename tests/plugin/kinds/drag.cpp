// A load outside of Kerf's tree: the drag of a thin gas on a fast body.
//
// Source: I. Newton's sine-square law; J.D. Anderson, "Hypersonic and High-Temperature Gas Dynamics", AIAA 2006, ch. 3.
#include <kerf/load.hpp>

/// p = C/2 rho (v.n)^2 on facets that move into the gas; those in the shadow carry nothing.
struct Drag final : kerf::FacetLoad {
  std::vector<std::string> facets;
  double density = 0.0, coefficient = 0.0;  // [kg/m3], [-]
  kerf::Vec3 wind;  // [m/s]

  static void describe(kerf::Schema<Drag>& s) {
    s.texts(&Drag::facets, "facets", "parts or sets whose exterior facets meet the gas");
    s.real(&Drag::density, "density", "kg/m3", kerf::positive, "density of the gas");
    s.real(&Drag::coefficient, "coefficient", "-", kerf::positive, "pressure over half of rho (v.n)^2").by_default("2");
    s.vector(&Drag::wind, "wind", "m/s", kerf::any_value, "velocity of the gas").by_default("[0, 0, 0]");
  }
  std::vector<std::string> targets() const override { return facets; }
  bool follows_erosion() const override { return true; }
  kerf::FacetForce force(const kerf::LoadedFacet& facet, double) const override {
    const double into = kerf::max_of(dot(facet.velocity - wind, facet.normal), 0.0);
    return {.pressure = 0.5 * coefficient * density * into * into, .traction = {}};
  }
};

KERF_LOAD(Drag, "drag", "pressure of a thin gas on facets that move into it")
