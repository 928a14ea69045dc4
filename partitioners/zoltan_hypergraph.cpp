// Partitioning of the hypergraph of nodes, by Zoltan's parallel hypergraph package: the fewest copies of nodes.
//
// U.V. Catalyurek et al., "A repartitioning hypergraph model for dynamic load balancing", J. Parallel Distrib.
// Comput. 69 (2009) 711-724. Elements are vertices, and each node is a hyperedge through its elements. A node that is
// on k ranks costs k - 1 exchanges per cycle, which is what the cut of a hypergraph counts; the cut faces of a graph
// count it only roughly. Against it stand the bytes that move with an element.
#include "zoltan_support.hpp"

namespace kerf {
namespace {

/// A copy of a node sends three sums of forces to the owner in each cycle, and gets three back, of 8 bytes each.
constexpr double bytes_per_cycle = 48.0;

class ZoltanHypergraph final : public ZoltanPartitioner {
 public:
  static void describe(Schema<ZoltanHypergraph>& s) {
    describe_zoltan(s);
    describe_approach(s, &ZoltanHypergraph::approach);
    s.real(&ZoltanHypergraph::repart_multiplier, "repart_multiplier", "-", positive,
           "cycles over which the exchange of forces at copies of nodes, 48 bytes each, is weighed against the bytes "
           "of the elements that move; for approach repartition")
        .by_default("100");
    s.integer(&ZoltanHypergraph::seed, "seed", between(1, 2147483647), "seed of the heuristics' random numbers")
        .by_default("1");
  }

  std::string approach = "repartition";
  double repart_multiplier = 100.0;
  std::int64_t seed = 1;

 protected:
  ZoltanSees sees() const override { return ZoltanSees::hypergraph; }
  ZoltanParameters method(const PartitionProblem& problem) const override {
    return {{"LB_METHOD", "HYPERGRAPH"},
            {"HYPERGRAPH_PACKAGE", "PHG"},
            {"LB_APPROACH", zoltan_approach(approach, problem)},
            {"PHG_REPART_MULTIPLIER", std::to_string(bytes_per_cycle * repart_multiplier)},
            {"EDGE_WEIGHT_DIM", "0"},
            {"CHECK_HYPERGRAPH", "0"},
            {"SEED", std::to_string(seed)}};
  }
};

}  // namespace
}  // namespace kerf

KERF_PARTITIONER(kerf::ZoltanHypergraph, "zoltan_hypergraph",
                 "hypergraph partitioning: the fewest copies of nodes, weighed against what moves")
