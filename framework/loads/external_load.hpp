// What loads hand to the rest: forces on nodes.
#pragma once

#include <array>
#include <cstdint>
#include <vector>

namespace kerf {

/// Forces of all loads together on owned nodes of this rank in the current step, for their work.
struct ExternalLoad {
  std::vector<std::int32_t> nodes;
  std::vector<std::int64_t> force;  // four per node, in force quanta
};

/// The force of all loads on a node by its id, for restart [force quanta].
struct LoadOnNode {
  std::int64_t id = 0;
  std::array<std::int64_t, 3> force{};
};

}  // namespace kerf
