// The tilt of a body: the angle between an axis of the undeformed part and where that axis points at the end.
#include <kerf/bodies/measured_bodies.hpp>
#include <kerf/functions.hpp>

#include <array>

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

  /// Called on all ranks together; each sees its own elements and nodes. `ranks.sums` adds the terms of all of them:
  /// every rank gets the same bits, whoever owns what. Collective.
  MeasuredValues evaluate(const MeasureModel& model, MeasureRanks& ranks) const override {
    const Vec3 a = axis * (1.0 / norm(axis));
    const int number = bodies::measured_part(model, part, *this);
    const std::size_t n = model.nodes.size();
    // (i) means by mass, of nodes that belong to live elements
    const auto [mass, s, x, y, z] = bodies::sum_terms<5>(ranks, n, [&](std::size_t i) {
      const MeasureModel::Node& node = model.nodes[i];
      const double m = weight(model, node, number);
      return std::array{m, m * dot(a, node.reference), m * node.position.x, m * node.position.y, m * node.position.z};
    });
    if (!(mass > 0.0)) return {bodies::unknown("", bodies::nothing_left(part))};
    const double s0 = s / mass;
    const Vec3 x0 = Vec3{x, y, z} * (1.0 / mass);
    // (ii) the axis as it is now, but for its length
    const auto [bx, by, bz] = bodies::sum_terms<3>(ranks, n, [&](std::size_t i) {
      const MeasureModel::Node& node = model.nodes[i];
      const Vec3 term = (weight(model, node, number) * (dot(a, node.reference) - s0)) * (node.position - x0);
      return std::array{term.x, term.y, term.z};
    });
    const Vec3 b{bx, by, bz};
    if (!(norm(b) > 0.0)) return {bodies::unknown("", "part " + part + " has no extent along the axis")};
    return {{"", kerf::atan2(norm(cross(a, b)), dot(a, b))}};
  }

 private:
  /// Zero for nodes that another rank owns, so that each node counts once.
  static double weight(const MeasureModel& model, const MeasureModel::Node& n, int part_number) {
    return n.free ? 0.0 : model.mass_in(n, part_number);
  }
};

}  // namespace

KERF_REGISTER(KERF_TYPE(@TYPE@, "measure", "@NAME@", "angle by which a part has tilted [rad]"))
