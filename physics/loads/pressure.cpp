// Pressure on exterior facets.
#include <kerf/load.hpp>

#include <cmath>

namespace {

using namespace kerf;

/// p(t) = p0 f(t), against the outward normal of the facets in their present place.
struct Pressure final : FacetLoad {
  std::vector<std::string> names;
  double pressure = 0.0;  // [Pa]
  const Curve* curve = nullptr;
  bool follows = false;

  static void describe(Schema<Pressure>& s) {
    s.texts(&Pressure::names, "facets",
            "parts or sets whose exterior facets are pressed; a set has those with all corners in it");
    s.real(&Pressure::pressure, "pressure", "Pa", any_value, "pressure where the curve is 1; negative for suction");
    s.curve(&Pressure::curve, "curve", "factor of the pressure by time; 1 where absent").optional();
    s.boolean(&Pressure::follows, "follow_erosion",
              "whether the pressure also acts on what the erosion of pressed elements uncovers")
        .by_default("false");
    s.rule("facets", "name at least one part or set", [](const Pressure& p) { return !p.names.empty(); });
  }
  std::vector<std::string> targets() const override { return names; }
  std::optional<double> greatest() const override { return std::fabs(pressure) * greatest_of(curve); }
  bool follows_erosion() const override { return follows; }
  FacetForce force(const LoadedFacet&, double time) const override {
    return {pressure * value_of(curve, time), Vec3{}};
  }
};

}  // namespace

KERF_LOAD(Pressure, "pressure", "presses on exterior facets, a constant times a curve of time")
