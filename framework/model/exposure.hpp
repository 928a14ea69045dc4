// Counts, for each element at time zero, the faces that nothing holds: neither a neighbour nor a boundary condition.
#pragma once

#include <cstdint>
#include <vector>

#include "model/model.hpp"

namespace kerf {

/// Per part and slot. A face is held where another element stands behind it, or where a condition rules the velocity of
/// all its corners along its normal: a plane of symmetry, a clamp, a given motion. Collective.
std::vector<std::vector<std::uint8_t>> count_exposed_faces(Model& model);

}  // namespace kerf
