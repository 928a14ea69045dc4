// Resolves names of parts and sets, as they stand in the input, to nodes.
#pragma once

#include <array>
#include <cstdint>
#include <string>
#include <vector>

#include "model/model.hpp"

namespace kerf {

/// The nodes of some parts and sets; of the whole model where no name is given. A node that parts share belongs to the
/// group if one of its parts does. Valid as long as the model's table of memberships stays.
class NodeGroup {
 public:
  NodeGroup(const Model& model, const std::vector<std::string>& names);
  bool holds(std::int32_t membership) const { return all_ || nodes_[static_cast<std::size_t>(membership)] != 0; }
  bool holds(const NodeStore& nodes, int i) const { return holds(nodes.membership[i]); }
  /// Whether an element belongs to the group: its part does, or all its nodes are in one of the sets.
  bool holds_element(const NodeStore& nodes, const PartStore& store, int slot) const;
  /// Whether a facet belongs to the group, given the memberships of its four nodes: its part does, or all four nodes
  /// are in one of the sets.
  bool holds_facet(std::int32_t part, const std::array<std::int32_t, 4>& memberships) const {
    return all_ || parts_[static_cast<std::size_t>(part)] != 0 || have_common_set(memberships);
  }
  /// Whether any node of a part, as its mesh made it, belongs to the group by the part's name or by a set.
  bool reaches(std::int32_t part) const { return all_ || reached_[static_cast<std::size_t>(part)] != 0; }

 private:
  bool have_common_set(const std::array<std::int32_t, 4>& memberships) const;

  bool all_ = false;
  std::vector<char> parts_, reached_;  // per part
  std::vector<char> nodes_;  // per combination of the model's table
  std::vector<std::vector<std::int32_t>> sets_;  // per combination: sets of the group, in ascending order
};

}  // namespace kerf
