// What ranks tell each other about the contact surface at a search.
//
// A body is a part, or all parts that the input joins with one another; its number is that of its first part. Boxes
// hold where something may be until they are renewed. The first is seen from a frame that was in the largest body at
// the search and has moved with it since, and counts for pairs of different bodies; the second from one that has moved
// with the node's or facet's own body, and counts for pairs within it.
#pragma once

#include <cstdint>

#include "contact/box.hpp"

namespace kerf {

/// What boxes are seen from: it stands in the middle of a body's surface at a search and moves on with most of it. So
/// boxes in single precision are as sharp far from the origin as near to it, and as small however fast the body flies.
struct ContactFrame {
  Vec3 origin, velocity;  // at the search [m], [m/s]

  Vec3 at(double since_search) const { return origin + velocity * since_search; }
};

struct ContactNodeRecord {
  std::int64_t id = 0;
  Box box, own_box;
  Vec3 home;  // decides about its rank until the next search
  std::int32_t body = 0, owner = 0;
  std::uint32_t role = 0;  // bit 0: slave; bit 1: slave of the second pass
  std::int32_t local = 0;  // number of the node on the rank that made the record; -1 on any other
};

struct ContactFacetRecord {
  std::int64_t id = 0;  // number of the element * Shape::code_of_faces + face; elements are numbered body by body
  std::int64_t nodes[8] = {};  // corners of the facet, then the nodes behind each; the corner itself where none is
  std::int32_t locals[8] = {};  // their numbers on the rank that made the record; -1 on any other
  std::int32_t owners[8] = {};
  Box box, own_box;  // inflated by the facet's reach
  double bulk_modulus = 0.0, volume = 0.0, edge = 0.0;  // of the undeformed: volume of the element, longest edge
  std::int32_t body = 0;
  /// Role of a facet that is there only to say what surface the slaves of its corners belong to.
  static constexpr std::uint32_t meets_none = 4;
  std::uint32_t role = 0;  // bits of the slaves that it meets
};

}  // namespace kerf
