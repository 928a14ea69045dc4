// Free flights under the known forces, and what boundary conditions make of them.
#include "model/prediction.hpp"

namespace kerf {

Prediction::Prediction(const Constraints& constraints, const Model& model, const Step& next)
    : constraints_(constraints),
      model_(model),
      next_(next),
      factor_(model.quanta.force.quantum * next.kick_dt()),
      planes_(Constraints::regions(model, next)) {}

/// Whether no condition is asked about a flight: most nodes are far from the regions of all that are not always asked.
bool Prediction::is_free(int i, const Quad& v) const {
  if (constraints_.none()) return true;
  if (constraints_.has_always(i)) return false;
  if (!constraints_.has_near(i)) return true;
  return !constraints_.ends_in_region(i, planes_, vector_of(from(i) + v * next_.dt));
}

Quad Prediction::velocity(int i) const {
  const Quad v = kicked(model_.nodes, i, factor_);
  if (is_free(i, v)) return v;
  return quad_of(constraints_.constrain(model_, i, next_, planes_, model_.nodes.v(i), vector_of(v)));
}

Prediction::Flight Prediction::flight(int i) const {
  Flight f{.velocity = kicked(model_.nodes, i, factor_), .position = {}};
  if (!is_free(i, f.velocity)) {
    const Vec3 v = vector_of(f.velocity);
    const Vec3 constrained = constraints_.constrain(model_, i, next_, planes_, model_.nodes.v(i), v);
    f.velocity = quad_of(constrained);
    f.held_axes = held_axes(i, v, constrained);
  }
  f.position = from(i) + f.velocity * next_.dt;
  return f;
}

Prediction::Way Prediction::way(int i) const {
  // A shorter step has a shorter kick, too: its end is on a parabola, at most an eighth of its second difference beside
  // the chord. A boundary condition makes any velocity between the present one and the last.
  constexpr double free_share = 0.25, held_share = 1.0;
  Quad v = kicked(model_.nodes, i, factor_);
  double share = free_share;
  if (!is_free(i, v)) {
    v = quad_of(constraints_.constrain(model_, i, next_, planes_, model_.nodes.v(i), vector_of(v)));
    share = held_share;
  }
  const Quad change = (v - row_of(model_.nodes.velocity.data(), i)) * (share * next_.dt);
  return {from(i), from(i) + v * next_.dt, change < Quad{} ? -change : change};
}

unsigned Prediction::held_axes(int i, Vec3 v, Vec3 unpushed) const {
  const double push = 1e-3 * norm(v) + 1e-3;  // far above round-off [m/s]
  unsigned held = 0;
  for (int d = 0; d < 3; ++d) {
    Vec3 pushed = v;
    pushed[d] += push;
    const Vec3 end = constraints_.constrain(model_, i, next_, planes_, model_.nodes.v(i), pushed);
    if (norm(end - unpushed) < 1e-6 * push) held |= 1u << d;
  }
  return held;
}

}  // namespace kerf
