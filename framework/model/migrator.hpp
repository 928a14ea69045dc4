// Moves elements and nodes between ranks and rebuilds everything that depends on who has what.
//
// One path serves the first distribution, re-balancing and restart: a bundle of elements and nodes per rank goes
// in, a numbered model with its plans comes out.
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "model/model.hpp"

namespace kerf {

/// Elements of one part on their way: ids, global nodes, and their records.
struct ElementBundle {
  std::vector<std::int64_t> ids;
  std::vector<ElementNodeIds> nodes;
  std::vector<double> records;  // one after the other; empty where they are elsewhere
  std::vector<const double*> record_at;  // where each record is, if not in `records`

  const double* record(std::size_t element, int size) const {
    return record_at.empty() ? records.data() + element * static_cast<std::size_t>(size) : record_at[element];
  }
};

struct ModelBundle {
  std::vector<ElementBundle> parts;
  std::vector<NodeRecord> nodes;  // may hold a node more than once, with the same content
  std::vector<std::vector<double>> messages;  // that `record_at` points into
};

/// Orders and numbers a bundle (elements along a space-filling curve, nodes by first use), agrees on owners and
/// builds the exchange plan and the surface. Collective.
void assemble(Model& model, ModelBundle&& bundle);

/// Gives every live local element to the rank in `owners`, numbered through the parts' live slots in order. Nodes
/// without live elements stay where they are owned. Returns the elements that left this rank. Collective.
std::int64_t migrate(Model& model, const std::vector<int>& owners);

}  // namespace kerf
