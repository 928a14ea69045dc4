// Planes that nodes cannot pass: a plane of symmetry, and a rigid wall.
#include <kerf/boundary.hpp>

#include <sstream>

namespace {

using namespace kerf;

std::string behind(const char* what, double distance, const char* advice) {
  std::ostringstream text;
  text << "starts " << distance << " m behind the " << what << "; " << advice;
  return text.str();
}

/// Keeps nodes that lie on a plane on it. The model is on the side to which the normal points; a free node that
/// would cross the plane meets its mirror image there, and bounces off it.
struct Symmetry final : NamedNodesBoundary {
  Vec3 point, normal, axis;  // [m], [-]
  double angle = 0.0;  // [rad]
  double tolerance = 0.0;  // zero until it is known [m]

  static void describe(Schema<Symmetry>& s) {
    describe_nodes(s);
    s.vector(&Symmetry::point, "point", "m", any_value, "a point on the plane").by_default("[0, 0, 0]");
    s.vector(&Symmetry::normal, "normal", "-", any_value,
             "normal of the plane, of any length, pointing to the side where the model is");
    s.real(&Symmetry::angle, "angle", "rad", any_value,
           "angle by which the normal is turned about the axis, for planes that no short normal describes")
        .by_default("0 rad");
    s.vector(&Symmetry::axis, "axis", "-", any_value, "axis about which the normal is turned").by_default("[0, 0, 1]");
    s.real(&Symmetry::tolerance, "tolerance", "m", positive,
           "distance within which a node lies on the plane; by default a millionth of the shortest edge of the mesh")
        .optional();
    s.rule("normal", "normal must not have zero length", [](const Symmetry& p) { return norm(p.normal) > 0.0; });
    s.rule("axis", "axis must not have zero length", [](const Symmetry& p) { return norm(p.axis) > 0.0; });
  }
  void prepare(const MeshScale& scale) override {
    if (!(tolerance > 0.0)) tolerance = scale.tolerance();
    if (angle == 0.0) return;
    // Rodrigues' formula.
    const Vec3 a = axis * (1.0 / norm(axis));
    const double c = kerf::cos(angle), s = kerf::sin(angle);
    normal = normal * c + cross(a, normal) * s + a * (dot(a, normal) * (1.0 - c));
    angle = 0.0;  // done
  }
  Ask ask(Vec3 x) const override { return std::fabs(distance(x)) <= tolerance ? Ask::always : Ask::near_region; }
  HalfSpace region(double) const override { return {normal, dot(point, normal)}; }
  bool mirrors(Vec3 x) const override { return std::fabs(distance(x)) <= tolerance; }
  Vec3 initial(const BoundaryNode& node, Vec3 v) const override {
    return std::fabs(distance(node.position)) <= tolerance ? slide(v) : v;
  }
  Vec3 constrain(const BoundaryNode& node, const BoundaryStep& step, Vec3 v) const override {
    const double gap = distance(node.position);
    if (gap <= tolerance) return slide(v);
    const double end = gap + step.dt * dot(v, normal) / norm(normal);
    return end < 0.0 ? v - normal * (2.0 * dot(v, normal) / dot(normal, normal)) : v;
  }
  std::string complaint(const BoundaryNode& node) const override {
    const double gap = distance(node.position);
    if (gap >= -tolerance) return {};
    return behind("plane of symmetry", -gap,
                  "turn the normal round if the model is on the other side, or raise the tolerance for a coarse mesh "
                  "file");
  }

 private:
  double distance(Vec3 x) const { return dot(x - point, normal) / norm(normal); }
  Vec3 slide(Vec3 v) const { return v - normal * (dot(v, normal) / dot(normal, normal)); }
};

/// A plane that pushes and never pulls, with Coulomb friction. A node that would end a step behind the wall is
/// given the normal velocity that puts it on the wall.
struct RigidWall final : NamedNodesBoundary {
  Vec3 point, normal, velocity;  // [m], [-], [m/s]
  double friction = 0.0;  // [-]
  double round_off = 0.0;  // of placing a node on the wall [m]

  static void describe(Schema<RigidWall>& s) {
    describe_nodes(s);
    s.vector(&RigidWall::point, "point", "m", any_value, "a point on the wall at time zero");
    s.vector(&RigidWall::normal, "normal", "-", any_value,
             "normal of the wall, of any length, pointing to the side where the nodes are");
    s.vector(&RigidWall::velocity, "velocity", "m/s", any_value, "velocity of the wall").by_default("[0, 0, 0]");
    s.real(&RigidWall::friction, "friction", "-", non_negative, "coefficient of Coulomb friction").by_default("0");
    s.rule("normal", "normal must not have zero length", [](const RigidWall& w) { return norm(w.normal) > 0.0; });
  }
  void prepare(const MeshScale& scale) override { round_off = scale.tolerance(); }
  Ask ask(Vec3) const override { return Ask::near_region; }
  HalfSpace region(double time) const override { return {normal, dot(point + velocity * time, normal)}; }
  Vec3 constrain(const BoundaryNode& node, const BoundaryStep& step, Vec3 v) const override {
    const double end_time = step.time + 0.5 * step.dt;
    const Vec3 from_wall = node.position + step.dt * v - (point + end_time * velocity);
    const double depth = -dot(from_wall, normal);  // times the normal's length
    if (depth <= 0.0) return v;
    const double length = norm(normal);
    const Vec3 n = normal * (1.0 / length);
    const double push = depth / (length * step.dt);  // change of the normal velocity [m/s]
    const Vec3 relative = v - velocity;
    const Vec3 sliding = relative - n * dot(relative, n);
    const double speed = norm(sliding);
    const double slowed = speed > friction * push ? friction * push / speed : 1.0;
    return v + n * push - sliding * (friction > 0.0 ? slowed : 0.0);
  }
  std::string complaint(const BoundaryNode& node) const override {
    const double gap = dot(node.position - point, normal) / norm(normal);
    if (gap >= -round_off) return {};
    return behind("rigid wall", -gap, "move the part or the wall, or turn the wall's normal round");
  }
};

}  // namespace

KERF_REGISTER(KERF_TYPE(Symmetry, "boundary", "symmetry", "keeps the nodes of a plane of symmetry on it")
                  KERF_TYPE(RigidWall, "boundary", "rigid_wall", "plane that pushes nodes away, with friction"))
