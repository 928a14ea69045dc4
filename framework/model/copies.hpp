// Sums that are equal on all copies of a node.
#pragma once

#include <cstdint>

#include "model/model.hpp"

namespace kerf {

/// Adds the copies of every node and gives all of them the sum. `values` has `stride` entries per node, of which
/// the first min(stride, 3) travel. Collective.
void sum_over_copies(const Model& model, std::int64_t* values, int stride);
/// Gives every copy of a node on other ranks the values of its owner. Collective.
void copy_to_ghosts(const Model& model, std::int64_t* values, int stride);

}  // namespace kerf
