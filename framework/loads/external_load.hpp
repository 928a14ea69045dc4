// What loads hand to the rest, and what may add to them: forces on nodes.
#pragma once

#include <array>
#include <cstdint>
#include <functional>
#include <string>
#include <vector>

#include "kerf/math.hpp"
#include "model/step.hpp"

namespace kerf {

/// Forces of all loads together on owned nodes of this rank in the current step, for their work.
struct ExternalLoad {
  std::vector<std::int32_t> nodes;
  std::vector<std::int64_t> force;  // four per node, in force quanta
};

/// Who adds a force, for messages: "the load gravity (case.yaml:3:5)".
struct ForceActor {
  std::string name, origin;
};

/// Adds to the force of an owned node of this rank [N].
using AddForce = std::function<void(std::int32_t node, Vec3 newton, const ForceActor& actor)>;

/// Whatever adds forces that are no loads of the input.
class ForceSource {
 public:
  virtual ~ForceSource() = default;
  /// Whether it adds any in this run; the same on all ranks.
  virtual bool adds_forces() const = 0;
  /// Calls `add` for the forces of this rank. Throws PhysicsError on all ranks where it cannot go on. Collective.
  virtual void add_forces(const Step& step, const AddForce& add) = 0;
};

/// The force of all loads on a node by its id, for restart [force quanta].
struct LoadOnNode {
  std::int64_t id = 0;
  std::array<std::int64_t, 3> force{};
};

}  // namespace kerf
