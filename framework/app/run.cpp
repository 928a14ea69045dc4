// `kerf run`: from an input file to a finished run, or to a clear end.
#include <fmt/format.h>
#include <unistd.h>

#include <cerrno>
#include <cstdio>
#include <cstring>
#include <filesystem>
#include <system_error>

#include "app/commands.hpp"
#include "app/load_input.hpp"
#include "core/diagnostics.hpp"
#include "core/physics_error.hpp"
#include "dynamics/reporter.hpp"
#include "dynamics/simulation.hpp"
#include "dynamics/state_hash.hpp"
#include "kerf/measure.hpp"
#include "parallel/communicator.hpp"
#include "parallel/runtime.hpp"

namespace kerf {

namespace {

/// Prints on rank 0 and waits, so that no rank ends the job before the lines are out.
int fail(MPI_Comm comm, const std::vector<std::string>& lines, int code) {
  if (rank_of(comm) == 0) {
    std::fflush(stdout);
    for (const std::string& line : lines) fmt::print(stderr, "{}\n", line);
    std::fflush(stderr);
  }
  MPI_Barrier(comm);
  return code;
}

std::string output_folder(const RunOptions& options) {
  if (!options.output.empty()) return options.output;
  return (std::filesystem::path("results") / std::filesystem::path(options.input).stem()).string();
}

/// The command that goes on with a run.
std::string resuming(const RunOptions& options, const std::string& folder) {
  std::string command = fmt::format("kerf run {} --output {} --resume", options.input, folder);
  for (const std::string& plugin : options.plugins) command += " --plugin " + plugin;
  for (const std::string& text : options.overrides) command += fmt::format(" --set '{}'", text);
  return command;
}

/// Collective: all ranks learn whether it is there.
void make_folder(MPI_Comm comm, const std::string& folder) {
  std::string failure;
  if (rank_of(comm) == 0) {
    std::error_code status;
    std::filesystem::create_directories(folder, status);
    if (status)
      failure = fmt::format("{}: error: the folder for the results cannot be made: {}; name another with --output",
                            folder, status.message());
    else if (access(folder.c_str(), W_OK) != 0)
      failure = fmt::format("{}: error: nothing can be written into this folder: {}; name another with --output",
                            folder, std::strerror(errno));
  }
  failure = broadcast(comm, failure);
  if (!failure.empty()) throw InputError({failure});
}

int run(MPI_Comm comm, const RunOptions& options, const Registry& registry) {
  const auto input = load_input(comm, options, registry);
  ReportSettings settings;
  settings.folder = output_folder(options);
  settings.input_name = options.input;
  settings.resume = options.resume;
  // Rank 0 looks: a shared file system may show a file to some ranks before others.
  const bool missing =
      rank_of(comm) == 0 && options.resume && !std::filesystem::exists(settings.folder + "/restart/restart.h5");
  if (greatest(comm, std::int64_t{missing ? 1 : 0}) != 0)
    throw InputError(
        {fmt::format("{}/restart/restart.h5: error: there is no restart file to resume from; a run writes one "
                     "when a signal stops it and, if output.restart_interval is given, on the way and after "
                     "time.maximum_cycles; run without --resume, or name the folder of the earlier run with --output",
                     settings.folder)});
  Simulation simulation(comm, *input, registry);
  if (rank_of(comm) == 0) print_warnings(simulation.warnings());
  make_folder(comm, settings.folder);
  settings.input_digest = input->digest + " " + state_hash(simulation.model());
  Reporter reporter(simulation, *input, settings);
  if (options.resume && !simulation.clock().running() && rank_of(comm) == 0)
    fmt::print(
        "note: the run that is resumed stands at cycle {}, {:.6g} s, and has come to {} already; no cycle is left "
        "to make; raise it to go on\n",
        simulation.clock().cycle(), simulation.clock().time(),
        simulation.clock().at_end() ? fmt::format("time.end ({:.6g} s)", input->time.end)
                                    : fmt::format("time.maximum_cycles ({})", input->time.maximum_cycles));
  try {
    simulation.run();
  } catch (const PhysicsError& e) {
    reporter.finish(e.what());
    return fail(comm, {fmt::format("{}: error: the run stopped: {}", options.input, e.what())}, exit_physics);
  }
  reporter.finish(simulation.stopped_by_signal() ? "signal" : "completed");
  if (simulation.stopped_by_signal())
    return fail(comm, {"stopped by a signal; go on with: " + resuming(options, settings.folder)}, exit_signal);
  return exit_done;
}

}  // namespace

int run_command(const RunOptions& options, Registry& registry) {
  int argc = 0;
  char** argv = nullptr;
  const ParallelRuntime runtime(argc, argv);
  try {
    return run(runtime.comm(), options, registry);
  } catch (const InputError& e) {
    return fail(runtime.comm(), e.lines(), exit_input_error);
  } catch (const PhysicsError& e) {  // before the first step
    return fail(runtime.comm(), {fmt::format("{}: error: the run cannot start: {}", options.input, e.what())},
                exit_physics);
  } catch (const std::exception& e) {
    // Thrown on one rank only, perhaps: the others may be waiting for it.
    fmt::print(stderr, "error: rank {}: {}\n", rank_of(runtime.comm()), e.what());
    std::fflush(stderr);
    if (size_of(runtime.comm()) > 1) MPI_Abort(runtime.comm(), exit_other);
    return exit_other;
  }
}

}  // namespace kerf
