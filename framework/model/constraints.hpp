// Which boundary conditions act on which nodes, and what they leave of a velocity.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "model/model.hpp"
#include "model/step.hpp"

namespace kerf {

class Constraints {
 public:
  /// Finds out which nodes are constrained; to be called again whenever nodes are renumbered. Local.
  void resolve(const Model& model);
  /// Sets velocities at time zero. Collective only in that all ranks do it to all copies.
  void initialise(Model& model) const;
  /// One error line for every boundary condition with nodes that cannot start as they stand. Collective.
  std::vector<std::string> complaints(const Model& model) const;

  struct Constrained {
    std::int32_t node = 0;
    std::uint64_t always = 0;  // conditions that are asked in every step, a bit per condition of the input
  };
  /// Nodes with conditions that are asked in every step, in ascending order.
  const std::vector<Constrained>& constrained() const { return constrained_; }
  /// Whether the model has no condition at all.
  bool none() const { return near_.empty(); }
  /// Conditions of a node that are asked in every step. Pre: the model has conditions.
  std::uint64_t always(int node) const { return always_[node]; }
  /// Conditions of a node that are asked only if its free flight ends in their region. Pre: the model has conditions.
  std::uint64_t near(int node) const { return near_[node]; }
  /// Whether a flight of a node that ends at `to` asks a condition of the second kind.
  bool ends_in_region(int node, const std::vector<HalfSpace>& planes, Vec3 to) const {
    for (std::size_t b = 0; b < planes.size(); ++b)
      if ((near_[node] >> b & 1u) != 0 && dot(planes[b].normal, to) < planes[b].offset) return true;
    return false;
  }
  /// The region of every condition at the end of a step.
  static std::vector<HalfSpace> regions(const Model& model, const Step& step);
  /// The velocity that the conditions leave of a free flight from the node's present position [m/s]. Conditions with a
  /// region are asked only if the flight, as changed by the conditions before them, ends there.
  /// `after_each`, where given, receives the velocity that each condition leaves, in the order of the input.
  Vec3 constrain(const Model& model, int node, std::uint64_t always, const Step& step,
                 const std::vector<HalfSpace>& planes, Vec3 old_velocity, Vec3 velocity,
                 Vec3* after_each = nullptr) const;

 private:
  std::vector<Constrained> constrained_;  // by node
  std::vector<std::uint64_t> always_, near_;  // per node; empty where there is no condition at all
};

}  // namespace kerf
