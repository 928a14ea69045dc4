// Kinetic energy of all nodes of a part, those without live elements included.
#include "kerf/bodies/measured_bodies.hpp"
#include "kerf/plugin.hpp"

namespace kerf {
namespace {

using namespace bodies;

class KineticEnergy final : public Measure {
 public:
  static void describe(Schema<KineticEnergy>& s) { s.text(&KineticEnergy::part, "part", "part that is measured"); }

  std::vector<std::string> references() const override { return {part}; }

  MeasuredValues evaluate(const MeasureModel& model, MeasureRanks& ranks) const override {
    const int number = measured_part(model, part, *this);
    if (!any_node_left(model, ranks, number)) return {unknown("", no_node_left(part))};
    const auto [energy] = sum_terms<1>(ranks, model.nodes.size(), [&](std::size_t i) {
      const MeasureModel::Node& n = model.nodes[i];
      return std::array{0.5 * model.mass_in(n, number) * dot(n.velocity, n.velocity)};
    });
    return {{"", energy}};
  }

  std::string part;
};

}  // namespace
}  // namespace kerf

KERF_REGISTER(KERF_TYPE(kerf::KineticEnergy, "measure", "kinetic_energy", "kinetic energy of all nodes of a part [J]"))
