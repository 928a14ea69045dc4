// Whether a straight line between two points meets a surface of triangles and quadrilaterals.
#pragma once

#include <array>
#include <cstddef>
#include <vector>

#include "kerf/math.hpp"

namespace kerf {

using SightFacet = std::array<Vec3, 4>;  // corners [m]; a triangle repeats one

/// Facets in a tree of boxes. The answer does not depend on their order.
class Sight {
 public:
  explicit Sight(std::vector<SightFacet> facets);

  /// Whether no facet lies across the way. What touches only an end, or lies along the way, is not in it; an edge is.
  bool is_free(Vec3 from, Vec3 to) const;

 private:
  struct Box {
    Vec3 low, high;
  };
  struct Branch {
    Box box;
    int first = 0, last = 0;  // facets
    int left = -1, right = -1;  // -1: a leaf
  };
  int split(int first, int last);
  static Box box_of(const SightFacet& f);

  std::vector<SightFacet> facets_;
  std::vector<Branch> branches_;
};

}  // namespace kerf
