// The folder that a command writes its results into.
#pragma once

#include <mpi.h>

#include <string>

#include "app/commands.hpp"

namespace kerf {

/// What --output names, or results/NAME with an ending, for an input NAME.yaml.
std::string result_folder(const RunOptions& options, const std::string& ending = "");

/// Makes it where it is not there. Throws InputError, on all ranks, where that or writing into it is not possible.
/// Collective.
void make_result_folder(MPI_Comm comm, const std::string& folder);

}  // namespace kerf
