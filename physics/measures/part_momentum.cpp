// Momentum of all nodes of a part, those without live elements included.
#include "kerf/bodies/measured_bodies.hpp"
#include "kerf/plugin.hpp"

namespace kerf {
namespace {

using namespace bodies;

class PartMomentum final : public Measure {
 public:
  static void describe(Schema<PartMomentum>& s) { s.text(&PartMomentum::part, "part", "part that is measured"); }

  std::vector<std::string> references() const override { return {part}; }

  MeasuredValues evaluate(const MeasureModel& model, MeasureRanks& ranks) const override {
    const int number = measured_part(model, part, *this);
    if (!any_node_left(model, ranks, number)) {
      const std::string reason = no_node_left(part);
      return {unknown("x", reason), unknown("y", reason), unknown("z", reason)};
    }
    const auto [x, y, z] = sum_terms<3>(ranks, model.nodes.size(), [&](std::size_t i) {
      const Vec3 momentum = model.mass_in(model.nodes[i], number) * model.nodes[i].velocity;
      return std::array{momentum.x, momentum.y, momentum.z};
    });
    return {{"x", x}, {"y", y}, {"z", z}};
  }

  std::string part;
};

}  // namespace
}  // namespace kerf

KERF_REGISTER(KERF_TYPE(kerf::PartMomentum, "measure", "part_momentum", "momentum of all nodes of a part [kg m/s]"))
