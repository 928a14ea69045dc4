// Segments of a deck as sets of nodes: exterior facets with all corners in such a set are the segments, and no others.
#pragma once

#include <array>
#include <cstdint>
#include <string>
#include <utility>
#include <vector>

#include "lowering/lowering.hpp"
#include "mesh/label_map.hpp"

namespace kerf::lowering {

/// A segment: which exterior facet it is, and whether its corners go round as seen from outside.
struct Segment {
  std::int32_t facet = -1;  // -1 where it is none, which has been told
  bool outward = true;
};

class SegmentSets {
 public:
  explicit SegmentSets(Lowering& low);
  /// By the ids of its nodes; a triangle repeats its last node, or has a 0 there.
  Segment segment(const std::array<std::int64_t, 4>& ids, const Origin& where);
  std::vector<Segment> segments_of(std::int64_t set, const Origin& where);
  /// Sets of the document that hold the segments, and the sign of a pressure on each: -1 on segments that look inward.
  std::vector<std::pair<std::string, double>> of(const std::vector<Segment>& segments, const Origin& where);
  /// Sets of the document that hold the segments, whichever way they look.
  std::vector<std::string> facets_of(const std::vector<Segment>& segments, const Origin& where);

 private:
  struct Facet {
    std::array<std::int32_t, 4> key;  // its nodes, ascending
    std::array<std::int32_t, 4> nodes;  // counter-clockwise as seen from outside
  };
  void find_exterior();
  Segment of_nodes(std::array<std::int32_t, 4> nodes, const Origin& where);
  void divide(std::vector<std::int32_t> facets, double sign, const Origin& where,
              std::vector<std::pair<std::string, double>>& found);
  bool holds_no_other(const std::vector<std::int32_t>& facets) const;
  std::array<double, 3> middle(std::int32_t facet) const;

  Lowering& low_;
  std::vector<Facet> exterior_;  // by key
  std::vector<std::vector<std::int32_t>> facets_of_node_;
  LabelMap index_;
};

}  // namespace kerf::lowering
