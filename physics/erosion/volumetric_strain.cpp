// Erosion at limits of the volumetric strain.
#include <kerf/erosion.hpp>

namespace {

using namespace kerf;

/// Fails a point where ln V/V0 reaches the limit in tension, or -ln V/V0 that in compression.
struct VolumetricStrain final : PointwiseErosion<VolumetricStrain> {
  double tension_limit = 0.0, compression_limit = 0.0;  // [-]; zero where there is none
  using State = NoVariables;
  using Reads = NoVariables;

  static void describe(Schema<VolumetricStrain>& s) {
    s.real(&VolumetricStrain::tension_limit, "tension_limit", "-", positive,
           "ln V/V0 at failure by expansion, a positive number")
        .optional();
    s.real(&VolumetricStrain::compression_limit, "compression_limit", "-", positive,
           "-ln V/V0 at failure by compression, a positive number")
        .optional();
    describe_interval(s);
    s.rule("tension_limit", "expected a tension_limit, a compression_limit, or both",
           [](const VolumetricStrain& v) { return v.tension_limit > 0.0 || v.compression_limit > 0.0; });
  }
  Verdict judge_point(const ErosionInputPoint& in, const Reads&, State&) const {
    // An element without volume has been compressed beyond any limit.
    const double strain = positive_log(max_of(in.volume_ratio, least_ratio));
    const bool tension = (tension_limit > 0.0) & (strain >= tension_limit);
    const bool compression = (compression_limit > 0.0) & (-strain >= compression_limit);
    return {strain, select(tension | compression, 1.0, 0.0)};
  }

 private:
  static constexpr double least_ratio = 1e-300;
};

}  // namespace

KERF_EROSION(VolumetricStrain, "volumetric_strain", "logarithm of the volume ratio reaches a limit")
