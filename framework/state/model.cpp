// Look-up of local nodes by global id.
#include "state/model.hpp"

#include <algorithm>

namespace kerf {

void Model::index_nodes() {
  by_id_.clear();
  by_id_.reserve(nodes.id.size());
  for (int i = 0; i < nodes.n(); ++i) by_id_.emplace_back(nodes.id[i], i);
  std::sort(by_id_.begin(), by_id_.end());
}

std::int32_t Model::local_node(std::int64_t id) const {
  const auto it = std::lower_bound(by_id_.begin(), by_id_.end(), std::make_pair(id, std::int32_t{-1}));
  return it != by_id_.end() && it->first == id ? it->second : -1;
}

}  // namespace kerf
