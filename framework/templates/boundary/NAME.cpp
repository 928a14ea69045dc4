// A rigid plane that shakes: nodes are pushed by it and never pulled, without friction.
//
// The plane moves along its normal by s(t) = a (1 - cos(2 pi f t)), from rest.
#include <kerf/boundary.hpp>

#include <sstream>

namespace {

using namespace kerf;

/// A node that would end a step behind the plane gets the normal velocity that puts it on the plane.
struct @TYPE@ final : NamedNodesBoundary {
  Vec3 point, normal;  // [m], [-]
  double amplitude = 0.0, frequency = 0.0;  // [m], [1/s]
  double round_off = 0.0;  // of placing a node on the plane [m]

  static void describe(Schema<@TYPE@>& s) {
    describe_nodes(s);
    s.vector(&@TYPE@::point, "point", "m", any_value, "a point on the plane at time zero");
    s.vector(&@TYPE@::normal, "normal", "-", any_value,
             "normal of the plane, of any length, pointing to the side where the nodes are");
    s.real(&@TYPE@::amplitude, "amplitude", "m", positive, "half of the way between the two ends of the motion");
    s.real(&@TYPE@::frequency, "frequency", "Hz", positive, "oscillations per time");
    s.rule("normal", "normal must not have zero length", [](const @TYPE@& b) { return norm(b.normal) > 0.0; });
  }

  void prepare(const MeshScale& scale) override { round_off = scale.tolerance(); }
  // Only nodes whose free flight would end behind the plane are asked.
  Ask ask(Vec3) const override { return Ask::near_region; }
  HalfSpace region(double time) const override { return {unit_normal(), plane_at(time)}; }

  Vec3 constrain(const BoundaryNode& node, const BoundaryStep& step, Vec3 velocity) const override {
    const Vec3 n = unit_normal();
    const double depth = plane_at(step.time + 0.5 * step.dt) - dot(n, node.position + step.dt * velocity);
    return depth > 0.0 ? velocity + n * (depth / step.dt) : velocity;
  }
  std::string complaint(const BoundaryNode& node) const override {
    const double gap = dot(unit_normal(), node.position) - plane_at(0.0);
    if (gap >= -round_off) return {};
    std::ostringstream text;
    text << "node " << node.id << " starts " << -gap << " m behind the plane; move the part or the plane, or turn the "
         << "normal round";
    return text.str();
  }

 private:
  static constexpr double pi = 3.14159265358979324;
  Vec3 unit_normal() const { return normal * (1.0 / norm(normal)); }
  /// Where the plane stands along its normal, from the origin [m].
  double plane_at(double time) const {
    return dot(point, unit_normal()) + amplitude * (1.0 - kerf::cos(2.0 * pi * frequency * time));
  }
};

}  // namespace

KERF_BOUNDARY(@TYPE@, "@NAME@", "rigid plane that oscillates along its normal and pushes nodes")
