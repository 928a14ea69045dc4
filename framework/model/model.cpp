// Look-up of local nodes by global id, and of parts by ids of their nodes and elements.
#include "model/model.hpp"

#include <algorithm>
#include <numeric>

namespace kerf {

void Model::index_nodes() {
  ++node_arrangement_;
  by_id_.resize(nodes.id.size());
  std::iota(by_id_.begin(), by_id_.end(), 0);
  std::sort(by_id_.begin(), by_id_.end(), [&](std::int32_t a, std::int32_t b) { return nodes.id[a] < nodes.id[b]; });
}

std::int32_t Model::local_node(std::int64_t id) const {
  const auto it = std::lower_bound(by_id_.begin(), by_id_.end(), id,
                                   [&](std::int32_t i, std::int64_t wanted) { return nodes.id[i] < wanted; });
  return it != by_id_.end() && nodes.id[*it] == id ? *it : -1;
}

std::int32_t Model::part_of_node(std::int64_t id) const {
  const auto at = std::upper_bound(parts.begin(), parts.end(), id,
                                   [](std::int64_t wanted, const PartModel& p) { return wanted < p.first_own_node; });
  return static_cast<std::int32_t>(at - parts.begin()) - 1;
}

std::int32_t Model::part_of_element(std::int64_t id) const {
  const auto at = std::upper_bound(parts.begin(), parts.end(), id,
                                   [](std::int64_t wanted, const PartModel& p) { return wanted < p.first_element; });
  return static_cast<std::int32_t>(at - parts.begin()) - 1;
}

bool Model::belongs_to(int node, std::int32_t part) const {
  const std::vector<std::int32_t>& all = parts_of(node);
  return std::binary_search(all.begin(), all.end(), part);
}

}  // namespace kerf
