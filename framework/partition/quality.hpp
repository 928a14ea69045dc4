// Measures of a partition: balance, interfaces, neighbours and surfaces of the parts.
#pragma once

#include <cstdint>
#include <vector>

#include "model/model.hpp"

namespace kerf {

/// What is counted of the parts. All are sums of whole numbers, or made from them in a fixed order, so the values do
/// not depend on the ranks that hold the elements. Definitions: doc/users/partition.md.
struct PartitionQuality {
  // Per part:
  std::vector<std::int64_t> elements, interface_nodes, interface_faces, faces;
  std::vector<std::int64_t> neighbours;  // parts with which it shares a node
  std::vector<double> work, contact_work;
  // Of all parts together:
  std::int64_t all_interface_nodes = 0;  // nodes in more than one part
  std::int64_t node_copies = 0;  // copies of nodes beyond the first
  std::int64_t all_interface_faces = 0, all_faces = 0;  // each counted once
};

/// `parts` is the part of each live element in the order of the stores, `contact_work` its work of contact in the same
/// order. Collective; the result is complete on all ranks.
PartitionQuality measure_quality(const Model& model, const std::vector<int>& parts, int n_parts,
                                 const std::vector<double>& contact_work);

}  // namespace kerf
