// Acceleration of bodies, the same for all their mass.
#include <kerf/load.hpp>

namespace {

using namespace kerf;

/// a(t) = a0 f(t).
struct Gravity final : BodyLoad {
  std::vector<std::string> names;
  Vec3 constant;  // [m/s2]
  const Curve* curve = nullptr;

  static void describe(Schema<Gravity>& s) {
    s.texts(&Gravity::names, "nodes", "parts or sets whose nodes are accelerated; all nodes where absent").optional();
    s.vector(&Gravity::constant, "acceleration", "m/s2", any_value, "acceleration where the curve is 1");
    s.curve(&Gravity::curve, "curve", "factor of the acceleration by time; 1 where absent").optional();
  }
  std::vector<std::string> targets() const override { return names; }
  std::optional<double> greatest() const override { return norm(constant) * greatest_of(curve); }
  Vec3 acceleration(const LoadedNode&, double time) const override { return constant * value_of(curve, time); }
};

}  // namespace

KERF_LOAD(Gravity, "gravity", "accelerates bodies, a constant times a curve of time")
