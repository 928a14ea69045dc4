// Length of what is left of a penetrator: the extent of its largest connected body. See doc/theory/measures.md.
#include <cmath>

#include "kerf/bodies/measured_bodies.hpp"
#include "kerf/plugin.hpp"

namespace kerf {
namespace {

using namespace bodies;

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

  MeasuredValues evaluate(const MeasureModel& model, MeasureRanks& ranks) const override {
    const int number = measured_part(model, part, *this);
    const Body body = largest_body(model, ranks, number, Link::node);
    if (body.is_empty) return {unknown("", nothing_left(part))};
    const std::vector<std::int32_t> nodes = nodes_of(model, ranks, body);
    if (norm(axis) > 0.0) return {{"", extent_along(model, ranks, nodes, unit(axis))}};
    const LongAxis now = long_axis(model, ranks, body, symmetry_normal);
    if (!now.clear())
      return {unknown("", "what is left of part " + part + " is hardly longer than it is wide; give `axis`")};
    if (lies_across(model, ranks, number, nodes, now.direction))
      return {unknown("", "what is left of part " + part + " is wider than it is long; give `axis`")};
    return {{"", extent_along(model, ranks, nodes, now.direction)}};
  }

  std::string part;
  Vec3 axis, symmetry_normal;  // zero where absent

 private:
  /// Whether a direction is nearer to the width of the undeformed part than to its length, as its material lies now.
  bool lies_across(const MeasureModel& model, MeasureRanks& ranks, int number, const std::vector<std::int32_t>& nodes,
                   Vec3 direction) const {
    const LongAxis undeformed = undeformed_long_axis(ranks, number, symmetry_normal);
    if (!undeformed.clear()) return false;
    const Vec3 length = carried_direction(model, ranks, nodes, undeformed.direction);
    return norm(length) > 0.0 && std::fabs(dot(length, direction)) < std::sqrt(0.5);
  }
};

}  // namespace
}  // namespace kerf

KERF_REGISTER(KERF_TYPE(kerf::ResidualLength, "measure", "residual_length",
                        "length of the largest connected body of live elements of a part [m]"))
