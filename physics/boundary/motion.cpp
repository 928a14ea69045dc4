// Nodal motion that is given: held, or moved along a history.
#include <kerf/boundary.hpp>
#include <kerf/curve.hpp>

#include <algorithm>
#include <cmath>
#include <limits>

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

/// Gives components of the velocity or of the displacement: constants times a piecewise linear function of time, which
/// is written here as a table or named.
struct PrescribedMotion final : NamedNodesBoundary {
  static constexpr double none = std::numeric_limits<double>::quiet_NaN();

  Components components;
  Vec3 velocity{none, none, none}, displacement{none, none, none};  // [m/s], [m]; one of them is given
  std::vector<double> times, factors;  // [s], [-]; both empty: 1
  const Curve* curve = nullptr;  // in place of these
  double birth = 0.0, death = std::numeric_limits<double>::infinity();  // [s]

  static void describe(Schema<PrescribedMotion>& s) {
    using M = PrescribedMotion;
    describe_nodes(s);
    s.texts(&M::components, "components", "which of x, y and z are given").by_default("[x, y, z]");
    s.vector(&M::velocity, "velocity", "m/s", any_value, "velocity, where its factor is 1").optional();
    s.vector(&M::displacement, "displacement", "m", any_value,
             "displacement from the place at time zero, where its factor is 1; in place of a velocity")
        .optional();
    s.reals(&M::times, "times", "s", any_value, "times of the factors, increasing").optional();
    s.reals(&M::factors, "factors", "-", any_value,
            "factors of the velocity or displacement at the times, linear between them and constant outside")
        .optional();
    s.curve(&M::curve, "curve", "factor of the velocity or displacement by time, in place of times and factors")
        .optional();
    s.real(&M::birth, "birth", "s", non_negative, "time from which on the motion is given; free before")
        .by_default("0");
    s.real(&M::death, "death", "s", positive, "time from which on the nodes are free again; never where absent")
        .optional();
    describe_rules(s);
  }
  static void describe_rules(Schema<PrescribedMotion>& s) {
    using M = PrescribedMotion;
    s.rule("velocity", "give a velocity or a displacement, one of the two",
           [](const M& m) { return is_given(m.velocity) != is_given(m.displacement); });
    s.rule("curve", "a curve stands in place of times and factors; give one or the other",
           [](const M& m) { return m.curve == nullptr || (m.times.empty() && m.factors.empty()); });
    s.rule("components", "components must be any of x, y and z",
           [](const M& m) { return !m.components.empty() && are_components(m.components); });
    s.rule("factors", "times and factors must be of equal number", [](const M& m) { return m.has_table(); });
    s.rule("times", "times must increase", [](const M& m) {
      return std::adjacent_find(m.times.begin(), m.times.end(), [](double a, double b) { return !(a < b); }) ==
             m.times.end();
    });
    s.rule("death", "death must be after birth", [](const M& m) { return m.death > m.birth; });
    s.rule("displacement",
           "the factor of a displacement must be 0 at time zero, where the nodes are: give a curve, or times and "
           "factors, that begin with 0",
           [](const M& m) { return m.starts_in_place(); });
  }

  void prepare(const MeshScale& scale) override { round_off_ = scale.tolerance(); }
  Vec3 initial(const BoundaryNode&, Vec3 v) const override {
    if (!acts(0.0)) return v;
    return replace(v, is_given(velocity) ? velocity * factor_at(0.0) : displacement * slope_after(0.0));
  }
  Vec3 constrain(const BoundaryNode& node, const BoundaryStep& step, Vec3 v) const override {
    if (!acts(step.time)) return v;
    return replace(v, is_given(velocity) ? velocity * factor_at(step.time) : velocity_to_place(node, step));
  }

 private:
  static bool is_given(Vec3 a) { return !std::isnan(a.x); }
  bool has_table() const { return times.size() == factors.size(); }
  bool acts(double time) const { return time >= birth && time < death; }
  bool starts_in_place() const {
    return !is_given(displacement) || birth > 0.0 || !has_table() || factor_at(0.0) == 0.0;
  }
  Vec3 replace(Vec3 v, Vec3 given) const {
    for (const std::string& c : components) v[c[0] - 'x'] = given[c[0] - 'x'];
    return v;
  }

  /// The velocity by which a node moves, in the step, as far as its given place does. What round-off has left between
  /// the node and its place at the start is taken back. What is more stays: something else has moved the node.
  Vec3 velocity_to_place(const BoundaryNode& node, const BoundaryStep& step) const {
    const double start = step.time - 0.5 * step.dt, end = step.time + 0.5 * step.dt;
    if (!(step.dt > 0.0)) return displacement * slope_after(start);
    const Vec3 from = displacement * factor_at(start), to = displacement * factor_at(end);
    const Vec3 off = node.reference_position + from - node.position;
    Vec3 way = to - from;
    for (int d = 0; d < 3; ++d)
      if (std::fabs(off[d]) <= round_off_) way[d] = node.reference_position[d] + to[d] - node.position[d];
    return way * (1.0 / step.dt);
  }
  double factor_at(double time) const {
    if (times.empty()) return value_of(curve, time);
    const auto next = std::upper_bound(times.begin(), times.end(), time) - times.begin();
    if (next == 0) return factors.front();
    if (next == static_cast<std::ptrdiff_t>(times.size())) return factors.back();
    const double share = (time - times[next - 1]) / (times[next] - times[next - 1]);
    return factors[next - 1] + share * (factors[next] - factors[next - 1]);
  }
  double slope_after(double time) const {
    if (!times.empty()) return Curve(times, factors).slope_after(time);
    return curve != nullptr ? curve->slope_after(time) : 0.0;
  }

  double round_off_ = 0.0;  // far below any cell; zero until the mesh is known [m]
};

}  // namespace

KERF_REGISTER(KERF_TYPE(Fixed, "boundary", "fixed", "holds nodes in some or all directions")
                  KERF_TYPE(PrescribedMotion, "boundary", "prescribed_motion",
                            "moves nodes with a given velocity or displacement"))
