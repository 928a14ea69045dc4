// The tilt of a body: the angle between an axis of the undeformed part and where that axis points at the end.
#include <kerf/measure.hpp>

#include <limits>

namespace {

using namespace kerf;

/// The axis a of the undeformed body has become b = sum m (s - s0) (x - x0) / sum m (s - s0)^2, the best linear
/// dependence of positions x on the place s = a X along the axis; means by mass. Exact for rigid and linear motion.
struct @TYPE@ final : Measure {
  std::string part;
  Vec3 axis;

  static void describe(Schema<@TYPE@>& s) {
    s.text(&@TYPE@::part, "part", "part that is measured");
    s.vector(&@TYPE@::axis, "axis", "-", any_value, "axis of the undeformed part, of any length");
    s.rule("axis", "the axis must not have zero length", [](const @TYPE@& m) { return norm(m.axis) > 0.0; });
  }
  std::vector<std::string> references() const override { return {part}; }

  MeasuredValues evaluate(const MeasureModel& model) const override {
    const Vec3 a = axis * (1.0 / norm(axis));
    const int number = number_of(model);
    // (i) means by mass, of nodes that belong to live elements
    double mass = 0.0, s0 = 0.0;
    Vec3 x0;
    for (const MeasureModel::Node& n : model.nodes) {
      const double m = weight(model, n, number);
      mass += m;
      if (m > 0.0) s0 += m * dot(a, n.reference);
      if (m > 0.0) x0 = x0 + m * n.position;
    }
    if (!(mass > 0.0)) return {unknown("no element of part " + part + " is left")};
    s0 /= mass;
    x0 = x0 * (1.0 / mass);
    // (ii) the axis as it is now, but for its length
    Vec3 b;
    for (const MeasureModel::Node& n : model.nodes) {
      const double m = weight(model, n, number);
      if (m > 0.0) b = b + (m * (dot(a, n.reference) - s0)) * (n.position - x0);
    }
    if (!(norm(b) > 0.0)) return {unknown("part " + part + " has no extent along the axis")};
    return {{"", kerf::atan2(norm(cross(a, b)), dot(a, b))}};
  }

 private:
  static MeasuredValue unknown(const std::string& reason) {
    return {"", std::numeric_limits<double>::quiet_NaN(), reason};
  }
  int number_of(const MeasureModel& model) const {
    int number = 0;
    while (model.parts[static_cast<std::size_t>(number)] != part) ++number;  // the name has been validated
    return number;
  }
  static double weight(const MeasureModel& model, const MeasureModel::Node& n, int part_number) {
    return n.free || n.id < 0 ? 0.0 : model.mass_in(n, part_number);
  }
};

}  // namespace

KERF_REGISTER(KERF_TYPE(@TYPE@, "measure", "@NAME@", "angle by which a part has tilted [rad]"))
