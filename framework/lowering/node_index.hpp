// Finds the nodes of a mesh by the numbers that its file gives them.
#pragma once

#include <algorithm>
#include <cstdint>
#include <utility>
#include <vector>

#include "kerf/file_mesh.hpp"

namespace kerf::lowering {

class NodeIndex {
 public:
  explicit NodeIndex(const FileMesh& mesh) {
    for (std::size_t k = 0; k < mesh.node_labels.size(); ++k)
      sorted_.emplace_back(mesh.node_labels[k], static_cast<std::int32_t>(k));
    std::sort(sorted_.begin(), sorted_.end());
  }
  /// -1 where there is no such node.
  std::int32_t operator()(std::int64_t label) const {
    const auto at = std::lower_bound(sorted_.begin(), sorted_.end(), std::pair{label, std::int32_t{-1}});
    return at != sorted_.end() && at->first == label ? at->second : -1;
  }

 private:
  std::vector<std::pair<std::int64_t, std::int32_t>> sorted_;  // label and node, ascending
};

}  // namespace kerf::lowering
