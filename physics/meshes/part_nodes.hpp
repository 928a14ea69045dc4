// The nodes of a part of a mesh, and which of them a node of the whole mesh is. The memory goes with the part: the
// whole mesh may have thousands of parts.
#pragma once

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <vector>

namespace kerf {

class PartNodes {
 public:
  PartNodes() = default;
  /// Pre: `of_part` names at least one of the cells.
  PartNodes(const std::vector<std::array<std::int32_t, 8>>& cells, const std::vector<std::int32_t>& of_part) {
    std::int64_t high = -1;
    low_ = std::numeric_limits<std::int32_t>::max();
    each(cells, of_part, [&](std::int32_t node) {
      low_ = std::min<std::int64_t>(low_, node);
      high = std::max<std::int64_t>(high, node);
    });
    const std::int64_t n_corners = 8 * static_cast<std::int64_t>(of_part.size()), range = high - low_ + 1;
    if (range <= 64 * n_corners)
      mark(cells, of_part, range);
    else
      sort(cells, of_part);
    make_buckets(range);
  }

  std::size_t size() const { return nodes_.size(); }
  /// The number in the whole mesh of node i of the part; ascends with i.
  std::int32_t whole(std::size_t i) const { return nodes_[i]; }
  /// The number in the part. Pre: the node belongs to the part.
  std::int32_t local(std::int32_t node) const {
    const auto bucket = static_cast<std::size_t>((node - low_) >> shift_);
    const std::int32_t first = first_[bucket];
    if (shift_ == 0) return first;
    const auto begin = nodes_.begin();
    return static_cast<std::int32_t>(std::lower_bound(begin + first, begin + first_[bucket + 1], node) - begin);
  }

 private:
  template <class Visit>
  static void each(const std::vector<std::array<std::int32_t, 8>>& cells, const std::vector<std::int32_t>& of_part,
                   const Visit& visit) {
    for (const std::int32_t c : of_part)
      for (const std::int32_t node : cells[static_cast<std::size_t>(c)]) visit(node);
  }

  /// One bit for each number between the least and the greatest.
  void mark(const std::vector<std::array<std::int32_t, 8>>& cells, const std::vector<std::int32_t>& of_part,
            std::int64_t range) {
    std::vector<bool> is_used(static_cast<std::size_t>(range));
    each(cells, of_part, [&](std::int32_t node) { is_used[static_cast<std::size_t>(node - low_)] = true; });
    nodes_.reserve(static_cast<std::size_t>(std::count(is_used.begin(), is_used.end(), true)));
    for (std::int64_t k = 0; k < range; ++k)
      if (is_used[static_cast<std::size_t>(k)]) nodes_.push_back(static_cast<std::int32_t>(low_ + k));
  }

  /// For a few nodes far apart.
  void sort(const std::vector<std::array<std::int32_t, 8>>& cells, const std::vector<std::int32_t>& of_part) {
    each(cells, of_part, [&](std::int32_t node) { nodes_.push_back(node); });
    std::sort(nodes_.begin(), nodes_.end());
    nodes_.erase(std::unique(nodes_.begin(), nodes_.end()), nodes_.end());
    nodes_.shrink_to_fit();
  }

  /// Buckets of 2^shift numbers, at most eight for each node: they take 32 bytes, and a record of a node takes more. So
  /// a bucket has one number, and nothing is searched, where an eighth of the mesh or more is the part.
  void make_buckets(std::int64_t range) {
    while ((range >> shift_) > 8 * static_cast<std::int64_t>(nodes_.size())) ++shift_;
    first_.assign(static_cast<std::size_t>((range - 1) >> shift_) + 2, 0);
    for (const std::int32_t node : nodes_) ++first_[static_cast<std::size_t>((node - low_) >> shift_) + 1];
    for (std::size_t b = 1; b < first_.size(); ++b) first_[b] += first_[b - 1];
  }

  std::int64_t low_ = 0;  // least number in the whole mesh
  int shift_ = 0;
  std::vector<std::int32_t> nodes_;  // numbers in the whole mesh, ascending
  std::vector<std::int32_t> first_;  // per bucket and one more: the first of its nodes
};

}  // namespace kerf
