// Which boundary conditions act on which nodes, and what they leave of a velocity.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "model/distinct_lists.hpp"
#include "model/model.hpp"
#include "model/step.hpp"

namespace kerf {

/// A node as boundary conditions see it.
inline BoundaryNode boundary_node(const NodeStore& nodes, int i, Vec3 old_velocity) {
  return {nodes.id[i], nodes.mass[i], nodes.x(i), old_velocity, nodes.reference_position(i)};
}

class Constraints {
 public:
  /// Finds out which nodes are constrained; to be called again whenever nodes are renumbered. Local.
  void resolve(const Model& model);
  /// Sets velocities at time zero. Collective only in that all ranks do it to all copies.
  void initialise(Model& model) const;
  /// One error line for every boundary condition with nodes that cannot start as they stand. Collective.
  std::vector<std::string> complaints(const Model& model) const;

  /// Nodes with conditions that are asked in every step, in ascending order.
  const std::vector<std::int32_t>& constrained() const { return constrained_; }
  /// Whether the model has no condition at all.
  bool none() const { return near_.empty(); }
  /// Whether a node has conditions that are asked in every step. Pre: the model has conditions.
  bool has_always(int node) const { return always_[node] != 0; }
  /// Whether a node has conditions that are asked only if its free flight ends in their region. Pre: the model has
  /// conditions.
  bool has_near(int node) const { return near_[node] != 0; }
  /// Whether a flight of a node that ends at `to` asks a condition of the second kind.
  bool ends_in_region(int node, const std::vector<HalfSpace>& planes, Vec3 to) const {
    for (const std::int32_t b : lists_[near_[node]])
      if (dot(planes[b].normal, to) < planes[b].offset) return true;
    return false;
  }
  /// The region of every condition at the end of a step.
  static std::vector<HalfSpace> regions(const Model& model, const Step& step);
  /// The velocity that the conditions leave of a free flight from the node's present position [m/s]. Conditions with a
  /// region are asked only if the flight, as changed by the conditions before them, ends there.
  /// `after_each`, where given, receives for every condition of the input, in its order, the velocity after it: a
  /// condition that is not asked leaves the velocity as it is.
  Vec3 constrain(const Model& model, int node, const Step& step, const std::vector<HalfSpace>& planes,
                 Vec3 old_velocity, Vec3 velocity, Vec3* after_each = nullptr) const;

 private:
  std::vector<std::int32_t> constrained_;
  DistinctLists lists_;  // of conditions, as places in the input
  std::vector<std::int32_t> always_, near_;  // per node: a list; empty where there is no condition at all
  std::vector<char> on_oblique_planes_;  // per node: whether it lies on mirror planes that are not at right angles
};

}  // namespace kerf
