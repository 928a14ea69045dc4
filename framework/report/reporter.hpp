// Writes what a run tells its user: results, history, erosion log, restart files, progress lines, summary.
#pragma once

#include <memory>
#include <string>

#include "core/timers.hpp"
#include "dynamics/simulation.hpp"
#include "erosion/record.hpp"
#include "output/history.hpp"
#include "output/results.hpp"
#include "output/summary.hpp"
#include "report/balance_log.hpp"
#include "report/checkpoint.hpp"
#include "report/erosion_log.hpp"
#include "report/observer_host.hpp"
#include "report/result_fields.hpp"
#include "report/work_recorder.hpp"

namespace kerf {

struct ReportSettings {
  std::string folder;  // of all output files
  std::string input_name;  // for summary.json
  std::string input_digest;  // of everything that a restart may not change
  std::string plugin_files;  // see Registry::files()
  bool resume = false;
};

class Reporter final : public StepObserver {
 public:
  /// Opens the files. On resume, reads the restart file and cuts the other files back to it. Collective.
  Reporter(Simulation& simulation, const ModelInput& input, const ReportSettings& settings);
  ~Reporter() override;

  void before_forces(Model&, const Step& step) override { observers_.before_forces(step); }
  void after_forces(Model&, const Step& step) override { observers_.after_forces(step); }
  void after_step(Simulation& simulation, const Step& step) override;
  /// Last frame, last row, summary, closing table. `exit` is "completed", "signal", or what went wrong. Collective.
  void finish(const std::string& exit);
  /// After a failure of output: the summary, where there is still room for it. Collective.
  void give_up(const std::string& failure);

 private:
  void resume(const std::string& folder);
  void start_anew(const std::string& folder);
  OutputProgress read_newest_restart();
  void print(const std::string& text) const;
  void require_same_fields() const;
  void write_frame();
  void write_history(bool check);
  void write_restart();
  void progress_line();
  Summary summarise(const std::string& exit);
  void add_parts(Summary& summary);
  void add_measures(Summary& summary);
  void add_timers(Summary& summary);
  Timers::Time since_begin(std::size_t phase) const;
  void begin_recording();
  void write_erosions();
  std::string table_of(const Summary& summary) const;
  bool root() const { return simulation_.model().rank() == 0; }

  Simulation& simulation_;
  const ModelInput& input_;
  ReportSettings settings_;
  ObserverHost observers_;
  std::unique_ptr<ResultsWriter> results_;
  FrameWriter frames_;
  std::unique_ptr<HistoryWriter> history_;
  std::unique_ptr<ErosionLog> erosion_log_;
  std::unique_ptr<WorkRecorder> recorder_;  // where the input asks for one
  double next_recording_ = 0.0;  // [s]
  std::unique_ptr<BalanceLog> balance_log_;
  OutputProgress due_;
  Balance last_;
  double results_interval_ = 0.0, history_interval_ = 0.0, restart_interval_ = 0.0, start_seconds_ = 0.0;
  Timers::Times timers_begun_;  // at start_seconds_
  double next_progress_ = 0.0;
  static constexpr std::int64_t erosion_interval =
      50;  // cycles after which rows of erosion.csv are written at the latest
  bool has_erosions_ = false;  // that are not written yet, on any rank
  std::int64_t last_history_cycle_ = -1, last_frame_cycle_ = -1, last_restart_cycle_ = -1;
  void count_eroded(const std::vector<ErosionRecord>& records);

  // Elements eroded by this rank, per part and position of the criterion in the part's list of at most eight.
  std::vector<std::int64_t> eroded_by_;
  std::int64_t first_element_cycles_ = 0;
};

}  // namespace kerf
