// The contract of partitioners: from weighted elements to a part for each.
#pragma once

#include <mpi.h>

#include <cstdint>
#include <memory>
#include <string>
#include <vector>

#include "kerf/math.hpp"
#include "kerf/plugin.hpp"

namespace kerf {

/// The elements of one rank, and, where asked for, their neighbours and nodes. The present owner of an element is the
/// rank that holds it.
struct PartitionProblem {
  MPI_Comm comm = MPI_COMM_NULL;
  int n_parts = 0;  // that are asked for; the number of ranks in a run, any number in `kerf partition`
  std::int64_t n_elements = 0;  // of the undeformed model; ids are below
  std::vector<std::int64_t> ids;  // global element ids
  std::vector<double> coordinates;  // three per element [m]
  int n_weights = 1;  // of an element; 2 for a partitioner that asks for the work of contact
  std::vector<double> weights;  // n_weights per element, row by row: work of the element per cycle, work of contact
  std::vector<std::int32_t> record_bytes;  // what moves with an element to another rank, per element
  /// Part in which an element is now, per element; empty where this is the rank that holds it.
  std::vector<int> present_parts;
  // Compressed rows: neighbours of element i are neighbours[first[i]] .. neighbours[first[i + 1]].
  std::vector<std::int64_t> first, neighbours;
  std::vector<int> neighbour_ranks;
  // Compressed rows in the same manner: ids of the nodes of each element.
  std::vector<std::int64_t> first_node, nodes;
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
  // What the problem has to hold beside ids, coordinates, the work of elements and the bytes of their records.
  virtual bool needs_graph() const { return false; }  // first, neighbours, neighbour_ranks
  virtual bool needs_nodes() const { return false; }  // first_node, nodes
  virtual bool needs_contact_work() const { return false; }  // a second weight

  /// Collective. Why this partitioner cannot answer, as whole lines such as "owners.txt:7: error: ...", the same on all
  /// ranks; empty where it can. Asked before every partition(), on one rank as well.
  virtual std::vector<std::string> complaints(const PartitionProblem& /*problem*/) { return {}; }
  /// Collective. Returns the part of each element in `problem.ids`, from 0 to n_parts - 1. The same question gets the
  /// same answer in every run. Part p becomes what rank p owns.
  virtual std::vector<int> partition(const PartitionProblem& problem) = 0;
  /// Null where this partitioner offers none.
  virtual std::unique_ptr<SpatialDecomposition> spatial() const { return nullptr; }
};

}  // namespace kerf

KERF_SIZES(partitioner, KERF_SIZE(PartitionProblem), KERF_SIZE(SpatialDecomposition), KERF_SIZE(Partitioner))
