// Multilevel partitioning of the graph of elements that share a face, by Zoltan's parallel hypergraph package.
//
// U.V. Catalyurek et al., "A repartitioning hypergraph model for dynamic load balancing", J. Parallel Distrib.
// Comput. 69 (2009) 711-724: minimises repart_multiplier times the communication per cycle plus the migration.
#include "zoltan_support.hpp"

namespace kerf {
namespace {

class ZoltanGraph final : public ZoltanPartitioner {
 public:
  static void describe(Schema<ZoltanGraph>& s) {
    describe_zoltan(s);
    describe_approach(s, &ZoltanGraph::approach);
    s.real(&ZoltanGraph::repart_multiplier, "repart_multiplier", "-", positive,
           "cost of communication per cut face over that of migrating one element; for approach repartition")
        .by_default("100");
    s.integer(&ZoltanGraph::seed, "seed", between(1, 2147483647), "seed of the heuristics' random numbers")
        .by_default("1");
  }

  std::string approach = "repartition";
  double repart_multiplier = 100.0;
  std::int64_t seed = 1;

 protected:
  ZoltanSees sees() const override { return ZoltanSees::graph; }
  ZoltanParameters method(const PartitionProblem& problem) const override {
    return {{"LB_METHOD", "GRAPH"},
            {"GRAPH_PACKAGE", "PHG"},
            {"LB_APPROACH", zoltan_approach(approach, problem)},
            {"PHG_REPART_MULTIPLIER", std::to_string(repart_multiplier)},
            {"EDGE_WEIGHT_DIM", "0"},
            {"CHECK_GRAPH", "0"},
            {"SEED", std::to_string(seed)}};
  }
};

}  // namespace
}  // namespace kerf

KERF_PARTITIONER(kerf::ZoltanGraph, "zoltan_graph", "multilevel graph partitioning: the fewest shared faces")
