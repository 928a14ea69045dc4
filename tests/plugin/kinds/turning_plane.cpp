// A boundary condition outside of Kerf's tree: a rigid plane that turns about an axis, as a flap or a striker does.
#include <sstream>

#include <kerf/boundary.hpp>
#include <kerf/functions.hpp>

/// Pushes nodes away without friction, and never pulls: a node that would end a step behind the plane ends it there.
struct TurningPlane final : kerf::NamedNodesBoundary {
  kerf::Vec3 point, normal, axis;
  double rate = 0.0;  // [rad/s]
  double round_off = 0.0;  // of placing a node on the plane [m]

  static void describe(kerf::Schema<TurningPlane>& s) {
    describe_nodes(s);
    s.vector(&TurningPlane::point, "point", "m", kerf::any_value, "a point of the axis, which lies in the plane");
    s.vector(&TurningPlane::normal, "normal", "-", kerf::any_value, "normal at time zero, to the side of the nodes");
    s.vector(&TurningPlane::axis, "axis", "-", kerf::any_value, "axis about which the plane turns");
    s.real(&TurningPlane::rate, "rate", "rad/s", kerf::any_value, "speed of turning, by the right-hand rule");
    s.rule("normal", "normal must have a length", [](const TurningPlane& p) { return norm(p.normal) > 0.0; });
    s.rule("axis", "axis must have a length, and be at a right angle to the normal", [](const TurningPlane& p) {
      return norm(p.axis) > 0.0 && std::fabs(dot(p.axis, p.normal)) < 1e-9 * norm(p.axis) * norm(p.normal);
    });
  }
  void prepare(const kerf::MeshScale& scale) override { round_off = scale.tolerance(); }
  Ask ask(kerf::Vec3) const override { return Ask::near_region; }
  kerf::HalfSpace region(double time) const override {
    const kerf::Vec3 n = normal_at(time);
    return {n, dot(n, point)};
  }
  kerf::Vec3 constrain(const kerf::BoundaryNode& node, const kerf::BoundaryStep& step, kerf::Vec3 v) const override {
    const kerf::Vec3 n = normal_at(step.time + 0.5 * step.dt);
    const double height = dot(node.position + step.dt * v - point, n);
    return height < 0.0 ? v - n * (height / step.dt) : v;
  }
  std::string complaint(const kerf::BoundaryNode& node) const override {
    const double height = dot(node.position - point, normal_at(0.0));
    if (height >= -round_off) return {};
    std::ostringstream text;
    text << "starts " << -height << " m behind the turning plane; move the part or the plane";
    return text.str();
  }

 private:
  kerf::Vec3 normal_at(double time) const {
    const kerf::Vec3 n = normal * (1.0 / norm(normal)), a = axis * (1.0 / norm(axis));
    return n * kerf::cos(rate * time) + cross(a, n) * kerf::sin(rate * time);
  }
};

KERF_BOUNDARY(TurningPlane, "turning_plane", "rigid plane that turns about an axis")
