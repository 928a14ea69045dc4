// The sub-commands of `kerf`. Each returns the exit code of the program.
#pragma once

#include <string>
#include <vector>

#include "plugin/registry.hpp"

namespace kerf {

/// Exit codes that scripts may rely on.
enum ExitCode : int {
  exit_done = 0,
  exit_other = 1,
  exit_input_error = 2,
  exit_physics = 3,  // stopped by a check: energy, time step, NaN
  exit_signal = 4,  // stopped by a signal; can be resumed
};

/// What `run` and `check` are told. They load the plugins.
struct RunOptions {
  std::string input, output;
  std::vector<std::string> overrides;  // "key.path=value"
  std::vector<std::string> plugins;  // shared libraries, by path or by name
  bool resume = false;
  int ranks = 0;  // 0 where not given
  // Of keyword decks.
  std::string units;  // "g,cm,us"; empty where not given
  int case_number = 0;  // 0 where not given
  bool without_unsupported = false, strict = false;
  bool has_deck_options() const { return !units.empty() || case_number != 0 || without_unsupported || strict; }
};

/// What `partition` is told.
struct PartitionOptions {
  RunOptions run;
  std::string parts;  // "2,4,8"
  std::vector<std::string> methods;  // all, names with commas between, NAME={type: ...}
  std::string results, frames;  // folder of a run, "0,10,last"
  bool no_mesh = false;
};

/// What `test-plugin` is told.
struct TestPluginOptions {
  std::string library, samples, only;  // paths; KIND.NAME
  std::vector<std::string> checks;
  bool builtin = false;
};

// These start and end MPI. Only rank 0 prints.
int run_command(const RunOptions& options, Registry& registry);
int check_command(const RunOptions& options, Registry& registry);
int partition_command(const PartitionOptions& options, Registry& registry);

/// Writes a deck, or the mesh of a file, as case.yaml and mesh.h5 into a folder. Needs no MPI.
int convert_command(const RunOptions& options);

// These need no MPI.
/// Curves of laws along the paths of a drive file. Where `only_check`, nothing is written, and what has no reference is
/// refused.
int drive_command(const RunOptions& options, Registry& registry, bool only_check);
/// Blocks, sets and what was left out of the file of a mesh; written to `into`, unless it is empty.
int mesh_command(const std::string& file, const std::string& into);
int list_command(const Registry& registry, const std::string& kind);
/// `names` is NAME or KIND NAME; "input" names the whole input file, "drive" a drive file.
int describe_command(const Registry& registry, const std::vector<std::string>& names, bool markdown);
/// Conformance tests of the types that a library registers, or of all types of Kerf. Exit code 1 where one fails.
int test_plugin_command(const TestPluginOptions& options, Registry& registry);
int schema_command(const Registry& registry);
/// Makes the folder NAME, inside of `folder`, with a plugin of the kind, its tests and its pages; where `python` names
/// a file, with the declarations of its law of that kind.
int new_plugin_command(const Registry& registry, const std::string& kind, const std::string& name,
                       const std::string& folder, const std::string& python);
int reference_command(const Registry& registry, const std::string& folder);

/// Whether relaunch_under_mpirun() would start mpirun.
bool needs_mpirun(int ranks);

/// Runs this program again under mpirun where `ranks` asks for several and mpirun did not start it. Does not return
/// then. Throws std::runtime_error where mpirun cannot be started or runs another number of ranks.
void relaunch_under_mpirun(int ranks, int argc, char** argv);

/// Prints warnings on the standard error. To be called by one rank.
void print_warnings(const std::vector<std::string>& lines);

/// Prints what all ranks find alike outside MPI, once: only on the first of the processes that mpirun started.
void print_errors(const std::vector<std::string>& lines);

}  // namespace kerf
