// What ranks tell each other about the contact surface at a search.
#pragma once

#include <cstdint>

namespace kerf {

struct ContactNodeRecord {
  std::int64_t id = 0;
  // Where the node was at the search, or, for one that joined later, would have been had it shared the common motion
  // of all parts, and of its own part, since then [m].
  double position[3] = {}, own_position[3] = {};
  // Distance that the node may move until the next search, beyond the common motion of its part, which is what
  // counts against its own part, and of all parts [m].
  double own_allowance = 0.0, allowance = 0.0;
  std::int32_t part = 0, owner = 0;
  std::uint32_t role = 0;  // bit 0: slave; bit 1: slave of the second pass
  std::int32_t local = 0;  // the owner's number of the node
};

struct ContactFacetRecord {
  std::int64_t id = 0;  // element id * 8 + face
  std::int64_t nodes[4] = {};
  std::int64_t opposite[4] = {};  // the other four nodes of its element
  std::int32_t owners[4] = {}, locals[4] = {};
  double low[3] = {}, high[3] = {};  // box of its nodes' positions, inflated by the facet's reach [m]
  double own_low[3] = {}, own_high[3] = {};  // the same of their own positions [m]
  double own_allowance = 0.0, allowance = 0.0;  // the largest of its nodes' [m]
  double bulk_modulus = 0.0, volume = 0.0;
  std::int32_t part = 0;
  std::uint32_t role = 0;  // bits of the slaves that it meets
};

}  // namespace kerf
