// Joins parts: nodes of their undeformed meshes that lie at one place, or that are one node of the file that the parts
// are taken from, become one node, which the parts share.
#pragma once

#include <cstdint>
#include <functional>
#include <vector>

#include "model/merged_ids.hpp"

namespace kerf {

struct Model;
struct ModelBundle;

/// What a part gives to the mass of a node that it shares with others.
struct NodeShare {
  std::int64_t node = 0;
  std::int32_t part = 0;
  double mass = 0.0;  // of the part's undeformed elements round the node, lumped [kg]
};

/// The nodes that parts share, spread over the ranks.
struct SharedNodes {
  MergedIds ids;  // from numbers in the parts' meshes, one part after the other, to the model's nodes
  std::vector<NodeShare> shares;  // of nodes whose id modulo the number of ranks is this rank; by node, then by part
  std::vector<std::int64_t> merged;  // all numbers that became another node's, ascending, where meshes have labels

  /// The number, before nodes were merged, of the node that has an id now. Pre: the mesh of a part has labels. Local.
  std::int64_t before_joining(std::int64_t id) const;
};

/// Finds out which parts make up one body, because the input joins them or they share nodes of a file. Local.
void number_bodies(Model& model);

/// Merges the nodes of a freshly generated bundle as the input says, and renumbers all. A merged node has the position
/// of the one with the lowest id, and belongs to the parts and sets of all. `shortest_edges` [m] is per part, of all
/// ranks. Returns the new ids of this rank's nodes that have moved, in ascending order. Throws InputError where parts
/// have nothing in common or a tolerance is too large. Collective.
std::vector<std::int64_t> join_parts(Model& model, ModelBundle& bundle, const std::vector<double>& shortest_edges);

/// Finds what every part gives to the nodes that it shares, and gives these the velocity of a perfectly plastic impact
/// where the parts start with different ones: the mean, weighted by mass. `share(part, slot, corner)` is what an
/// element gives to a node, in quanta of `quantum` [kg]. Collective.
void share_nodes(Model& model, double quantum, const std::function<std::int64_t(std::size_t, int, int)>& share);

/// The shares of some nodes, in the order of the nodes, then of the parts; none of nodes of one part. Collective.
std::vector<NodeShare> shares_of(const Model& model, const std::vector<std::int64_t>& nodes);

}  // namespace kerf
