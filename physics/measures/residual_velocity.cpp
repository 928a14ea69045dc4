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
  MeasuredValues evaluate(const MeasureModel& model) const override {
    double mass = 0.0;
    Vec3 momentum;
    for (const std::int32_t i : largest_body(model, measured_part(model, part, *this), Link::node)) {
      const MeasureModel::Element& e = model.elements[static_cast<std::size_t>(i)];
      mass += e.mass;
      const auto nodes = MeasureModel::nodes_of(e);
      for (std::size_t k = 0; k < nodes.size(); ++k)
        momentum =
            momentum + e.shape->mass_share[k] * e.mass * model.nodes[static_cast<std::size_t>(nodes[k])].velocity;
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
