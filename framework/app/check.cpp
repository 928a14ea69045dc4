// `kerf check`: everything that can be known about a run before its first step.
#include <fmt/format.h>

#include <algorithm>
#include <cstdio>

#include "app/commands.hpp"
#include "app/failures.hpp"
#include "app/load_input.hpp"
#include "core/activity.hpp"
#include "core/diagnostics.hpp"
#include "core/physics_error.hpp"
#include "dynamics/simulation.hpp"
#include "kerf/measure.hpp"
#include "mesh/quality.hpp"
#include "parallel/communicator.hpp"
#include "parallel/runtime.hpp"
#include "report/observer_host.hpp"

namespace kerf {

namespace {

/// Mesh quality of all parts.
void print_meshes(const ModelInput& input) {
  fmt::print("{:<16}{:>12}{:>12}{:>15}{:>15}{:>16}\n", "part", "elements", "nodes", "smallest edge", "largest edge",
             "scaled Jacobian");
  for (const auto& part : input.parts) {
    const MeshReport r = assess(*part->mesh);
    fmt::print("{:<16}{:>12}{:>12}{:>13.4g} m{:>13.4g} m{:>16.3f}\n", part->name, r.n_elements, r.n_nodes,
               r.smallest_edge, r.largest_edge, r.min_scaled_jacobian);
  }
  std::fflush(stdout);
}

/// Of all ranks together [bytes]. Collective.
double memory_of(const Model& model) {
  std::size_t bytes = 0;
  for (const PartModel& p : model.parts) bytes += p.store->bytes();
  // Nodes: the stores, the index, and the surface's neighbours.
  bytes += static_cast<std::size_t>(model.nodes.n()) * (sizeof(NodeRecord) + 160);
  bytes += static_cast<std::size_t>(model.n_live_local()) * 24;
  return static_cast<double>(sum_of(model.comm, static_cast<std::int64_t>(bytes)));
}

/// How many cycles a run takes whose steps stay as long as elements allow at the start. What shortens the first step
/// alone (contact, time.initial_step) does not count.
double cycles_of(const Simulation& simulation, const TimeInput& time) {
  double dt = simulation.first_stable_step() * time.safety_factor;
  if (time.maximum_step > 0.0) dt = std::min(dt, time.maximum_step);
  const double cycles = std::max(1.0, time.end / dt);
  return time.maximum_cycles > 0 ? std::min(cycles, static_cast<double>(time.maximum_cycles)) : cycles;
}

/// One restart file holds every node and element with all its state [bytes].
double restart_size(const Model& model) {
  double bytes = static_cast<double>(model.n_nodes) * 23.0 * 8.0;
  for (const PartModel& p : model.parts)
    bytes += static_cast<double>(p.n_elements) * (9.0 + static_cast<double>(p.store->record_size())) * 8.0;
  return bytes;
}

void print_report(Simulation& simulation, const ModelInput& input, double memory) {
  const Model& model = simulation.model();
  const double results = input.output.results_interval > 0.0 ? input.output.results_interval : input.time.end / 20.0;
  const double frames = std::ceil(input.time.end / results - 1e-9) + 1.0;  // the last state is always written
  const double bytes_per_value = input.output.precision == "double" ? 8.0 : 4.0;
  double node_values = 3.0, element_values = 0.0;
  for (const std::string& f : input.output.node_fields) node_values += f == "mass" ? 1.0 : 3.0;
  for (const std::string& f : input.output.element_fields) element_values += f == "stress" ? 6.0 : 1.0;
  const double frame = static_cast<double>(model.n_nodes) * node_values * bytes_per_value +
                       static_cast<double>(model.n_elements) * (element_values * bytes_per_value + 2.0);
  fmt::print("\nelements             {}\nnodes                {}\n", model.n_elements, model.n_nodes);
  fmt::print("first time step      {:.4g} s, set by {}\n", simulation.next_step().dt, simulation.next_step_setter());
  fmt::print("cycles, about        {:.0f}\n", cycles_of(simulation, input.time));
  fmt::print("memory, about        {:.1f} MB\n", memory * 1e-6);
  fmt::print("output, about        {:.1f} MB in {:.0f} frames\n",
             (frame * frames + static_cast<double>(model.n_elements) * 84.0) * 1e-6, frames);
  const int restarts = input.output.restart_interval > 0.0 ? 2 : input.output.restart_at_end ? 1 : 0;
  fmt::print("restart, about       {:.1f} MB in {} file{}\n", restarts * restart_size(model) * 1e-6, restarts,
             restarts == 1 ? "" : "s");
  fmt::print("mass                 {:.6g} kg\n", simulation.ledger().initial_mass);
  const Ledger& ledger = simulation.ledger();
  fmt::print("kinetic energy       {:.6g} J\n", ledger.initial_energy - ledger.initial_internal);
  fmt::print("internal energy      {:.6g} J\n", ledger.initial_internal);
  fmt::print("initial penetration  {}\n",
             simulation.n_overlaps() == 0 ? "none" : "parts overlap that no contact keeps apart; see the warnings");
}

}  // namespace

int check_command(const RunOptions& options, Registry& registry) {
  int argc = 0;
  char** argv = nullptr;
  const ParallelRuntime runtime(argc, argv);
  const bool root = rank_of(runtime.comm()) == 0;
  try {
    const auto input = load_input(runtime.comm(), options, registry);
    const activity::Task task("setting up the model", {input->checks.stall_limit, "checks.stall_limit", exit_physics});
    if (root) fmt::print("{}", input->source_report);
    if (root) print_meshes(*input);
    Simulation simulation(runtime.comm(), *input);
    const ObserverHost observers(simulation, *input);  // throws where one of them cannot start
    const double memory = memory_of(simulation.model());
    if (root) print_report(simulation, *input, memory);
    if (root) print_warnings(simulation.warnings());
    return exit_done;
  } catch (const InputError& e) {
    return fail_together(runtime.comm(), e.lines(), exit_input_error);
  } catch (const PhysicsError& e) {
    return fail_together(runtime.comm(), {fmt::format("{}: error: the run cannot start: {}", options.input, e.what())},
                         exit_physics);
  } catch (const std::exception& e) {
    return fail_alone(runtime.comm(), e);
  }
}

}  // namespace kerf
