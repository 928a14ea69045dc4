// How commands end when something is wrong.
#pragma once

#include <mpi.h>

#include <exception>
#include <string>
#include <vector>

namespace kerf {

/// Prints on rank 0 and waits, so that no rank ends the job before the lines are out. Returns the code. Collective.
int fail_together(MPI_Comm comm, const std::vector<std::string>& lines, int code);

/// For what may have been thrown on one rank only, while others wait for it: prints on this rank, and ends all ranks.
/// Returns exit_other where there are no others.
int fail_alone(MPI_Comm comm, const std::exception& e);

}  // namespace kerf
