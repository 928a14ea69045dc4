// What contact hands to the rest: forces on nodes.
#pragma once

#include <array>
#include <cstdint>
#include <unordered_map>
#include <vector>

namespace kerf {

struct Model;

/// Contact forces on owned nodes of this rank in the current step, for their work.
struct ContactLoad {
  std::vector<std::int32_t> nodes;
  std::vector<std::int64_t> force;  // four per node, in force quanta
  std::vector<std::int64_t> friction;  // the share of friction in it; the same length
};

/// Force and friction in force quanta, by node id.
using ForceByNode = std::unordered_map<std::int64_t, std::array<std::int64_t, 6>>;

/// The forces on nodes that this rank owns, of any superset of them. Local.
ContactLoad load_on_owned(const Model& model, const ForceByNode& forces);

}  // namespace kerf
