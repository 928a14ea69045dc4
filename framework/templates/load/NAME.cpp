// The pressure pulse of a distant explosion on facets: a jump, then exponential decay.
//
// Source: R.H. Cole, Underwater Explosions, Princeton University Press (1948), eq. 7.1: p(t) = p0 exp(-t / tau).
#include <kerf/load.hpp>

namespace {

using namespace kerf;

/// p(t) = p0 exp(-(t - t0) / tau) from the arrival t0 on, against the outward normal of facets where they are now.
struct @TYPE@ final : FacetLoad {
  std::vector<std::string> names;
  double peak = 0.0, decay_time = 0.0, arrival = 0.0;  // [Pa], [s], [s]

  static void describe(Schema<@TYPE@>& s) {
    s.texts(&@TYPE@::names, "facets",
            "parts or sets whose exterior facets are pressed; a set has those with all corners in it");
    s.real(&@TYPE@::peak, "peak", "Pa", positive, "pressure at the arrival of the pulse");
    s.real(&@TYPE@::decay_time, "decay_time", "s", positive, "time in which the pressure falls to 1/e");
    s.real(&@TYPE@::arrival, "arrival", "s", non_negative, "time at which the pulse arrives").by_default("0 s");
    s.rule("facets", "name at least one part or set", [](const @TYPE@& load) { return !load.names.empty(); });
  }

  std::vector<std::string> targets() const override { return names; }
  // The engine chooses the resolution of forces by it.
  std::optional<double> greatest() const override { return peak; }
  bool can_reach(const LoadedFacet&, double end) const override { return arrival < end; }
  FacetForce force(const LoadedFacet&, double time) const override {
    if (time < arrival) return {};
    return {peak * kerf::exp(-(time - arrival) / decay_time), Vec3{}};
  }
};

}  // namespace

KERF_LOAD(@TYPE@, "@NAME@", "pressure pulse on facets that jumps up and decays exponentially")
