// From the number that a file gives to a node or an element to its place in the order of the file.
#pragma once

#include <algorithm>
#include <cstdint>
#include <limits>
#include <span>
#include <utility>
#include <vector>

namespace kerf {

/// Finds the index of a label; a table where labels lie close together, a search where they are far apart.
class LabelMap {
 public:
  LabelMap() = default;
  explicit LabelMap(std::span<const std::int64_t> labels) {
    if (labels.empty()) return;
    const auto [low, high] = std::minmax_element(labels.begin(), labels.end());
    low_ = *low;
    const std::uint64_t width = static_cast<std::uint64_t>(*high) - static_cast<std::uint64_t>(*low);
    if (width < 4 * labels.size() + 1000)
      fill_table(labels, width + 1);
    else
      fill_pairs(labels);
  }

  /// The index of `label`, the first one where the label occurs twice; -1 where it does not occur.
  std::int32_t find(std::int64_t label) const {
    if (!table_.empty()) {
      const std::uint64_t at = static_cast<std::uint64_t>(label) - static_cast<std::uint64_t>(low_);
      return at < table_.size() ? table_[at] : -1;
    }
    const auto found = std::lower_bound(pairs_.begin(), pairs_.end(), std::pair{label, std::int32_t{0}});
    return found != pairs_.end() && found->first == label ? found->second : -1;
  }
  /// Indices whose label an earlier index has, ascending.
  const std::vector<std::int32_t>& repeated() const { return repeated_; }

 private:
  void fill_table(std::span<const std::int64_t> labels, std::size_t width) {
    table_.assign(width, -1);
    for (std::size_t i = 0; i < labels.size(); ++i) {
      std::int32_t& entry = table_[static_cast<std::size_t>(labels[i] - low_)];
      if (entry < 0)
        entry = static_cast<std::int32_t>(i);
      else
        repeated_.push_back(static_cast<std::int32_t>(i));
    }
  }
  void fill_pairs(std::span<const std::int64_t> labels) {
    pairs_.reserve(labels.size());
    for (std::size_t i = 0; i < labels.size(); ++i) pairs_.emplace_back(labels[i], static_cast<std::int32_t>(i));
    std::sort(pairs_.begin(), pairs_.end());
    for (std::size_t i = 1; i < pairs_.size(); ++i)
      if (pairs_[i].first == pairs_[i - 1].first) repeated_.push_back(pairs_[i].second);
    std::sort(repeated_.begin(), repeated_.end());
  }

  std::int64_t low_ = 0;
  std::vector<std::int32_t> table_;
  std::vector<std::pair<std::int64_t, std::int32_t>> pairs_;
  std::vector<std::int32_t> repeated_;
};

}  // namespace kerf
