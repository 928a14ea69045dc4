// Damping by mass: a force against the velocity of every node, as of a body in a viscous medium.
#include <kerf/load.hpp>

#include <optional>
#include <stdexcept>

namespace {

using namespace kerf;

/// a_i = -c f(t) g_i v_i, with the factors g of the directions.
struct MassDamping final : BodyLoad {
  std::vector<std::string> names;
  double coefficient = 0.0;  // [1/s]
  Vec3 factors{1.0, 1.0, 1.0};
  const Curve* curve = nullptr;

  static void describe(Schema<MassDamping>& s) {
    using M = MassDamping;
    s.texts(&M::names, "nodes", "parts or sets whose nodes are damped; all nodes where absent").optional();
    s.real(&M::coefficient, "coefficient", "1/s", positive, "force over mass and velocity, where the curve is 1");
    s.vector(&M::factors, "factors", "-", non_negative, "factors of the force along x, y and z")
        .by_default("[1, 1, 1]");
    s.curve(&M::curve, "curve", "factor of the force by time; 1 where absent").optional();
  }
  std::vector<std::string> targets() const override { return names; }
  /// Of the law's own numbers it is known only where it is zero for ever; the velocities are not.
  std::optional<double> greatest() const override {
    if (greatest_of(curve) > 0.0 && norm(factors) > 0.0) return std::nullopt;
    return 0.0;
  }
  Vec3 acceleration(const LoadedNode& node, double time) const override {
    const double factor = value_of(curve, time);
    if (factor < 0.0) throw std::runtime_error("its curve is negative, and damping cannot give energy");
    const double c = coefficient * factor;
    if (c * max_of(max_of(factors.x, factors.y), factors.z) * node.time_step > 1.0)
      throw std::runtime_error(
          "its coefficient times the time step is above 1, and damping cannot turn a velocity round");
    return {-c * factors.x * node.velocity.x, -c * factors.y * node.velocity.y, -c * factors.z * node.velocity.z};
  }
};

}  // namespace

KERF_LOAD(MassDamping, "mass_damping", "slows bodies by a force against the velocity of every node, times its mass")
