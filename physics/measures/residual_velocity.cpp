// Velocity of what is left of a penetrator: momentum over mass of its largest connected body.
#include "kerf/bodies/measured_bodies.hpp"
#include "kerf/plugin.hpp"

namespace kerf {
namespace {

using namespace bodies;

class ResidualVelocity final : public Measure {
 public:
  static void describe(Schema<ResidualVelocity>& s) {
    s.text(&ResidualVelocity::part, "part", "part that is measured");
  }

  std::vector<std::string> references() const override { return {part}; }

  // Elements are weighed, not nodes: a node keeps the mass of eroded elements, which the body has lost.
  MeasuredValues evaluate(const MeasureModel& model, MeasureRanks& ranks) const override {
    const Body body = largest_body(model, ranks, measured_part(model, part, *this), Link::node);
    if (body.is_empty) {
      const std::string reason = nothing_left(part);
      return {unknown("x", reason), unknown("y", reason), unknown("z", reason), unknown("speed", reason)};
    }
    const auto [mass, x, y, z] = sum_terms<4>(ranks, body.elements.size(), [&](std::size_t i) {
      const MeasureModel::Element& e = model.element(body.elements[i]);
      Vec3 momentum;
      const auto nodes = MeasureModel::nodes_of(e);
      for (std::size_t k = 0; k < nodes.size(); ++k)
        momentum = momentum + e.shape->mass_share[k] * e.mass * model.node(nodes[k]).velocity;
      return std::array{e.mass, momentum.x, momentum.y, momentum.z};
    });
    const Vec3 v = Vec3{x, y, z} * (1.0 / mass);
    return {{"x", v.x}, {"y", v.y}, {"z", v.z}, {"speed", norm(v)}};
  }

  std::string part;
};

}  // namespace
}  // namespace kerf

KERF_REGISTER(KERF_TYPE(kerf::ResidualVelocity, "measure", "residual_velocity",
                        "mean velocity of the largest connected body of live elements of a part [m/s]"))
