// Nodal motion that is given: held, or moved along a history.
#include <kerf/boundary.hpp>
#include <kerf/curve.hpp>

#include <algorithm>

namespace {

using namespace kerf;

using Components = std::vector<std::string>;

bool are_components(const Components& names) {
  return std::all_of(names.begin(), names.end(), [](const std::string& c) { return c == "x" || c == "y" || c == "z"; });
}

/// Holds components of the velocity at zero.
struct Fixed final : NamedNodesBoundary {
  Components components;

  static void describe(Schema<Fixed>& s) {
    describe_nodes(s);
    s.texts(&Fixed::components, "components", "which of x, y and z are held").by_default("[x, y, z]");
    s.rule("components", "components must be any of x, y and z",
           [](const Fixed& f) { return !f.components.empty() && are_components(f.components); });
  }
  Vec3 initial(const BoundaryNode&, Vec3 v) const override { return hold(v); }
  Vec3 constrain(const BoundaryNode&, const BoundaryStep&, Vec3 v) const override { return hold(v); }

 private:
  Vec3 hold(Vec3 v) const {
    for (const std::string& c : components) v[c[0] - 'x'] = 0.0;
    return v;
  }
};

/// Gives components of the velocity: a constant, or a constant times a piecewise linear function of time, which is
/// written here as a table or named.
struct PrescribedMotion final : NamedNodesBoundary {
  Components components;
  Vec3 velocity;  // [m/s]
  std::vector<double> times, factors;  // [s], [-]; both empty: 1
  const Curve* curve = nullptr;  // in place of these

  static void describe(Schema<PrescribedMotion>& s) {
    describe_nodes(s);
    s.texts(&PrescribedMotion::components, "components", "which of x, y and z are given").by_default("[x, y, z]");
    s.vector(&PrescribedMotion::velocity, "velocity", "m/s", any_value, "velocity, where its factor is 1");
    s.reals(&PrescribedMotion::times, "times", "s", any_value, "times of the factors, increasing").optional();
    s.reals(&PrescribedMotion::factors, "factors", "-", any_value,
            "factors of the velocity at the times, linear between them and constant outside")
        .optional();
    s.curve(&PrescribedMotion::curve, "curve", "factor of the velocity by time, in place of times and factors")
        .optional();
    s.rule("curve", "a curve stands in place of times and factors; give one or the other",
           [](const PrescribedMotion& m) { return m.curve == nullptr || (m.times.empty() && m.factors.empty()); });
    s.rule("components", "components must be any of x, y and z",
           [](const PrescribedMotion& m) { return !m.components.empty() && are_components(m.components); });
    s.rule("factors", "times and factors must be of equal number",
           [](const PrescribedMotion& m) { return m.times.size() == m.factors.size(); });
    s.rule("times", "times must increase", [](const PrescribedMotion& m) {
      return std::adjacent_find(m.times.begin(), m.times.end(), [](double a, double b) { return !(a < b); }) ==
             m.times.end();
    });
  }
  Vec3 initial(const BoundaryNode&, Vec3 v) const override { return move(v, 0.0); }
  Vec3 constrain(const BoundaryNode&, const BoundaryStep& step, Vec3 v) const override { return move(v, step.time); }

 private:
  Vec3 move(Vec3 v, double time) const {
    const double factor = factor_at(time);
    for (const std::string& c : components) v[c[0] - 'x'] = factor * velocity[c[0] - 'x'];
    return v;
  }
  double factor_at(double time) const {
    if (times.empty()) return value_of(curve, time);
    const auto next = std::upper_bound(times.begin(), times.end(), time) - times.begin();
    if (next == 0) return factors.front();
    if (next == static_cast<std::ptrdiff_t>(times.size())) return factors.back();
    const double share = (time - times[next - 1]) / (times[next] - times[next - 1]);
    return factors[next - 1] + share * (factors[next] - factors[next - 1]);
  }
};

}  // namespace

KERF_REGISTER(KERF_TYPE(Fixed, "boundary", "fixed", "holds nodes in some or all directions")
                  KERF_TYPE(PrescribedMotion, "boundary", "prescribed_motion", "moves nodes with a given velocity"))
