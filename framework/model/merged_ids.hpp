// Nodes of different parts that lie at one place become one node: finds them, and numbers what is left.
//
// Everything is spread over the ranks: places by a grid of cubes, ids in blocks of equal length.
#pragma once

#include <mpi.h>

#include <cstdint>
#include <vector>

#include "kerf/math.hpp"

namespace kerf {

/// A node of an undeformed part that may be at the place of one of another part.
struct JointNode {
  std::int64_t id = 0;  // the same on all ranks that have the node
  std::int32_t part = 0;
  Vec3 position;  // [m]
};

/// Two nodes that are to become one.
struct IdPair {
  std::int64_t low = 0, high = 0;  // ids
  std::int32_t low_part = 0, high_part = 0;
};

/// All pairs of nodes of different parts that are at most `tolerance` [m] apart, each on one rank or more. `cube` is
/// the edge of the grid's cubes [m], best about that of a cell; pre: more than twice the tolerance. Ranks may have the
/// same node. Collective.
std::vector<IdPair> coincident_nodes(MPI_Comm comm, const std::vector<JointNode>& nodes, double tolerance, double cube);

/// Ids of nodes before and after some of them were merged: of nodes that become one, the lowest id survives, and the
/// survivors are numbered without gaps in the order that they had.
class MergedIds {
 public:
  /// Nothing is merged.
  MergedIds() = default;
  /// Ids are in [0, n_ids). Pairs may come from any rank, and more than once; what is merged with the same node is
  /// merged. Collective.
  MergedIds(MPI_Comm comm, std::int64_t n_ids, const std::vector<IdPair>& pairs);

  bool empty() const { return n_merged_ == 0; }
  /// How many ids there are no more; the same on all ranks.
  std::int64_t n_merged() const { return n_merged_; }
  /// The new ids of some old ones. Collective.
  std::vector<std::int64_t> resolve(MPI_Comm comm, const std::vector<std::int64_t>& ids) const;
  /// How many survivors are below each of some old ids; all ranks must ask the same. Collective.
  std::vector<std::int64_t> n_survivors_below(MPI_Comm comm, const std::vector<std::int64_t>& ids) const;
  /// Of this rank's block of ids: an old id that is no more, and the one that it was merged with.
  struct Merged {
    std::int64_t id = 0, survivor = 0;
  };
  const std::vector<Merged>& merged() const { return merged_; }
  /// The old ids of all ranks that are no more, in ascending order. Collective.
  std::vector<std::int64_t> all_merged(MPI_Comm comm) const;

 private:
  int home_of(std::int64_t id) const { return static_cast<int>(id / block_); }
  std::int64_t number_of(std::int64_t id) const;

  std::int64_t n_merged_ = 0, block_ = 1;
  std::int64_t n_before_ = 0;  // merged ids of the ranks before
  std::vector<Merged> merged_;  // in ascending order
  std::vector<std::int64_t> number_;  // of merged_: the new id of the survivor
};

}  // namespace kerf
