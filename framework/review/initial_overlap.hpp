// Finds parts that overlap at the start, or at the end: any two cells of different parts that share volume, however
// deep they lie.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "model/model.hpp"
#include "model/node_group.hpp"

namespace kerf {

/// What two parts share.
struct Overlap {
  int first = 0, second = 0;  // parts, in the order of the input
  double volume = 0.0;  // [m3]
  Vec3 low, high;  // corners of the box round what they share [m]

  /// "parts a and b overlap at the start: ...", without advice.
  std::string sentence(const Model& model, const char* when = "at the start") const;
};

/// All parts that overlap by more than a millionth of a cell, in the order of the input; the same on any number of
/// ranks. Cells that share nodes, because parts are joined, do not count. Of cells whose faces are warped, overlaps
/// that are less deep than the warp may be missed. Collective.
std::vector<Overlap> find_overlaps(const Model& model);

/// Which contact definition brings two parts together, from the parts that the definitions and their sets name.
class ContactCover {
 public:
  explicit ContactCover(const Model& model);
  /// The first definition between nodes of one part and facets of the other, as its place in the input; -1 for none.
  int between(int part, int other) const;

 private:
  struct Sides {
    NodeGroup slaves, masters;
  };
  std::vector<Sides> definitions_;
};

}  // namespace kerf
