// The contract of partitioners: from weighted elements to an owner for each.
#pragma once

#include <mpi.h>

#include <cstdint>
#include <memory>
#include <vector>

#include "kerf/math.hpp"
#include "kerf/plugin.hpp"

namespace kerf {

/// The elements of one rank, and, where asked for, their neighbours across faces.
struct PartitionProblem {
  MPI_Comm comm = MPI_COMM_NULL;
  std::vector<std::int64_t> ids;  // global element ids
  std::vector<double> coordinates;  // three per element [m]
  std::vector<double> weights;  // work of each element per cycle
  // Compressed rows: neighbours of element i are neighbours[first[i]] .. neighbours[first[i + 1]].
  std::vector<std::int64_t> first, neighbours;
  std::vector<int> neighbour_ranks;
};

/// A division of space into one box per rank, for finding the ranks that a point or a box touches.
class SpatialDecomposition {
 public:
  virtual ~SpatialDecomposition() = default;
  /// Collective. Balances the weighted points and keeps the cuts. Ranks may bring no points.
  virtual void build(MPI_Comm comm, const std::vector<double>& coordinates, const std::vector<double>& weights) = 0;
  virtual int owner(Vec3 point) const = 0;
  virtual void owners(Vec3 low, Vec3 high, std::vector<int>& ranks) const = 0;
};

class Partitioner : public Plugin {
 public:
  virtual bool needs_graph() const { return false; }
  /// Collective. Returns the new owner of each element in `problem.ids`.
  virtual std::vector<int> partition(const PartitionProblem& problem) = 0;
  /// Null where this partitioner offers none.
  virtual std::unique_ptr<SpatialDecomposition> spatial() const { return nullptr; }
};

}  // namespace kerf

KERF_SIZES(partitioner, KERF_SIZE(PartitionProblem), KERF_SIZE(SpatialDecomposition), KERF_SIZE(Partitioner))
