// Look-up of names in the input's parts and sets.
#include "model/node_group.hpp"

#include <algorithm>

#include "core/assert.hpp"

namespace kerf {

NodeGroup::NodeGroup(const Model& model, const std::vector<std::string>& names) : all_(names.empty()) {
  if (all_) return;
  parts_.assign(model.parts.size(), 0);
  std::vector<char> sets(model.set_names.size(), 0);
  for (const std::string& name : names) {
    bool found = false;
    for (std::size_t p = 0; p < model.parts.size(); ++p)
      if (model.parts[p].input->name == name) {
        parts_[p] = 1;
        found = true;
      }
    for (std::size_t s = 0; s < model.set_names.size(); ++s)
      if (model.set_names[s] == name) {
        sets[s] = 1;
        found = true;
      }
    KERF_ASSERT(found, "names of parts and sets are checked when the input is read");
  }
  reached_ = parts_;
  for (const Membership& m : model.memberships.all()) {
    std::vector<std::int32_t> of_group;
    for (const std::int32_t s : m.sets)
      if (sets[static_cast<std::size_t>(s)] != 0) of_group.push_back(s);
    const bool by_part = std::any_of(m.parts.begin(), m.parts.end(),
                                     [&](std::int32_t p) { return parts_[static_cast<std::size_t>(p)] != 0; });
    if (!of_group.empty())
      for (const std::int32_t p : m.parts) reached_[static_cast<std::size_t>(p)] = 1;
    nodes_.push_back(by_part || !of_group.empty() ? 1 : 0);
    sets_.push_back(std::move(of_group));
  }
}

bool NodeGroup::holds_element(const NodeStore& nodes, const PartStore& store, int slot) const {
  if (all_ || parts_[static_cast<std::size_t>(store.index())] != 0) return true;
  const auto sets_of = [&](int k) -> const std::vector<std::int32_t>& {
    return sets_[static_cast<std::size_t>(nodes.membership[store.node(slot, k)])];
  };
  return std::any_of(sets_of(0).begin(), sets_of(0).end(), [&](std::int32_t s) {
    for (int k = 1; k < store.n_nodes(); ++k)
      if (!std::binary_search(sets_of(k).begin(), sets_of(k).end(), s)) return false;
    return true;
  });
}

bool NodeGroup::have_common_set(const std::array<std::int32_t, 4>& memberships) const {
  const auto sets_of = [&](std::int32_t m) -> const std::vector<std::int32_t>& {
    return sets_[static_cast<std::size_t>(m)];
  };
  const auto& first = sets_of(memberships[0]);
  return std::any_of(first.begin(), first.end(), [&](std::int32_t s) {
    return std::all_of(memberships.begin() + 1, memberships.end(),
                       [&](std::int32_t m) { return std::binary_search(sets_of(m).begin(), sets_of(m).end(), s); });
  });
}

}  // namespace kerf
