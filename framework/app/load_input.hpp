// Reads and checks an input file for the commands that need the model.
#pragma once

#include <mpi.h>

#include <memory>
#include <string>

#include "app/commands.hpp"
#include "input/model_input.hpp"

namespace kerf {

/// Rank 0 reads the file, all ranks parse the same bytes. Throws InputError, on all ranks, with every mistake.
/// Warnings are printed by rank 0. Collective.
std::unique_ptr<ModelInput> load_input(MPI_Comm comm, const RunOptions& options, Registry& registry);

/// The bytes of the input file. Throws InputError where it cannot be read. Without MPI.
std::string read_input_file(const std::string& path);

/// The text of the input file; the plugins that it names are loaded. Throws InputError. Without MPI.
std::string read_with_plugins(const RunOptions& options, Registry& registry);

/// What load_input would refuse on `options.ranks` ranks, found without MPI: mistakes in the input need no mpirun, and
/// a slip such as --ranks 5000 must not start what the machine cannot hold. Throws InputError.
void check_before_launch(const RunOptions& options, Registry& registry);

}  // namespace kerf
