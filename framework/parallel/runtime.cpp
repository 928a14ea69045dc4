// The guards of MPI and Tpetra.
#include "parallel/runtime.hpp"

#include <Tpetra_Core.hpp>

#include "core/activity.hpp"
#include "parallel/communicator.hpp"

namespace kerf {

struct ParallelRuntime::Guard {
  Guard(int& argc, char**& argv) : tpetra(&argc, &argv) {}
  Tpetra::ScopeGuard tpetra;
};

ParallelRuntime::ParallelRuntime(int& argc, char**& argv) {
  int provided = 0;
  int initialised = 0;
  MPI_Initialized(&initialised);
  if (!initialised) MPI_Init_thread(&argc, &argv, MPI_THREAD_FUNNELED, &provided);
  guard_ = std::make_unique<Guard>(argc, argv);
  if (size_of(comm()) > 1) activity::rank = rank_of(comm());
}

ParallelRuntime::~ParallelRuntime() {
  guard_.reset();
  int finalised = 0;
  MPI_Finalized(&finalised);
  if (!finalised) MPI_Finalize();
}

}  // namespace kerf
