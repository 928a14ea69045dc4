// Multilevel partitioning of the graph of elements that share a face, by PT-Scotch through Zoltan.
//
// C. Chevalier & F. Pellegrini, "PT-Scotch: a tool for efficient parallel graph ordering", Parallel Computing 34
// (2008) 318-331. It starts afresh each time: what elements move is not weighed.
#include <mpi.h>

#include <cstdio>

// Declares functions that take files and communicators.
#include <ptscotch.h>

#include "zoltan_support.hpp"

namespace kerf {
namespace {

class ZoltanScotch final : public ZoltanPartitioner {
 public:
  static void describe(Schema<ZoltanScotch>& s) { describe_zoltan(s); }

 protected:
  /// Otherwise the same question would get another answer the next time.
  void begin() const override { SCOTCH_randomReset(); }
  ZoltanSees sees() const override { return ZoltanSees::graph; }
  ZoltanParameters method(const PartitionProblem&) const override {
    return {{"LB_METHOD", "GRAPH"},
            {"GRAPH_PACKAGE", "SCOTCH"},
            {"LB_APPROACH", "PARTITION"},
            {"EDGE_WEIGHT_DIM", "0"},
            {"CHECK_GRAPH", "0"}};
  }
};

}  // namespace
}  // namespace kerf

KERF_PARTITIONER(kerf::ZoltanScotch, "zoltan_scotch", "multilevel graph partitioning by PT-Scotch, afresh each time")
