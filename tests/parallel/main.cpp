// Runs the tests on all ranks of one MPI program: rank 0 reports, and any rank's failure fails the run.
#include <gtest/gtest.h>
#include <mpi.h>

#include <cstdio>

#include "parallel/communicator.hpp"
#include "parallel/runtime.hpp"

namespace {

/// What ranks other than 0 print: failures alone, each line with its rank.
class FailurePrinter final : public testing::EmptyTestEventListener {
  void OnTestPartResult(const testing::TestPartResult& result) override {
    if (!result.failed()) return;
    std::fprintf(stderr, "rank %d: %s:%d: %s\n", kerf::rank_of(MPI_COMM_WORLD),
                 result.file_name() ? result.file_name() : "", result.line_number(), result.message());
  }
};

}  // namespace

int main(int argc, char** argv) {
  const kerf::ParallelRuntime runtime(argc, argv);
  testing::InitGoogleTest(&argc, argv);
  if (kerf::rank_of(runtime.comm()) != 0) {
    testing::TestEventListeners& listeners = testing::UnitTest::GetInstance()->listeners();
    delete listeners.Release(listeners.default_result_printer());
    listeners.Append(new FailurePrinter);
    testing::GTEST_FLAG(output) = "";
  }
  int failed = RUN_ALL_TESTS();
  MPI_Allreduce(MPI_IN_PLACE, &failed, 1, MPI_INT, MPI_MAX, runtime.comm());
  return failed;
}
