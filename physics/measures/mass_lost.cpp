// Mass that a part has lost to erosion.
#include "kerf/bodies/measured_bodies.hpp"
#include "kerf/plugin.hpp"

namespace kerf {
namespace {

using namespace bodies;

class MassLost final : public Measure {
 public:
  static void describe(Schema<MassLost>& s) { s.text(&MassLost::part, "part", "part that is measured"); }

  std::vector<std::string> references() const override { return {part}; }

  MeasuredValues evaluate(const MeasureModel& model, MeasureRanks& ranks) const override {
    const int number = measured_part(model, part, *this);
    const auto [live] = sum_terms<1>(ranks, model.elements.size(), [&](std::size_t i) {
      return std::array{model.elements[i].part == number ? model.elements[i].mass : 0.0};
    });
    const double initial = model.initial_mass[static_cast<std::size_t>(number)];
    // Both masses are sums of rounded numbers; less than any element is nothing.
    const double lost = initial - live > 1e-12 * initial ? initial - live : 0.0;
    return {{"", lost}, {"fraction", lost / initial}};
  }

  std::string part;
};

}  // namespace
}  // namespace kerf

KERF_REGISTER(KERF_TYPE(kerf::MassLost, "measure", "mass_lost",
                        "initial mass less the mass of the live elements of a part [kg], and as a fraction"))
