// Records the work of a run, on request, for predictions of how it would scale: meshes, contact, and what they cost.
#pragma once

#include <array>
#include <cstdint>
#include <string>
#include <vector>

#include "dynamics/simulation.hpp"
#include "report/recording_file.hpp"

namespace kerf {

/// Keeps the mesh of the beginning of an interval and the contact of its middle, and writes them at its end with the
/// work that the interval has cost. Work is time without messages and waiting, added up over ranks.
class WorkRecorder {
 public:
  /// Begins the file, or goes on with that of the run that is resumed. Throws InputError where the model has elements
  /// that are no hexahedra. Collective, as everything here.
  WorkRecorder(const std::string& path, const std::string& source, double interval, bool resume,
               const Simulation& simulation);
  /// A sentence about cycles of the run that is resumed and that the file does not know, or empty.
  const std::string& gap() const { return gap_; }
  /// After every step.
  void count(const Simulation& simulation);
  /// Ends the interval, which becomes a moment of the file, and begins the next.
  void write(const Simulation& simulation);
  /// Ends the last interval. Nothing follows, so nobody gathers the mesh once more.
  void finish(const Simulation& simulation);

 private:
  using Work = std::array<double, std::size(timer_table)>;
  void begin(const Simulation& simulation);
  void end(const Simulation& simulation);
  static Work work_of(const Simulation& simulation);
  void open(const std::string& path, bool resume, const Simulation& simulation);
  void gather_elements(const Simulation& simulation);
  void gather_contact(const Simulation& simulation);
  void gather_reaches(const Simulation& simulation);
  void count_searches(const ContactEngine::Counts& now);
  void add_costs(const Work& spent, std::int64_t n_nodes);
  void add_eroded(const std::vector<std::int64_t>& ids);

  std::string source_, gap_;
  double interval_;  // [s]
  RecordingFile file_;  // on rank 0
  // Of the present interval; the moment on rank 0.
  RecordedMoment moment_;
  std::vector<double> element_work_, element_loads_;  // per element: by the work model; loads on its faces
  std::vector<double> slave_candidates_;
  bool knows_contact_ = false;
  Work begun_{};  // at its beginning [s]
  std::int64_t n_rounds_ = 0;
  ContactEngine::Counts searches_begun_;
  ContactEngine::Renewed renewed_begun_;  // on this rank
  std::vector<std::int64_t> eroded_;  // ids, of this rank
  // Of all intervals.
  double node_seconds_ = 0.0, node_cycles_ = 0.0;
  std::int64_t record_bytes_ = 0;
};

}  // namespace kerf
