// The records of a search, dense numbers of their nodes, and which facets are round them: what the candidate search
// looks things up in.
#pragma once

#include <algorithm>
#include <array>
#include <cstdint>
#include <span>
#include <utility>
#include <vector>

#include "contact/records.hpp"

namespace kerf {

/// Dense numbers of nodes. Where the records come from one rank alone, their local numbers serve; otherwise an
/// open-addressing map numbers ids, which are not negative, in order of arrival, and a table remembers the numbers of
/// nodes with a local number.
class Numbering {
 public:
  Numbering(std::size_t expected, std::size_t n_local) : n_local_(static_cast<std::int32_t>(n_local)) {
    if (n_local == 0) resize(expected);
  }
  /// The number of a node; `local` is its local number on this rank, or -1.
  std::int32_t number(std::int64_t id, std::int32_t local) {
    if (n_local_ > 0) return local;
    if (local < 0) return number(id);
    if (static_cast<std::size_t>(local) >= of_local_.size())
      of_local_.resize(2 * static_cast<std::size_t>(local) + 64, -1);
    std::int32_t& known = of_local_[local];
    if (known < 0) known = number(id);
    return known;
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
  std::int32_t number(std::int64_t id) {
    if (2 * static_cast<std::size_t>(n_) >= slots_.size()) resize(2 * static_cast<std::size_t>(n_));
    Slot& at = slot(id);
    if (at.id != id) at = {id, n_++};
    return at.number;
  }
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
  std::vector<std::int32_t> of_local_;  // by local number: the number, or -1
};

/// Node numbers of a facet's corners, then of the other four nodes of its element.
using Corners = std::array<std::int32_t, 8>;

/// Of a facet: a triangle repeats its last corner.
inline int n_corners(const Corners& c) { return c[2] == c[3] ? 3 : 4; }

/// Facets around every node of the surface, sorted by id, as they come and go.
class Around {
 public:
  void build(const std::vector<Corners>& corners, const std::vector<std::int64_t>& ids, std::size_t n_nodes) {
    std::vector<std::int32_t> first(n_nodes + 1, 0);
    for (const Corners& c : corners)
      for (int k = 0; k < n_corners(c); ++k) ++first[c[k] + 1];
    for (std::size_t n = 0; n < n_nodes; ++n) first[n + 1] += first[n];
    rows_.resize(n_nodes);
    for (std::size_t n = 0; n < n_nodes; ++n) rows_[n] = {first[n], first[n]};
    facet_.resize(4 * corners.size());
    // One after another into their place: there are four facets round most nodes.
    for (std::size_t f = 0; f < corners.size(); ++f)
      for (int k = 0; k < n_corners(corners[f]); ++k) {
        Row& row = rows_[corners[f][k]];
        std::int32_t at = row.end++;
        for (; at > row.begin && ids[facet_[at - 1]] > ids[f]; --at) facet_[at] = facet_[at - 1];
        facet_[at] = static_cast<std::int32_t>(f);
      }
  }
  std::span<const std::int32_t> of(std::int32_t node) const {
    if (node >= static_cast<std::int32_t>(rows_.size())) return {};
    const Row& row = rows_[node];
    if (row.begin == elsewhere) return changed_[row.end];
    return {facet_.data() + row.begin, static_cast<std::size_t>(row.end - row.begin)};
  }
  void add(std::int32_t node, std::int32_t facet, const std::vector<std::int64_t>& ids) {
    auto& now = list(node);
    now.insert(std::upper_bound(now.begin(), now.end(), facet, [&](auto a, auto b) { return ids[a] < ids[b]; }), facet);
  }
  void remove(std::int32_t node, std::int32_t facet) { std::erase(list(node), facet); }

 private:
  /// Part of facet_, or, where it begins at `elsewhere`, its end is a place in changed_.
  struct Row {
    std::int32_t begin = 0, end = 0;
  };
  static constexpr std::int32_t elsewhere = -1;

  std::vector<std::int32_t>& list(std::int32_t node) {
    if (node >= static_cast<std::int32_t>(rows_.size())) rows_.resize(static_cast<std::size_t>(node) + 1);
    if (rows_[node].begin != elsewhere) {
      const auto now = of(node);
      changed_.emplace_back(now.begin(), now.end());
      rows_[node] = {elsewhere, static_cast<std::int32_t>(changed_.size()) - 1};
    }
    return changed_[rows_[node].end];
  }
  std::vector<std::int32_t> facet_;
  std::vector<Row> rows_;  // per node
  std::vector<std::vector<std::int32_t>> changed_;
};

/// What a search was given and has been given since, and how it refers to it. Facets keep their numbers when they die.
struct SearchRecords {
  std::vector<ContactNodeRecord> slaves;
  std::vector<ContactFacetRecord> facets;
  Numbering numbering;  // of nodes
  std::vector<std::int64_t> ids;  // of the facets
  std::vector<Corners> corners;
  std::vector<std::int32_t> number;  // node number of each slave
  Around around;
  std::vector<std::vector<std::int32_t>> found;  // per slave: facets, sorted by id; dead ones are left in

  SearchRecords(std::vector<ContactNodeRecord> s, std::vector<ContactFacetRecord> f, std::size_t n_local)
      : slaves(std::move(s)), facets(std::move(f)), numbering(slaves.size() + 2 * facets.size(), n_local) {}
};

}  // namespace kerf
