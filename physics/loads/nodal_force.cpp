// A force on each node.
#include <kerf/load.hpp>

namespace {

using namespace kerf;

/// F(t) = F0 f(t) on every node.
struct NodalForce final : NodalLoad {
  std::vector<std::string> names;
  Vec3 constant;  // [N]
  const Curve* curve = nullptr;

  static void describe(Schema<NodalForce>& s) {
    s.texts(&NodalForce::names, "nodes", "parts or sets whose nodes are pushed");
    s.vector(&NodalForce::constant, "force", "N", any_value, "force on each node where the curve is 1");
    s.curve(&NodalForce::curve, "curve", "factor of the force by time; 1 where absent").optional();
    s.rule("nodes", "name at least one part or set", [](const NodalForce& f) { return !f.names.empty(); });
  }
  std::vector<std::string> targets() const override { return names; }
  std::optional<double> greatest() const override { return norm(constant) * greatest_of(curve); }
  Vec3 force(const LoadedNode&, double time) const override { return constant * value_of(curve, time); }
};

}  // namespace

KERF_LOAD(NodalForce, "nodal_force", "pushes each node with a force, a constant times a curve of time")
