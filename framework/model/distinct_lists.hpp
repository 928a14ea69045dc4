// Numbers for lists of which few are distinct: what a node keeps in place of a list of its own.
#pragma once

#include <cstdint>
#include <map>
#include <vector>

namespace kerf {

/// A list per number; number 0 is the empty list.
class DistinctLists {
 public:
  DistinctLists() { number({}); }
  /// The number of a list, which gets one if it is new.
  std::int32_t number(const std::vector<std::int32_t>& list) {
    const auto [at, fresh] = numbers_.emplace(list, static_cast<std::int32_t>(lists_.size()));
    if (fresh) lists_.push_back(list);
    return at->second;
  }
  const std::vector<std::int32_t>& operator[](std::int32_t number) const {
    return lists_[static_cast<std::size_t>(number)];
  }

 private:
  std::map<std::vector<std::int32_t>, std::int32_t> numbers_;
  std::vector<std::vector<std::int32_t>> lists_;
};

}  // namespace kerf
