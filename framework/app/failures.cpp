// Lines on the error output, and the end of all ranks.
#include "app/failures.hpp"

#include <fmt/format.h>

#include <cstdio>

#include "app/commands.hpp"
#include "parallel/communicator.hpp"

namespace kerf {

int fail_together(MPI_Comm comm, const std::vector<std::string>& lines, int code) {
  if (rank_of(comm) == 0) {
    std::fflush(stdout);
    for (const std::string& line : lines) std::fputs((line + "\n").c_str(), stderr);  // nobody to tell if this fails
    std::fflush(stderr);
  }
  MPI_Barrier(comm);
  return code;
}

int fail_alone(MPI_Comm comm, const std::exception& e) {
  fmt::print(stderr, "error: rank {}: {}\n", rank_of(comm), e.what());
  std::fflush(stderr);
  if (size_of(comm) > 1) MPI_Abort(comm, exit_other);
  return exit_other;
}

}  // namespace kerf
