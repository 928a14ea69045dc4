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

  MeasuredValues evaluate(const MeasureModel& model) const override {
    const int number = measured_part(model, part, *this);
    if (!any_node_left(model, number)) {
      const std::string reason = no_node_left(part);
      return {unknown("x", reason), unknown("y", reason), unknown("z", reason)};
    }
    Vec3 momentum;
    for (const MeasureModel::Node& n : model.nodes) momentum = momentum + model.mass_in(n, number) * n.velocity;
    return {{"x", momentum.x}, {"y", momentum.y}, {"z", momentum.z}};
  }

  std::string part;
};

}  // namespace
}  // namespace kerf

KERF_REGISTER(KERF_TYPE(kerf::PartMomentum, "measure", "part_momentum", "momentum of all nodes of a part [kg m/s]"))
