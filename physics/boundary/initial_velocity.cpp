// Velocity of nodes at time zero.
#include <kerf/boundary.hpp>

namespace {

using namespace kerf;

/// Sets v = velocity + angular_velocity x (position - point) at the start, and nothing later.
struct InitialVelocity final : NamedNodesBoundary {
  Vec3 velocity, angular_velocity, point;  // [m/s], [rad/s], [m]

  static void describe(Schema<InitialVelocity>& s) {
    describe_nodes(s);
    s.vector(&InitialVelocity::velocity, "velocity", "m/s", any_value, "velocity at the start; replaces the part's")
        .by_default("[0, 0, 0]");
    s.vector(&InitialVelocity::angular_velocity, "angular_velocity", "rad/s", any_value, "spin about the point")
        .by_default("[0, 0, 0]");
    s.vector(&InitialVelocity::point, "point", "m", any_value, "point about which the nodes spin")
        .by_default("[0, 0, 0]");
  }
  Vec3 initial(const BoundaryNode& node, Vec3) const override {
    return velocity + cross(angular_velocity, node.position - point);
  }
  Ask ask(Vec3) const override { return Ask::never; }
  Vec3 constrain(const BoundaryNode&, const BoundaryStep&, Vec3 v) const override { return v; }
};

}  // namespace

KERF_BOUNDARY(InitialVelocity, "initial_velocity", "velocity and spin at the start")
