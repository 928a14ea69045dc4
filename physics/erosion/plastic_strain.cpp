// Erosion at a limit of the equivalent plastic strain.
#include <kerf/erosion.hpp>

namespace {

using namespace kerf;

/// Fails a point whose effective_plastic_strain, kept by its material, reaches the limit.
struct PlasticStrain final : PointwiseErosion<PlasticStrain> {
  double limit = 0.0;  // [-]
  using State = NoVariables;
  struct Reads {
    double effective_plastic_strain;
  };

  static void describe(Schema<PlasticStrain>& s) {
    s.real(&PlasticStrain::limit, "limit", "-", positive, "equivalent plastic strain at failure");
    describe_interval(s);
    s.reads(&Reads::effective_plastic_strain, "effective_plastic_strain", "equivalent plastic strain of the material");
  }
  Verdict judge_point(const ErosionInputPoint&, const Reads& reads, State&) const {
    const double strain = reads.effective_plastic_strain;
    return {strain, select(strain >= limit, 1.0, 0.0)};
  }
};

}  // namespace

KERF_EROSION(PlasticStrain, "plastic_strain", "equivalent plastic strain reaches a limit")
