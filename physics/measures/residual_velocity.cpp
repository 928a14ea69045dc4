// Velocity of what is left of a penetrator: momentum over mass of its largest connected body.
#include "kerf/plugin.hpp"
#include "support/geometry.hpp"

namespace kerf {
namespace {

class ResidualVelocity final : public Measure {
 public:
  static void describe(Schema<ResidualVelocity>& s) {
    s.text(&ResidualVelocity::part, "part", "part that is measured");
  }

  std::vector<std::string> references() const override { return {part}; }

  // Elements are weighed, not nodes: a node keeps the mass of eroded elements, which the body has lost.
  MeasuredValues evaluate(const MeasureModel& model) const override {
    double mass = 0.0;
    Vec3 momentum;
    for (const std::int32_t i : largest_body(model, measured_part(model, part, *this), Link::node)) {
      const MeasureModel::Element& e = model.elements[static_cast<std::size_t>(i)];
      mass += e.mass;
      const double share = 1.0 / e.shape->n_nodes;
      for (const std::int32_t n : MeasureModel::nodes_of(e))
        momentum = momentum + share * e.mass * model.nodes[static_cast<std::size_t>(n)].velocity;
    }
    if (!(mass > 0.0)) {
      const std::string reason = nothing_left(part);
      return {unknown("x", reason), unknown("y", reason), unknown("z", reason), unknown("speed", reason)};
    }
    const Vec3 v = momentum * (1.0 / mass);
    return {{"x", v.x}, {"y", v.y}, {"z", v.z}, {"speed", norm(v)}};
  }

  std::string part;
};

}  // namespace
}  // namespace kerf

KERF_REGISTER(KERF_TYPE(kerf::ResidualVelocity, "measure", "residual_velocity",
                        "mean velocity of the largest connected body of live elements of a part [m/s]"))
