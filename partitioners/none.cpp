// The partitioner that leaves every element where it is: the reference that re-balancing is measured against.
#include "kerf/partitioner.hpp"

namespace kerf {
namespace {

class NoPartitioner final : public Partitioner {
 public:
  static void describe(Schema<NoPartitioner>&) {}

  std::vector<std::string> complaints(const PartitionProblem& problem) override {
    int n_ranks = 1;
    MPI_Comm_size(problem.comm, &n_ranks);
    if (problem.n_parts == n_ranks || knows_parts(problem)) return {};
    return {origin + ": error: the partitioner `none` leaves elements on their " + std::to_string(n_ranks) +
            " ranks, and " + std::to_string(problem.n_parts) + " parts are asked for; use `block` in its place"};
  }

  std::vector<int> partition(const PartitionProblem& problem) override {
    if (knows_parts(problem)) return problem.present_parts;
    int rank = 0;
    MPI_Comm_rank(problem.comm, &rank);
    return std::vector<int>(problem.ids.size(), rank);
  }

 private:
  /// Collective: a rank without elements has an empty list in either case.
  static bool knows_parts(const PartitionProblem& problem) {
    int knows = problem.present_parts.empty() ? 0 : 1;
    MPI_Allreduce(MPI_IN_PLACE, &knows, 1, MPI_INT, MPI_MAX, problem.comm);
    return knows == 1;
  }
};

}  // namespace
}  // namespace kerf

KERF_PARTITIONER(kerf::NoPartitioner, "none",
                 "leaves elements on the ranks of their initial, contiguous ranges of numbers")
