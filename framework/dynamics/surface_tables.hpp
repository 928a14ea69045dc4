// Dense numbers of nodes, and which facets are round them: what the candidate search looks things up in.
#pragma once

#include <algorithm>
#include <array>
#include <cstdint>
#include <span>
#include <unordered_map>
#include <vector>

namespace kerf {

/// Dense numbers of nodes. Where the records come from one rank alone, their local numbers serve; otherwise an
/// open-addressing map numbers ids, which are not negative, in order of arrival.
class Numbering {
 public:
  Numbering(std::size_t expected, std::size_t n_local) : n_local_(static_cast<std::int32_t>(n_local)) {
    if (n_local == 0) resize(expected);
  }
  std::int32_t number(std::int64_t id, std::int32_t local) {
    if (n_local_ > 0) return local;
    if (2 * static_cast<std::size_t>(n_) >= slots_.size()) resize(2 * static_cast<std::size_t>(n_));
    Slot& at = slot(id);
    if (at.id != id) at = {id, n_++};
    return at.number;
  }
  /// The number of an id that has one, or `otherwise`.
  std::int32_t find(std::int64_t id, std::int32_t otherwise) {
    const Slot& at = slot(id);
    return at.id == id ? at.number : otherwise;
  }
  std::size_t size() const { return static_cast<std::size_t>(n_local_ > 0 ? n_local_ : n_); }

 private:
  struct Slot {
    std::int64_t id = -1;
    std::int32_t number = -1;
  };
  void resize(std::size_t expected) {
    std::size_t size = 16;
    while (size < 3 * expected) size *= 2;
    std::vector<Slot> old(size);
    old.swap(slots_);
    for (const Slot& s : old)
      if (s.id >= 0) slot(s.id) = s;
  }
  Slot& slot(std::int64_t id) {
    const std::size_t mask = slots_.size() - 1;
    std::size_t at = static_cast<std::size_t>(static_cast<std::uint64_t>(id) * 0x9e3779b97f4a7c15ULL >> 20) & mask;
    while (slots_[at].id != -1 && slots_[at].id != id) at = (at + 1) & mask;
    return slots_[at];
  }
  std::int32_t n_local_ = 0, n_ = 0;
  std::vector<Slot> slots_;
};

/// Node numbers of a facet's corners, then of the other four nodes of its element.
using Corners = std::array<std::int32_t, 8>;

/// Facets around every node of the surface, sorted by id, as they come and go.
class Around {
 public:
  void build(const std::vector<Corners>& corners, const std::vector<std::int64_t>& ids, std::size_t n_nodes) {
    first_.assign(n_nodes + 1, 0);
    for (const Corners& c : corners)
      for (int k = 0; k < 4; ++k) ++first_[c[k] + 1];
    for (std::size_t n = 0; n < n_nodes; ++n) first_[n + 1] += first_[n];
    facet_.resize(4 * corners.size());
    // One after another into their place: there are four facets round most nodes.
    std::vector<std::int32_t> end(first_.begin(), first_.end() - 1);
    for (std::size_t f = 0; f < corners.size(); ++f)
      for (int k = 0; k < 4; ++k) {
        const std::int32_t n = corners[f][k];
        std::int32_t at = end[n]++;
        for (; at > first_[n] && ids[facet_[at - 1]] > ids[f]; --at) facet_[at] = facet_[at - 1];
        facet_[at] = static_cast<std::int32_t>(f);
      }
  }
  std::span<const std::int32_t> of(std::int32_t node) const {
    if (!changed_.empty()) {
      const auto it = changed_.find(node);
      if (it != changed_.end()) return it->second;
    }
    if (node + 1 >= static_cast<std::int32_t>(first_.size())) return {};
    return {facet_.data() + first_[node], static_cast<std::size_t>(first_[node + 1] - first_[node])};
  }
  void add(std::int32_t node, std::int32_t facet, const std::vector<std::int64_t>& ids) {
    auto& now = list(node);
    now.insert(std::upper_bound(now.begin(), now.end(), facet, [&](auto a, auto b) { return ids[a] < ids[b]; }), facet);
  }
  void remove(std::int32_t node, std::int32_t facet) { std::erase(list(node), facet); }

 private:
  std::vector<std::int32_t>& list(std::int32_t node) {
    const auto it = changed_.find(node);
    if (it != changed_.end()) return it->second;
    const auto now = of(node);
    return changed_[node] = std::vector<std::int32_t>(now.begin(), now.end());
  }
  std::vector<std::int32_t> first_, facet_;
  std::unordered_map<std::int32_t, std::vector<std::int32_t>> changed_;
};

}  // namespace kerf
