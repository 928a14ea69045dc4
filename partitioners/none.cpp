// The partitioner that leaves every element where it is: the reference that re-balancing is measured against.
#include "kerf/partitioner.hpp"

namespace kerf {
namespace {

class NoPartitioner final : public Partitioner {
 public:
  static void describe(Schema<NoPartitioner>&) {}
  std::vector<int> partition(const PartitionProblem& problem) override {
    int rank = 0;
    MPI_Comm_rank(problem.comm, &rank);
    return std::vector<int>(problem.ids.size(), rank);
  }
};

}  // namespace
}  // namespace kerf

KERF_PARTITIONER(kerf::NoPartitioner, "none",
                 "leaves elements on the ranks of their initial, contiguous ranges of numbers")
