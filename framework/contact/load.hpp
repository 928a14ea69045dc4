// What contact hands to the rest: forces on nodes.
#pragma once

#include <cstdint>
#include <vector>

namespace kerf {

/// Contact forces on owned nodes of this rank in the current step, for their work.
struct ContactLoad {
  std::vector<std::int32_t> nodes;
  std::vector<std::int64_t> force;  // four per node, in force quanta
  std::vector<std::int64_t> friction;  // the share of friction in it; the same length
};

}  // namespace kerf
