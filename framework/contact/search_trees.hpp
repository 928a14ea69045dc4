// Where the facets and slaves of a candidate search are: trees of their boxes, part by part, and clusters of slaves.
#pragma once

#include <algorithm>
#include <bit>
#include <cstdint>
#include <vector>

#include "contact/box_tree.hpp"
#include "contact/records.hpp"

namespace kerf {

/// Trees of the boxes that count for pairs with other parts, and of those that count for pairs within the part; the
/// latter has none where parts do not touch themselves.
struct TreePair {
  BoxTree others, own;

  void set(std::size_t place, const Box& box, const Box* own_box) {
    others.set(place, box);
    if (own_box != nullptr) own.set(place, *own_box);
  }
  void put(std::size_t place, const Box& box, const Box* own_box) {
    others.put(place, box);
    if (own_box != nullptr) own.put(place, *own_box);
  }
  void finish() {
    others.finish();
    own.finish();
  }
  /// Calls `visit` as BoxTree::each does for all that meet a box of `asking`: its own one if `is_own`.
  template <class Boxes, class Visit>
  void each(bool is_own, const Boxes& asking, const Visit& visit) const {
    if (is_own)
      own.each(asking.own_box, visit);
    else
      others.each(asking.box, visit);
  }
};

/// The facets of one part.
struct PartFacets {
  std::vector<std::int32_t> facet;  // in the order of the trees; dead ones stay, with empty boxes
  TreePair trees;
};

/// Consecutive slaves of one part, which are neighbours as a rule: most facets are far from all of them.
struct SlaveCluster {
  static constexpr std::int32_t size = 16;
  Box box, own_box;
  std::int32_t first_place = 0;  // in the trees of the part
  std::vector<std::int32_t> slaves;

  void enclose(const std::vector<ContactNodeRecord>& all) {
    box = own_box = {};
    for (const std::int32_t s : slaves) {
      box.include(all[s].box);
      own_box.include(all[s].own_box);
    }
  }
};

/// The slaves of one part.
struct PartSlaves {
  /// What the search needs of a slave once its box is hit, copied here to save a cache miss on the record. Unused
  /// places of a cluster have an empty box.
  struct Place {
    std::int32_t slave = -1;
    std::int32_t node = -1;  // number
    std::uint32_t role = 0;
  };
  std::vector<Place> places;  // SlaveCluster::size to each cluster
  TreePair trees;
  std::int32_t open_cluster = -1;  // the one that has room for another slave
};

/// Facets that one cluster of slaves meets, to be compared with each of its slaves without a search in the tree.
class NearbyFacets {
 public:
  void clear() {
    facet_.clear();
    boxes_.clear();
  }
  void add(std::int32_t facet, const Box& box) {
    const auto lane = static_cast<int>(facet_.size() % BoxGroup::size);
    if (lane == 0) boxes_.emplace_back();
    boxes_.back().set(lane, box);
    facet_.push_back(facet);
  }
  bool empty() const { return facet_.empty(); }
  /// Whether each slave is better off with the tree: a cluster that debris has scattered may meet most of a part.
  bool too_many() const { return facet_.size() > 512; }
  /// Calls `visit(facet)` for all that meet a box. All answers of some groups are there before the first visit: whether
  /// one group has any is what no processor can predict.
  template <class Visit>
  void each(const Box& box, const Visit& visit) const {
    constexpr std::size_t some = 64 / BoxGroup::size;
    for (std::size_t first = 0; first < boxes_.size(); first += some) {
      std::uint64_t meeting = 0;
      for (std::size_t g = first; g < std::min(first + some, boxes_.size()); ++g)
        meeting |= std::uint64_t{boxes_[g].meeting(box)} << (BoxGroup::size * (g - first));
      for (; meeting != 0; meeting &= meeting - 1)
        visit(facet_[BoxGroup::size * first + static_cast<std::size_t>(std::countr_zero(meeting))]);
    }
  }

 private:
  std::vector<std::int32_t> facet_;
  std::vector<BoxGroup> boxes_;
};

}  // namespace kerf
