// The plugins of the command line and of the input, on all ranks alike.
#pragma once

#include <mpi.h>

#include <string>
#include <vector>

#include "app/commands.hpp"
#include "core/diagnostics.hpp"
#include "plugin/registry.hpp"

namespace kerf {

/// A plugin that someone has named.
struct WantedPlugin {
  std::string name;  // as it was written
  std::string path;  // the file that this means by itself
  std::string origin;  // of the input; empty for the command line
};

/// Those of the command line, then those that the input names.
std::vector<WantedPlugin> wanted_plugins(const RunOptions& options, const std::string& input_bytes);

/// Loads each file once. Throws InputError with all that is wrong. For one process, without MPI.
void load_plugins(const std::vector<WantedPlugin>& wanted, Registry& registry);

/// The same on all ranks: rank 0 looks for the files, all load from the same path, and every file must be the same to
/// the byte. Throws InputError on all ranks with the same lines. Collective.
void load_plugins(MPI_Comm comm, const std::vector<WantedPlugin>& wanted, Registry& registry);

}  // namespace kerf
