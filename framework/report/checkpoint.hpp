// Writes and reads the whole state of a run, exact to the bit, for any number of ranks.
#pragma once

#include <string>

#include "dynamics/simulation.hpp"
#include "report/observer_host.hpp"

namespace kerf {

/// Where the output files of a run stand, for going on with them.
struct OutputProgress {
  std::int64_t n_frames = 0;
  double next_results = 0.0, next_history = 0.0, next_restart = 0.0;  // [s]
  std::vector<std::int64_t> eroded_by;  // elements eroded so far, per part and criterion
  std::vector<ObserverProgress> observers = {};
  std::string plugin_files = {};  // that the run was computed with, see Registry::files()
  bool knows_plugins = false;  // false for files from before they were noted
};

/// Collective.
void write_checkpoint(const std::string& path, const std::string& input_digest, Simulation& simulation,
                      const OutputProgress& output);

/// Replaces the state of a simulation of time zero by that of the file. Throws InputError where the file does not
/// belong to this input, and OutputError where it is absent or damaged. Collective.
OutputProgress read_checkpoint(const std::string& path, const std::string& input_digest, Simulation& simulation);

}  // namespace kerf
