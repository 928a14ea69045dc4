// Nodes that parts have in common because their meshes come from one file.
#pragma once

#include <cstdint>
#include <utility>
#include <vector>

namespace kerf {

struct Model;

/// One whole mesh that several parts are taken from.
struct CommonNodes {
  std::vector<std::int32_t> parts;  // ascending
  std::vector<std::int64_t> first;  // per node of the whole mesh: its lowest id in the parts, or -1
  std::vector<char> is_shared;  // per node of the whole mesh: whether more than one part has it
};

/// All whole meshes that two parts or more are taken from. Local.
std::vector<CommonNodes> common_nodes(const Model& model);

/// Pairs of parts that share a node of a whole mesh, the first of them the lower; each once. Local.
std::vector<std::pair<std::int32_t, std::int32_t>> parts_with_common_nodes(const Model& model);

}  // namespace kerf
