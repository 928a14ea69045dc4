// Erosion of what has molten.
#include <kerf/erosion.hpp>

namespace {

using namespace kerf;

/// Fails a point whose temperature is at or above its melting temperature: the user's, or what a law of the material
/// finds for the density of the point.
struct Melt final : PointwiseErosion<Melt> {
  double melting_temperature = 0.0;  // [K]; zero: what a law says
  using State = NoVariables;
  struct Reads {
    double temperature, melting_temperature;
  };

  static void describe(Schema<Melt>& s) {
    s.real(&Melt::melting_temperature, "melting_temperature", "K", positive,
           "melting temperature; where absent, the state variable melting_temperature of a law of the material")
        .optional();
    describe_interval(s);
    s.reads(&Reads::temperature, "temperature", "temperature of the material");
    s.reads(&Reads::melting_temperature, "melting_temperature", "melting temperature of the material");
  }
  /// What the user gives need not be read.
  std::vector<ReadVariable> reads() const override {
    std::vector<ReadVariable> all = PointwiseErosion::reads();
    if (melting_temperature > 0.0) {
      all.pop_back();
      all.push_back(all.back());
    }
    return all;
  }
  Verdict judge_point(const ErosionInputPoint&, const Reads& reads, State&) const {
    const double melting = melting_temperature > 0.0 ? melting_temperature : reads.melting_temperature;
    return {reads.temperature, select(reads.temperature >= melting, 1.0, 0.0)};
  }
};

}  // namespace

KERF_EROSION(Melt, "melt", "the temperature reaches the melting temperature")
