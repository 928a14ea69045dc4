// Length of what is left of a penetrator: the extent of its largest connected body. See doc/theory/measures.md.
#include "dynamics/measure_geometry.hpp"
#include "kerf/plugin.hpp"

namespace kerf {
namespace {

class ResidualLength final : public Measure {
 public:
  static void describe(Schema<ResidualLength>& s) {
    s.text(&ResidualLength::part, "part", "part that is measured");
    s.vector(&ResidualLength::axis, "axis", "-", any_value,
             "direction along which the length is taken; by default the body's own long axis in its final position")
        .optional();
    s.vector(&ResidualLength::symmetry_normal, "symmetry_normal", "-", any_value,
             "normal of the symmetry plane of a half model; the long axis is then looked for in that plane")
        .optional();
  }

  std::vector<std::string> references() const override { return {part}; }

  MeasuredValues evaluate(const MeasureModel& model) const override {
    const std::vector<std::int32_t> body = largest_body(model, measured_part(model, part, *this), Link::node);
    if (body.empty()) return {{"", not_measurable}};
    const Vec3 direction = norm(axis) > 0.0 ? unit(axis) : long_axis(model, body, symmetry_normal);
    return {{"", extent_along(model, nodes_of(model, body), direction)}};
  }

  std::string part;
  Vec3 axis, symmetry_normal;  // zero where absent
};

}  // namespace
}  // namespace kerf

KERF_REGISTER(KERF_TYPE(kerf::ResidualLength, "measure", "residual_length",
                        "length of the largest connected body of live elements of a part [m]"))
