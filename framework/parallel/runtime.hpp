// Starts and ends MPI, Kokkos and Tpetra for the life of one object in main().
#pragma once

#include <mpi.h>

#include <memory>

namespace kerf {

class ParallelRuntime {
 public:
  ParallelRuntime(int& argc, char**& argv);
  ~ParallelRuntime();
  MPI_Comm comm() const { return MPI_COMM_WORLD; }

 private:
  struct Guard;
  std::unique_ptr<Guard> guard_;
};

}  // namespace kerf
