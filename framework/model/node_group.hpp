// Resolves names of parts and sets, as they stand in the input, to nodes.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "model/model.hpp"

namespace kerf {

/// The nodes of some parts and sets; of the whole model where no name is given.
class NodeGroup {
 public:
  NodeGroup(const Model& model, const std::vector<std::string>& names);
  bool holds(std::int32_t part, std::uint64_t sets) const {
    return all_ || (parts_ >> part & 1u) != 0 || (sets_ & sets) != 0;
  }
  bool holds(const NodeStore& nodes, int i) const { return holds(nodes.part[i], nodes.sets[i]); }
  /// Whether an element belongs to the group: its part does, or all its nodes are in one of the sets.
  bool holds_element(const NodeStore& nodes, const PartStore& store, int slot) const {
    if (all_ || (parts_ >> store.index() & 1u) != 0) return true;
    std::uint64_t common = sets_;
    for (int k = 0; k < store.n_nodes(); ++k) common &= nodes.sets[store.node(slot, k)];
    return common != 0;
  }
  /// Whether a facet belongs to the group: its part does, or all four nodes are in one of the sets.
  bool holds_facet(std::int32_t part, const std::uint64_t (&node_sets)[4]) const {
    return all_ || (parts_ >> part & 1u) != 0 ||
           (sets_ & node_sets[0] & node_sets[1] & node_sets[2] & node_sets[3]) != 0;
  }

 private:
  bool all_ = false;
  std::uint64_t parts_ = 0, sets_ = 0;
};

}  // namespace kerf
