// Multilevel partitioning of the graph of elements that share a face, by PT-Scotch through Zoltan.
//
// C. Chevalier & F. Pellegrini, "PT-Scotch: a tool for efficient parallel graph ordering", Parallel Computing 34
// (2008) 318-331. It starts afresh each time: what elements move is not weighed.
#include <mpi.h>

#include <cstdio>
#include <cstdlib>

// Declares functions that take files and communicators.
#include <ptscotch.h>

#include "zoltan_support.hpp"

namespace kerf {
namespace {

class ZoltanScotch final : public ZoltanPartitioner {
 public:
  static void describe(Schema<ZoltanScotch>& s) {
    describe_zoltan(s);
    s.integer(&ZoltanScotch::seed, "seed", between(1, 2147483647), "seed of the heuristics' random numbers")
        .by_default("1");
  }

  std::int64_t seed = 1;

 protected:
  /// Scotch begins each process with another seed and goes on from one call to the next, and its threads, of which it
  /// starts as many as there are cores, race: by itself it gives the same question another answer each time.
  void begin() const override {
    setenv("SCOTCH_PTHREAD_NUMBER", "1", 1);
    SCOTCH_randomSeed(static_cast<SCOTCH_Num>(seed));
    SCOTCH_randomReset();
  }
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
