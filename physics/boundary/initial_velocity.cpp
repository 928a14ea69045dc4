// Velocity of nodes at time zero.
#include <kerf/boundary.hpp>
#include <kerf/expression.hpp>

namespace {

using namespace kerf;

/// Sets, at the start and never later, the sum of a velocity, a spin, a flow from a point or an axis, and formulas:
/// v = velocity + angular_velocity x (x - point) + radial_speed (reference_radius / r)^exponent e_r + formulas(x, y, z,
/// r). r is the distance from the point, or, where an axis is given, from the axis through the point; e_r leads away
/// from it. An incompressible flow has the exponent 2 about a point and 1 about an axis.
struct InitialVelocity final : NamedNodesBoundary {
  Vec3 velocity, angular_velocity, point, axis;  // [m/s], [rad/s], [m], [-]
  double radial_speed = 0.0, reference_radius = 0.0, exponent = 0.0;  // [m/s], [m], [-]
  std::vector<Expression> formulas;

  static void describe(Schema<InitialVelocity>& s) {
    using V = InitialVelocity;
    describe_nodes(s);
    s.vector(&V::velocity, "velocity", "m/s", any_value, "velocity at the start; replaces the part's")
        .by_default("[0, 0, 0]");
    s.vector(&V::angular_velocity, "angular_velocity", "rad/s", any_value, "spin about the point")
        .by_default("[0, 0, 0]");
    s.vector(&V::point, "point", "m", any_value, "point about which the nodes spin, and from which radii count")
        .by_default("[0, 0, 0]");
    s.vector(&V::axis, "axis", "-", any_value,
             "direction, of any length, of the axis through the point from which radii count; where absent, they count "
             "from the point")
        .by_default("[0, 0, 0]");
    s.real(&V::radial_speed, "radial_speed", "m/s", any_value,
           "speed at the reference radius away from the point or axis; negative towards it")
        .by_default("0");
    s.real(&V::reference_radius, "reference_radius", "m", positive, "radius at which the radial speed is as given")
        .optional();
    s.real(&V::exponent, "exponent", "-", any_value, "power n of the radial speed u0 (r0 / r)^n").by_default("0");
    s.expressions(&V::formulas, "expression", "m/s", {"x", "y", "z", "r"},
                  "components of a velocity as three formulas of the position [m] and the radius r [m]")
        .optional();
    s.rule("expression", "expression takes three formulas, of the velocity along x, y and z",
           [](const V& v) { return v.formulas.empty() || v.formulas.size() == 3; });
    s.rule("exponent", "a radial speed that changes with the radius needs a reference_radius",
           [](const V& v) { return v.exponent == 0.0 || v.reference_radius > 0.0; });
    s.rule("radial_speed", "exponent and reference_radius say how a radial_speed changes; give one, or leave them out",
           [](const V& v) { return v.radial_speed != 0.0 || (v.exponent == 0.0 && v.reference_radius == 0.0); });
  }
  Vec3 initial(const BoundaryNode& node, Vec3) const override { return at(node.position); }
  Ask ask(Vec3) const override { return Ask::never; }
  Vec3 constrain(const BoundaryNode&, const BoundaryStep&, Vec3 v) const override { return v; }
  std::string complaint(const BoundaryNode& node) const override {
    const Vec3 v = at(node.position);
    if (std::isfinite(v.x) && std::isfinite(v.y) && std::isfinite(v.z)) return {};
    return "has no finite initial velocity there; keep radii and denominators of formulas away from zero";
  }

 private:
  Vec3 at(Vec3 x) const {
    Vec3 v = velocity + cross(angular_velocity, x - point);
    Vec3 away = x - point;
    if (dot(axis, axis) > 0.0) away = away - axis * (dot(away, axis) / dot(axis, axis));
    const double r = norm(away);
    if (radial_speed != 0.0 && (r > 0.0 || exponent > 0.0)) v = v + away * (speed_at(r) / r);
    if (!formulas.empty()) {
      const double place[] = {x.x, x.y, x.z, r};
      v = v + Vec3{formulas[0].value(place), formulas[1].value(place), formulas[2].value(place)};
    }
    return v;
  }
  double speed_at(double r) const {
    return exponent == 0.0 ? radial_speed : radial_speed * kerf::pow(reference_radius / r, exponent);
  }
};

}  // namespace

KERF_BOUNDARY(InitialVelocity, "initial_velocity", "velocity, spin, radial flow and formulas at the start")
