// A tree of boxes over a list whose neighbours are usually close in space, for example elements along a space-filling
// curve.
#pragma once

#include <algorithm>
#include <bit>
#include <cstdint>
#include <type_traits>
#include <vector>

#ifdef __AVX__
#include <immintrin.h>
#endif

#include "contact/box.hpp"

namespace kerf {

/// Eight boxes side by side, compared with another one at once; empty where unused.
class BoxGroup {
 public:
  static constexpr int size = 8;

  void set(int lane, const Box& box) {
    for (int d = 0; d < 3; ++d) {
      low_[d][lane] = box.low[d];
      high_[d][lane] = box.high[d];
    }
  }
  void include(int lane, const Box& box) {
    for (int d = 0; d < 3; ++d) {
      low_[d][lane] = std::min(low_[d][lane], box.low[d]);
      high_[d][lane] = std::max(high_[d][lane], box.high[d]);
    }
  }
  Box box(int lane) const {
    Box one;
    for (int d = 0; d < 3; ++d) {
      one.low[d] = low_[d][lane];
      one.high[d] = high_[d][lane];
    }
    return one;
  }
  /// The smallest box round all of them.
  Box hull() const {
    Box all;
    for (int l = 0; l < size; ++l)
      for (int d = 0; d < 3; ++d) {
        all.low[d] = std::min(all.low[d], low_[d][l]);
        all.high[d] = std::max(all.high[d], high_[d][l]);
      }
    return all;
  }
  /// Calls `visit(lane)` for all that meet a box.
  template <class Visit>
  void each_meeting(const Box& box, const Visit& visit) const {
    for (unsigned left = meeting(box); left != 0; left &= left - 1) visit(std::countr_zero(left));
  }
  /// Bit l is set where box l meets another one.
  [[gnu::always_inline]] unsigned meeting(const Box& box) const {
    return bits_of((low_[0] <= box.high[0]) & (high_[0] >= box.low[0]) & (low_[1] <= box.high[1]) &
                   (high_[1] >= box.low[1]) & (low_[2] <= box.high[2]) & (high_[2] >= box.low[2]));
  }

 private:
  typedef float Floats __attribute__((vector_size(32)));
  typedef std::int32_t Answer __attribute__((vector_size(32)));

  static unsigned bits_of(Answer yes) {
#ifdef __AVX__
    return static_cast<unsigned>(_mm256_movemask_ps(reinterpret_cast<__m256>(yes)));
#else
    unsigned bits = 0;
    for (int l = 0; l < size; ++l) bits |= (yes[l] != 0 ? 1u : 0u) << l;
    return bits;
#endif
  }
  static constexpr float far = Box::far;
  static constexpr Floats all_far = {far, far, far, far, far, far, far, far};
  Floats low_[3] = {all_far, all_far, all_far}, high_[3] = {-all_far, -all_far, -all_far};
};

/// Eight boxes to a group, eight groups to the next, up to the root; nothing is sorted. Boxes have numbers, those that
/// were never set are empty.
class BoxTree {
 public:
  void add(const Box& box) { set(n_, box); }
  /// Sets one box; `finish` is to be called after all are set, and before anything is asked.
  void set(std::size_t number, const Box& box) {
    n_ = std::max(n_, number + 1);
    while (leaves_.size() * BoxGroup::size < n_) leaves_.emplace_back();
    leaves_[number / BoxGroup::size].set(static_cast<int>(number % BoxGroup::size), box);
  }
  void finish() {
    levels_.clear();
    for (const std::vector<BoxGroup>* below = &leaves_; below->size() > 1; below = &levels_.back())
      levels_.push_back(hulls_of(*below));
  }
  /// Sets one box, after which questions may be asked at once. Boxes round many only grow: as long as few are set like
  /// this, it costs little.
  void put(std::size_t number, const Box& box) {
    set(number, box);
    std::size_t group = number / BoxGroup::size;
    for (std::size_t level = 0, n_below = leaves_.size(); n_below > 1; n_below = levels_[level++].size()) {
      if (level == levels_.size()) {
        levels_.push_back(hulls_of(level == 0 ? leaves_ : levels_[level - 1]));
      } else {
        while (levels_[level].size() * BoxGroup::size < n_below) levels_[level].emplace_back();
        levels_[level][group / BoxGroup::size].include(static_cast<int>(group % BoxGroup::size), box);
      }
      group /= BoxGroup::size;
    }
  }
  /// Calls `visit(number)`, or `visit(number, its box)`, for all whose boxes meet a box.
  template <class Visit>
  void each(const Box& box, const Visit& visit) const {
    if (!leaves_.empty()) descend(static_cast<int>(levels_.size()) - 1, 0, box, visit);
  }
  /// Whether any meets a box.
  bool meets(const Box& box) const {
    return !leaves_.empty() && meets_below(static_cast<int>(levels_.size()) - 1, 0, box);
  }

 private:
  static std::vector<BoxGroup> hulls_of(const std::vector<BoxGroup>& below) {
    std::vector<BoxGroup> above((below.size() + BoxGroup::size - 1) / BoxGroup::size);
    for (std::size_t g = 0; g < below.size(); ++g)
      above[g / BoxGroup::size].set(static_cast<int>(g % BoxGroup::size), below[g].hull());
    return above;
  }
  template <class Visit>
  void each_in_group(std::size_t group, const Box& box, const Visit& visit) const {
    leaves_[group].each_meeting(box, [&](int l) {
      const std::size_t number = group * BoxGroup::size + static_cast<std::size_t>(l);
      if constexpr (std::is_invocable_v<Visit, std::size_t, Box>)
        visit(number, leaves_[group].box(l));
      else
        visit(number);
    });
  }
  /// Down to the leaves.
  template <class Visit>
  void descend(int level, std::size_t group, const Box& box, const Visit& visit) const {
    if (level < 0) return each_in_group(group, box, visit);
    levels_[static_cast<std::size_t>(level)][group].each_meeting(
        box, [&](int l) { descend(level - 1, group * BoxGroup::size + static_cast<std::size_t>(l), box, visit); });
  }
  bool meets_below(int level, std::size_t group, const Box& box) const {
    if (level < 0) return leaves_[group].meeting(box) != 0;
    for (unsigned left = levels_[static_cast<std::size_t>(level)][group].meeting(box); left != 0; left &= left - 1)
      if (meets_below(level - 1, group * BoxGroup::size + static_cast<std::size_t>(std::countr_zero(left)), box))
        return true;
    return false;
  }

  std::size_t n_ = 0;
  std::vector<BoxGroup> leaves_;
  std::vector<std::vector<BoxGroup>> levels_;  // the last one is a single group, the root
};

}  // namespace kerf
