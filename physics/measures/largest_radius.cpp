// Largest distance of a part from an axis, over all of it or in one section: the Taylor bar's mushroom and waist.
#include <cmath>

#include "kerf/bodies/measured_bodies.hpp"
#include "kerf/plugin.hpp"
#include "kerf/shape.hpp"

namespace kerf {
namespace {

using namespace bodies;

class LargestRadius final : public Measure {
 public:
  static void describe(Schema<LargestRadius>& s) {
    s.text(&LargestRadius::part, "part", "part that is measured");
    s.vector(&LargestRadius::axis, "axis", "-", any_value,
             "direction of the axis, from the end at which heights are zero");
    s.vector(&LargestRadius::point, "point", "m", any_value, "a point on the axis").by_default("[0, 0, 0]");
    s.real(&LargestRadius::at_height, "at_height", "-", fraction,
           "measure the section at this height above the lower end, as a fraction of the part's initial length; "
           "all of the part where absent")
        .optional();
    s.rule("axis", "the axis must not have zero length", [](const LargestRadius& m) { return norm(m.axis) > 0.0; });
  }

  std::vector<std::string> references() const override { return {part}; }

  MeasuredValues evaluate(const MeasureModel& model, MeasureRanks& ranks) const override {
    const int number = measured_part(model, part, *this);
    const Vec3 a = unit(axis);
    const Vec3 across = unit(cross(a, std::fabs(a.x) < 0.6 ? Vec3{1.0, 0.0, 0.0} : Vec3{0.0, 1.0, 0.0}));
    const Vec3 directions[3] = {a, across, cross(a, across)};
    const std::vector<std::int32_t> live = live_nodes(model, number);
    Extent undeformed[3], now[3];
    for (int d = 0; d < 3; ++d) {
      undeformed[d] = from_point(undeformed_extent(ranks, number, directions[d]), directions[d]);
      now[d] = from_point(extent_of(model, ranks, live, directions[d]), directions[d]);
    }
    if (now[0].is_empty()) return {unknown("", nothing_left(part))};
    if (!(holds_zero(undeformed[1]) && holds_zero(undeformed[2])) && !(holds_zero(now[1]) && holds_zero(now[2])))
      return {unknown("", "the axis does not pass through part " + part + "; look at `axis` and `point`")};
    const double height = now[0].low + dot(point, a) + at_height * (undeformed[0].high - undeformed[0].low);
    double largest = -1.0;
    for (const MeasureModel::Element& e : model.elements) {
      if (e.part != number) continue;
      for (int k = 0; k < e.shape->n_edges; ++k) {
        const auto& edge = e.shape->edge[k];
        const Vec3 p = model.node(e.nodes[static_cast<std::size_t>(edge[0])]).position;
        const Vec3 q = model.node(e.nodes[static_cast<std::size_t>(edge[1])]).position;
        largest = max_of(largest, at_height < 0.0 ? max_of(radius(p, a), radius(q, a)) : radius_at(p, q, a, height));
      }
    }
    largest = ranks.greatest({largest}).front();
    if (largest < 0.0) return {unknown("", "part " + part + " has become too short to reach `at_height`")};
    return {{"", largest}};
  }

  std::string part;
  Vec3 axis, point;
  double at_height = -1.0;  // negative where absent

 private:
  /// Coordinates along a direction, counted from `point`.
  Extent from_point(Extent e, Vec3 direction) const {
    const double from = dot(point, direction);
    return {e.low - from, e.high - from};
  }
  /// The axis may lie on the part's side, as that of a quarter of a bar does. A thousandth of the width is far below
  /// a cell, and far above the error of an axis that is given to four digits.
  static bool holds_zero(Extent e) { return e.low <= 1e-3 * (e.high - e.low) && e.high >= -1e-3 * (e.high - e.low); }
  double radius(Vec3 x, Vec3 a) const {
    const Vec3 d = x - point;
    return norm(d - dot(d, a) * a);
  }
  /// Radius where an edge crosses the section; -1 where it does not.
  double radius_at(Vec3 p, Vec3 q, Vec3 a, double height) const {
    const double below = height - dot(p, a), above = dot(q, a) - height;
    if (below * above < 0.0) return -1.0;
    const double length = below + above;
    if (length == 0.0) return max_of(radius(p, a), radius(q, a));  // the edge lies in the section
    return radius(p + (below / length) * (q - p), a);
  }
};

}  // namespace
}  // namespace kerf

KERF_REGISTER(KERF_TYPE(kerf::LargestRadius, "measure", "largest_radius",
                        "largest distance of a part's live elements from an axis [m]"))
