// When output is due, and the files and lines that it goes to.
#include "report/reporter.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "core/diagnostics.hpp"
#include "erosion/record.hpp"
#include "output/collective.hpp"
#include "output/file.hpp"
#include "output/restart.hpp"
#include "parallel/communicator.hpp"
#include "report/balance_log.hpp"
#include "report/due.hpp"
#include "report/erosion_log.hpp"
#include "report/result_fields.hpp"

namespace kerf {

namespace {

std::string restart_path(const std::string& folder) { return folder + "/restart/restart.h5"; }

std::vector<HistoryColumn> history_columns() {
  std::vector<HistoryColumn> columns;
  for (const BookLine& line : book_lines())
    if ((line.places & in_history) != 0) columns.push_back({line.name, line.unit});
  return columns;
}

// A run that is killed leaves neither a summary nor, if it started anew, a restart file: those of an earlier run would
// be taken for its own. The newest restart file goes first, so that a kill between the two leaves the earlier run with
// the older of them.
void remove_what_is_stale(const ReportSettings& settings) {
  remove_if_there(settings.folder + "/summary.json");
  if (settings.resume) return;
  remove_if_there(settings.folder + "/recording.h5");
  const std::string newest = restart_path(settings.folder);
  rename_if_there(newest, settings.folder + "/restart/earlier_run.h5");
  remove_if_there(previous_restart(newest));
}

/// The materials with all sets of the library written out: an input that holds this block instead gives the same run,
/// also when the library has changed.
void write_materials(const std::string& path, const ModelInput& input) {
  if (input.materials_text.empty())
    remove_if_there(path);
  else
    replace_file(
        path, "# Materials of this run, with the sets of the material library written out.\n" + input.materials_text);
}

double seconds_now() { return MPI_Wtime(); }

}  // namespace

Reporter::Reporter(Simulation& simulation, const ModelInput& input, const ReportSettings& settings)
    : simulation_(simulation),
      input_(input),
      settings_(settings),
      observers_(simulation, input),
      frames_(simulation.model(), input.output) {
  const OutputInput& o = input.output;
  results_interval_ = o.results_interval > 0.0 ? o.results_interval : input.time.end / 20.0;
  history_interval_ = history_interval(o, input.time);
  restart_interval_ = o.restart_interval;
  const Model& model = simulation.model();
  on_root(model.comm, [&] { make_folder(settings.folder); });
  eroded_by_.assign(8 * model.parts.size(), 0);
  if (settings.resume)
    resume(settings.folder + "/");
  else
    start_anew(settings.folder + "/");
  on_root(model.comm, [&] { write_materials(settings.folder + "/materials.yaml", input); });
  begin_recording();
  simulation.observe(*this);
  start_seconds_ = seconds_now();
  timers_begun_ = simulation.timers().all();
  print(fmt::format("{} elements, {} nodes, {} rank{}; first stable step {:.4g} s\n", model.n_elements, model.n_nodes,
                    model.n_ranks(), model.n_ranks() == 1 ? "" : "s", simulation.first_stable_step()));
}

/// A run that is resumed goes on with the recording of the cycles before. Without an interval it leaves that alone.
void Reporter::begin_recording() {
  const double interval = input_.output.recording_interval;
  if (!(interval > 0.0)) return;
  recorder_ = std::make_unique<WorkRecorder>(settings_.folder + "/recording.h5", settings_.input_name, interval,
                                             settings_.resume, simulation_);
  if (!recorder_->gap().empty()) simulation_.warn(recorder_->gap());
  next_recording_ = next_due(interval, interval, simulation_.clock().time() + due_tolerance(input_.time));
}

void Reporter::start_anew(const std::string& folder) {
  const Model& model = simulation_.model();
  on_root(model.comm, [&] { remove_what_is_stale(settings_); });
  results_ = std::make_unique<ResultsWriter>(model.comm, folder + "results.vtkhdf", model.n_nodes, model.n_elements,
                                             input_.output.precision == "double");
  history_ = std::make_unique<HistoryWriter>(model.comm, folder + "history.csv", history_columns());
  erosion_log_ = std::make_unique<ErosionLog>(model.comm, folder + "erosion.csv");
  balance_log_ = std::make_unique<BalanceLog>(model.comm, folder + "balance.csv");
  write_topology(model, *results_);
  write_frame();
  write_history(false);
  observers_.start(folder);
  due_.plugin_files = settings_.plugin_files;
  due_.next_results = results_interval_;
  due_.next_history = history_interval_;
  due_.next_restart = restart_interval_;
}

void Reporter::resume(const std::string& folder) {
  const Model& model = simulation_.model();
  due_ = read_newest_restart();
  if (due_.knows_plugins && due_.plugin_files != settings_.plugin_files)
    simulation_.warn(
        "warning: the run began with other plugins, or with other builds of them, than it goes on with; what "
        "comes is computed by the present ones, and its bits are not those of one run");
  due_.plugin_files = settings_.plugin_files;
  on_root(model.comm, [&] { remove_what_is_stale(settings_); });
  if (root()) eroded_by_ = due_.eroded_by;
  first_element_cycles_ = simulation_.element_cycles();
  const double time = simulation_.clock().time();
  results_ = std::make_unique<ResultsWriter>(
      ResultsWriter::reopen(model.comm, folder + "results.vtkhdf", static_cast<int>(due_.n_frames)));
  require_same_fields();  // before the tables are cut back
  history_ = std::make_unique<HistoryWriter>(
      HistoryWriter::resume(model.comm, folder + "history.csv", history_columns(), time));
  erosion_log_ = std::make_unique<ErosionLog>(ErosionLog::resume(model.comm, folder + "erosion.csv", time));
  balance_log_ = std::make_unique<BalanceLog>(BalanceLog::resume(model.comm, folder + "balance.csv", time));
  observers_.resume(folder, due_.observers);
  last_ = simulation_.sample();
  // What the earlier run has written of this moment is not written again.
  if (results_->last_time() == time) last_frame_cycle_ = simulation_.clock().cycle();
  if (history_->last_time() == time) last_history_cycle_ = simulation_.clock().cycle();
}

/// Goes on from the restart file before the newest where that is absent or damaged, and says so. All ranks take the
/// same, since a file is found damaged by all of them or by none.
OutputProgress Reporter::read_newest_restart() {
  const std::string newest = restart_path(settings_.folder), previous = previous_restart(newest);
  std::string reason;
  try {
    OutputProgress progress = read_checkpoint(newest, settings_.input_digest, simulation_);
    last_restart_cycle_ = simulation_.clock().cycle();
    return progress;
  } catch (const OutputError& e) {
    reason = e.what();
  }
  try {
    OutputProgress progress = read_checkpoint(previous, settings_.input_digest, simulation_);
    print(fmt::format("note: {}; going on from the restart file before it, {}\n", reason, previous));
    // Out of the way: it must not take the place of the good one when the next file is written.
    on_root(simulation_.model().comm,
            [&] { rename_if_there(newest, settings_.folder + "/restart/restart_damaged.h5"); });
    return progress;
  } catch (const OutputError& e) {
    throw InputError(
        {fmt::format("{}: error: there is no restart file that can be used: {}; and {}; run without "
                     "--resume",
                     newest, reason, e.what())});
  }
}

void Reporter::print(const std::string& text) const {
  on_root(simulation_.model().comm, [&] { print_now(text); });
}

Reporter::~Reporter() = default;

/// A file that goes on holds the fields that it began with. Otherwise throws InputError, on all ranks.
void Reporter::require_same_fields() const {
  const auto require = [&](const char* key, std::vector<std::string> wanted, std::vector<std::string> there) {
    std::sort(wanted.begin(), wanted.end());
    std::sort(there.begin(), there.end());
    if (wanted == there) return;
    throw InputError(
        {fmt::format("{}/results.vtkhdf: error: the run that is resumed has begun it in another way; expected "
                     "output.{} to be [{}]",
                     settings_.folder, key, fmt::join(there, ", "))});
  };
  std::vector<std::string> elemental = results_->element_fields();
  for (const char* always : {"alive", "vtkGhostType"}) std::erase(elemental, always);
  require("precision", {input_.output.precision}, {results_->double_precision() ? "double" : "single"});
  require("node_fields", input_.output.node_fields, results_->node_fields());
  require("element_fields", input_.output.element_fields, elemental);
}

void Reporter::after_step(Simulation& simulation, const Step& step) {
  observers_.after_step(step);
  const auto scope = simulation.timers().measure("output");
  if (simulation.any_eroded()) {
    count_eroded(simulation.eroded_now());
    erosion_log_->keep(simulation.eroded_now());
    has_erosions_ = true;
  }
  if (step.cycle % erosion_interval == 0) write_erosions();
  const double tolerance = due_tolerance(input_.time);
  if (step.end() >= due_.next_history - tolerance) {
    due_.next_history = next_due(due_.next_history, history_interval_, step.end() + tolerance);
    write_history(true);
  }
  if (step.end() >= due_.next_results - tolerance) {
    due_.next_results = next_due(due_.next_results, results_interval_, step.end() + tolerance);
    write_frame();
  }
  if (recorder_) {
    recorder_->count(simulation);
    if (step.end() >= next_recording_ - tolerance) {
      next_recording_ = next_due(next_recording_, input_.output.recording_interval, step.end() + tolerance);
      recorder_->write(simulation);
    }
  }
  if (restart_interval_ > 0.0 && step.end() >= due_.next_restart - tolerance) {
    due_.next_restart = next_due(due_.next_restart, restart_interval_, step.end() + tolerance);
    write_restart();
  }
  const std::int64_t every = input_.output.progress_interval;
  const double share = step.end() / input_.time.end;
  if (every > 0 ? step.cycle % every == 0 : share >= next_progress_) {
    next_progress_ = std::floor(share * 20.0 + 1.0) / 20.0;
    progress_line();
  }
}

void Reporter::count_eroded(const std::vector<ErosionRecord>& records) {
  const auto& parts = simulation_.model().parts;
  for (const ErosionRecord& r : records)
    for (std::size_t p = 0; p < parts.size(); ++p) {
      if (parts[p].input->name != r.part) continue;
      const auto& criteria = parts[p].material->erosion->criteria;
      for (std::size_t c = 0; c < criteria.size(); ++c)
        if (criteria[c]->type == r.criterion) {
          ++eroded_by_[8 * p + c];
          break;
        }
    }
}

/// Writes what has been kept of erosions and decisions. What there is to write is known to all ranks. Collective.
void Reporter::write_erosions() {
  if (has_erosions_) erosion_log_->write();
  has_erosions_ = false;
  balance_log_->write(simulation_.balancer().decisions());
}

void Reporter::write_frame() {
  write_erosions();
  frames_.write(simulation_.clock().time(), *results_);
  last_frame_cycle_ = simulation_.clock().cycle();
}

void Reporter::write_history(bool check) {
  write_erosions();
  last_ = simulation_.sample();
  last_history_cycle_ = simulation_.clock().cycle();
  last_.dt = simulation_.clock().last_dt();
  last_.imbalance = simulation_.balancer().imbalance(simulation_.model());
  std::vector<double> row;
  for (const BookLine& line : book_lines())
    if ((line.places & in_history) != 0) row.push_back(line.value(last_));
  history_->write(row);
  if (check) simulation_.check(last_);
}

void Reporter::write_restart() {
  on_root(simulation_.model().comm, [&] { make_folder(settings_.folder + "/restart"); });
  history_->sync();  // rows up to the time of the restart file must be there when it is
  observers_.sync();
  write_erosions();
  erosion_log_->sync();
  balance_log_->sync();
  if (recorder_)
    recorder_->write(simulation_);  // a moment ends here, so that a run that is resumed goes on with another
  due_.n_frames = results_->n_frames();
  due_.observers = observers_.progress();
  due_.eroded_by = eroded_by_;
  MPI_Allreduce(MPI_IN_PLACE, due_.eroded_by.data(), static_cast<int>(due_.eroded_by.size()), MPI_INT64_T, MPI_SUM,
                simulation_.model().comm);
  write_checkpoint(restart_path(settings_.folder), settings_.input_digest, simulation_, due_);
  last_restart_cycle_ = simulation_.clock().cycle();
}

void Reporter::progress_line() {
  const double imbalance = simulation_.balancer().imbalance(simulation_.model());
  const double elapsed = seconds_now() - start_seconds_;
  const double share = simulation_.clock().time() / input_.time.end;
  if (last_history_cycle_ != simulation_.clock().cycle()) last_ = simulation_.sample();
  print(
      fmt::format("cycle {:7d}  t {:.4e} s  dt {:.3e} s ({})  energy {:+.3f} %  eroded {:6d}  {}imbalance {:.3f}  "
                  "elapsed {:.1f} s  left {:.0f} s\n",
                  simulation_.clock().cycle(), simulation_.clock().time(), simulation_.clock().last_dt(),
                  simulation_.last_step_setter(), 100.0 * last_.error, last_.eroded_elements,
                  last_.let_go.nodes > 0 ? fmt::format("let go {:d}  ", last_.let_go.nodes) : "", imbalance, elapsed,
                  share > 0.0 ? elapsed * (1.0 - share) / share : 0.0));
}

void Reporter::finish(const std::string& exit) {
  {
    const auto scope = simulation_.timers().measure("output");
    if (last_history_cycle_ != simulation_.clock().cycle()) write_history(false);
    if (last_frame_cycle_ != simulation_.clock().cycle()) write_frame();
    observers_.finish();
    write_erosions();
    if (recorder_) recorder_->finish(simulation_);
    const bool wanted = exit == "signal" || (exit == "completed" && input_.output.restart_at_end);
    if (wanted && last_restart_cycle_ != simulation_.clock().cycle()) write_restart();
    results_->close();
    history_->close();
    erosion_log_->close();
    balance_log_->close();
    results_.reset();  // makes room for what measures need
  }
  // A run that was stopped says what is wrong already.
  std::vector<std::string> doubts;
  if (exit == "completed") doubts = simulation_.judge_end();
  if (root())
    for (const std::string& line : doubts) fmt::print(stderr, "{}\n", line);
  const Summary summary = summarise(exit);
  on_root(simulation_.model().comm, [&] {
    write_summary(settings_.folder + "/summary.json", summary);
    print_now(table_of(summary));
  });
}

void Reporter::give_up(const std::string& failure) {
  try {
    write_erosions();
  } catch (const OutputError&) {  // the failure that counts is on its way already
  }
  results_.reset();
  const Summary summary = summarise(failure);
  if (!root()) return;
  try {
    write_summary(settings_.folder + "/summary.json", summary);
  } catch (const std::exception&) {  // the failure that counts is on its way already
  }
}

}  // namespace kerf
