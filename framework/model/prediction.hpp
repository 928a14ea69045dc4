// What nodes will do in the coming step, before anybody has moved them.
#pragma once

#include <vector>

#include "core/quad.hpp"
#include "model/constraints.hpp"
#include "model/model.hpp"
#include "model/step.hpp"

namespace kerf {

/// The velocity of a node after a kick, without boundary conditions [m/s]; `factor` leads from force quanta times the
/// inverse mass to velocity.
inline Quad kicked(const NodeStore& nodes, int i, double factor) {
  return row_of(nodes.velocity.data(), i) +
         __builtin_convertvector(row_of(nodes.force.data(), i), Quad) * (nodes.inverse_mass[i] * factor);
}

/// What nodes will do in the coming step under the forces that are known, boundary conditions included.
class Prediction {
 public:
  /// All must outlive this.
  Prediction(const Constraints& constraints, const Model& model, const Step& next);
  /// Velocity in the coming step [m/s].
  Quad velocity(int node) const;
  /// Position at its end [m].
  Quad position(int node) const { return from(node) + velocity(node) * next_.dt; }
  /// Both, and the axes along which boundary conditions keep a node from following a force, as bits. A condition that
  /// is oblique to the axes does not count.
  struct Flight {
    Quad velocity, position;
    unsigned held_axes = 0;
  };
  Flight flight(int node) const;
  /// Where a node is now, where it will be at the end of the step, and how far it may be beside the straight line
  /// between the two, along each axis, at the end of any shorter step [m].
  struct Way {
    Quad start, end, aside;
  };
  Way way(int node) const;
  const Step& step() const { return next_; }

 private:
  Quad from(int node) const { return row_of(model_.nodes.position.data(), node); }
  bool is_free(int node, const Quad& velocity) const;
  unsigned held_axes(int node, Vec3 kicked, Vec3 constrained) const;

  const Constraints& constraints_;
  const Model& model_;
  Step next_;
  double factor_;  // from force quanta times inverse mass to velocity
  std::vector<HalfSpace> planes_;
};

}  // namespace kerf
