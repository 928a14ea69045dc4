// `kerf run`: from an input file to a finished run, or to a clear end.
#include <fcntl.h>
#include <fmt/format.h>

#include <csignal>
#include <cstdio>
#include <cstdlib>
#include <filesystem>
#include <system_error>

#include "app/commands.hpp"
#include "app/failures.hpp"
#include "app/load_input.hpp"
#include "app/result_folder.hpp"
#include "core/activity.hpp"
#include "core/diagnostics.hpp"
#include "core/physics_error.hpp"
#include "dynamics/simulation.hpp"
#include "kerf/measure.hpp"
#include "output/collective.hpp"
#include "output/file.hpp"
#include "output/restart.hpp"
#include "parallel/communicator.hpp"
#include "parallel/runtime.hpp"
#include "report/reporter.hpp"
#include "report/state_hash.hpp"

namespace kerf {

namespace {

/// The command that goes on with a run.
std::string resuming(const RunOptions& options, const std::string& folder) {
  std::string command = fmt::format("kerf run {} --output {} --resume", options.input, folder);
  for (const std::string& plugin : options.plugins) command += " --plugin " + plugin;
  for (const std::string& text : options.overrides) command += fmt::format(" --set '{}'", text);
  return command;
}

/// Rank 0 looks: a shared file system may show a file to some ranks before others. Collective.
void require_restart_file(MPI_Comm comm, const std::string& folder) {
  const std::string newest = folder + "/restart/restart.h5";
  std::error_code unknown;
  const bool missing = rank_of(comm) == 0 && !std::filesystem::exists(newest, unknown) &&
                       !std::filesystem::exists(previous_restart(newest), unknown);
  if (greatest(comm, std::int64_t{missing ? 1 : 0}) == 0) return;
  throw InputError(
      {fmt::format("{}: error: there is no restart file to resume from; a run writes one at its end (unless "
                   "output.restart_at_end is false), when a signal stops it and, if output.restart_interval is given, "
                   "on the way; run without --resume, or name the folder of the earlier run with --output",
                   newest)});
}

/// A run that wrote over the run that it foresees from would take it away. Rank 0 looks. Collective.
void refuse_to_overwrite_foresight(MPI_Comm comm, const BalanceInput& balance, const std::string& folder) {
  if (balance.foresee.empty()) return;
  std::error_code unknown;
  const bool same = rank_of(comm) == 0 && std::filesystem::equivalent(balance.foresee, folder, unknown);
  if (greatest(comm, std::int64_t{same ? 1 : 0}) == 0) return;
  throw InputError(
      {fmt::format("{}: error: `foresee` names the folder that this run writes into, {}; expected that of "
                   "an earlier run, and another one for --output",
                   balance.foresee_origin, folder)});
}

/// A closed standard stream would give its number to the next file that is opened, and what is printed would end in
/// that file. Writing to a full pipe, or beyond a limit of file sizes, is a failure to report and no reason to die.
void secure_streams() {
  for (int stream = 0; stream <= 2; ++stream)
    if (fcntl(stream, F_GETFD) < 0 && open("/dev/null", O_RDONLY) < 0) std::abort();
  std::signal(SIGPIPE, SIG_IGN);
  std::signal(SIGXFSZ, SIG_IGN);
}

void note_that_nothing_is_left(MPI_Comm comm, const Simulation& simulation, const ModelInput& input) {
  const std::string note = fmt::format(
      "note: the run that is resumed stands at cycle {}, {:.6g} s, and has come to {} already; no cycle is left "
      "to make; raise it to go on\n",
      simulation.clock().cycle(), simulation.clock().time(),
      simulation.clock().at_end() ? fmt::format("time.end ({:.6g} s)", input.time.end)
                                  : fmt::format("time.maximum_cycles ({})", input.time.maximum_cycles));
  on_root(comm, [&] { print_now(note); });
}

int run_to_end(MPI_Comm comm, const RunOptions& options, const std::string& folder, Simulation& simulation,
               Reporter& reporter) {
  try {
    simulation.run();
  } catch (const PhysicsError& e) {
    const std::string line = fmt::format("{}: error: the run stopped: {}", options.input, e.what());
    try {
      reporter.finish(e.what());
    } catch (const OutputError&) {
      fail_together(comm, {line}, exit_physics);
      throw;
    }
    return fail_together(comm, {line}, exit_physics);
  }
  reporter.finish(simulation.stopped_by_signal() ? "signal" : "completed");
  if (simulation.stopped_by_signal())
    return fail_together(comm, {"stopped by a signal; go on with: " + resuming(options, folder)}, exit_signal);
  return exit_done;
}

int run(MPI_Comm comm, const RunOptions& options, Registry& registry) {
  refuse_lone_ranks(comm);
  const auto input = load_input(comm, options, registry);
  const activity::Task task("setting up and computing",
                            {input->checks.stall_limit, "checks.stall_limit", exit_physics});
  ReportSettings settings;
  settings.folder = result_folder(options);
  settings.input_name = options.input;
  settings.resume = options.resume;
  if (options.resume) require_restart_file(comm, settings.folder);
  refuse_to_overwrite_foresight(comm, input->balance, settings.folder);
  Simulation simulation(comm, *input);
  if (rank_of(comm) == 0) print_warnings(simulation.warnings());
  make_result_folder(comm, settings.folder);
  const FolderLock lock(comm, settings.folder);
  settings.plugin_files = registry.files();
  settings.input_digest = input->digest + " " + state_hash(simulation.model());
  const std::vector<std::string> before = simulation.warnings();
  Reporter reporter(simulation, *input, settings);
  if (rank_of(comm) == 0)
    print_warnings(
        {simulation.warnings().begin() + static_cast<std::ptrdiff_t>(before.size()), simulation.warnings().end()});
  if (options.resume && !simulation.clock().running()) note_that_nothing_is_left(comm, simulation, *input);
  try {
    return run_to_end(comm, options, settings.folder, simulation, reporter);
  } catch (const OutputError& e) {
    reporter.give_up(e.what());
    throw;
  }
}

}  // namespace

int run_command(const RunOptions& options, Registry& registry) {
  secure_streams();
  int argc = 0;
  char** argv = nullptr;
  const ParallelRuntime runtime(argc, argv);
  try {
    return run(runtime.comm(), options, registry);
  } catch (const InputError& e) {
    return fail_together(runtime.comm(), e.lines(), exit_input_error);
  } catch (const PhysicsError& e) {  // before the first step
    return fail_together(runtime.comm(), {fmt::format("{}: error: the run cannot start: {}", options.input, e.what())},
                         exit_physics);
  } catch (const OutputError& e) {
    return fail_together(runtime.comm(), {fmt::format("{}: error: the run stopped: {}", options.input, e.what())},
                         exit_other);
  } catch (const std::exception& e) {
    return fail_alone(runtime.comm(), e);
  }
}

}  // namespace kerf
