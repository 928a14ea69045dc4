// A measure outside of Kerf's tree: how far the long axis of a part's heaviest piece has turned.
#include <cmath>

#include <kerf/bodies/measured_bodies.hpp>
#include <kerf/functions.hpp>

/// Angle between the axis of the piece and a direction, such as the one that a rod had at the start.
struct Tilt final : kerf::Measure {
  std::string part;
  kerf::Vec3 direction;

  static void describe(kerf::Schema<Tilt>& s) {
    s.text(&Tilt::part, "part", "part that is measured");
    s.vector(&Tilt::direction, "direction", "-", kerf::any_value, "direction of no tilt, of any length");
    s.rule("direction", "direction must not have zero length", [](const Tilt& t) { return norm(t.direction) > 0.0; });
  }
  std::vector<std::string> references() const override { return {part}; }
  kerf::MeasuredValues evaluate(const kerf::MeasureModel& model, kerf::MeasureRanks& ranks) const override {
    using namespace kerf::bodies;
    const Body body = largest_body(model, ranks, measured_part(model, part, *this), kerf::bodies::Link::node);
    if (body.is_empty) return {unknown("", nothing_left(part))};
    const LongAxis axis = long_axis(model, ranks, body, {});
    if (!axis.clear()) return {unknown("", "the largest piece of part " + part + " is about as wide as long")};
    const kerf::Vec3 along = unit(direction);
    return {{"", kerf::atan2(norm(cross(axis.direction, along)), std::fabs(dot(axis.direction, along)))}};
  }
};

KERF_MEASURE(Tilt, "tilt", "angle between the long axis of a part and a direction [rad]")
