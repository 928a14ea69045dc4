// A tree of boxes over facets that are neighbours in the list as a rule, as elements along a space-filling curve are.
#pragma once

#include <bit>
#include <cstdint>
#include <vector>

#ifdef __AVX__
#include <immintrin.h>
#endif

#include "dynamics/box.hpp"

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
    const Answer yes = (low_[0] <= box.high[0]) & (high_[0] >= box.low[0]) & (low_[1] <= box.high[1]) &
                       (high_[1] >= box.low[1]) & (low_[2] <= box.high[2]) & (high_[2] >= box.low[2]);
    for (unsigned left = bits_of(yes); left != 0; left &= left - 1) visit(std::countr_zero(left));
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

/// Eight boxes to a group, eight groups to the next, up to the root; nothing is sorted.
class FacetTree {
 public:
  void add(const Box& box) {
    if (n_ % BoxGroup::size == 0) leaves_.emplace_back();
    leaves_.back().set(n_++ % BoxGroup::size, box);
  }
  /// To be called after all are added, and before anything is asked.
  void finish() {
    levels_.clear();
    for (const std::vector<BoxGroup>* below = &leaves_; below->size() > 1; below = &levels_.back()) {
      std::vector<BoxGroup> above((below->size() + BoxGroup::size - 1) / BoxGroup::size);
      for (std::size_t g = 0; g < below->size(); ++g)
        above[g / BoxGroup::size].set(static_cast<int>(g % BoxGroup::size), (*below)[g].hull());
      levels_.push_back(std::move(above));
    }
  }
  /// Calls `visit(branch)` for all branches whose common box meets a box: for what is to be asked for several boxes
  /// that are close together. A branch is a group of groups of facets.
  template <class Visit>
  void each_branch(const Box& box, const Visit& visit) const {
    if (!leaves_.empty()) descend(static_cast<int>(levels_.size()) - 1, 0, 0, box, visit);
  }
  /// Calls `visit(number)` for all facets of a branch whose boxes meet a box.
  template <class Visit>
  void each_in(std::size_t branch, const Box& box, const Visit& visit) const {
    if (levels_.empty()) return each_in_group(branch, box, visit);
    levels_[0][branch].each_meeting(
        box, [&](int l) { each_in_group(branch * BoxGroup::size + static_cast<std::size_t>(l), box, visit); });
  }
  template <class Visit>
  void each(const Box& box, const Visit& visit) const {
    if (!leaves_.empty())
      descend(static_cast<int>(levels_.size()) - 1, -1, 0, box,
              [&](std::size_t group) { each_in_group(group, box, visit); });
  }

 private:
  template <class Visit>
  void each_in_group(std::size_t group, const Box& box, const Visit& visit) const {
    leaves_[group].each_meeting(box, [&](int l) { visit(group * BoxGroup::size + static_cast<std::size_t>(l)); });
  }
  /// Down to the groups of a level; -1 are the leaves, and what there is where there is one leaf only.
  template <class Visit>
  void descend(int level, int last, std::size_t group, const Box& box, const Visit& visit) const {
    if (level <= last) return visit(group);
    levels_[static_cast<std::size_t>(level)][group].each_meeting(box, [&](int l) {
      descend(level - 1, last, group * BoxGroup::size + static_cast<std::size_t>(l), box, visit);
    });
  }

  int n_ = 0;
  std::vector<BoxGroup> leaves_;
  std::vector<std::vector<BoxGroup>> levels_;  // the last one is a single group, the root
};

}  // namespace kerf
