// Runs the observers of the input: when each is due, its columns in history.h5, its numbers in summary.json.
#pragma once

#include <memory>
#include <string>
#include <vector>

#include "dynamics/simulation.hpp"
#include "kerf/observer.hpp"
#include "output/columns.hpp"
#include "output/summary.hpp"
#include "report/observed_model.hpp"

namespace kerf {

/// What a restart file keeps of an observer.
struct ObserverProgress {
  std::string name;
  std::vector<double> numbers;  // when its next row is due, then its state
};

/// All functions are collective.
class ObserverHost final : public ForceSource {
 public:
  /// Prepares the observers. Pre: the simulation is at time zero. Throws InputError with all complaints.
  ObserverHost(Simulation& simulation, const ModelInput& input);

  /// Begins history.h5 in the folder, or removes one of an earlier run where nobody fills columns; writes first rows.
  void start(const std::string& folder);
  /// Takes up the states of observers, and goes on with history.h5. Throws InputError where the input has
  /// others.
  void resume(const std::string& folder, const std::vector<ObserverProgress>& progress);
  bool adds_forces() const override;
  void add_forces(const Step& step, const AddForce& add) override;
  void before_forces(const Step& step);
  void after_forces(const Step& step);
  /// Calls the observers that want every cycle or are due. Throws PhysicsError where an observer throws.
  void after_step(const Step& step);
  /// Last rows, and closes the file.
  void finish();
  /// Waits until all rows are on the disk.
  void sync();
  std::vector<ObserverProgress> progress() const;
  void add_to(Summary& summary);

 private:
  struct Seat {
    Observer* observer = nullptr;
    ObserverCalls calls;
    std::vector<ObservedColumn> columns;
    std::ptrdiff_t table = -1;  // in the file; -1 without columns
    double interval = 0.0, due = 0.0;  // [s]
    std::int64_t last_cycle = -1;  // of its last row
    std::size_t n_state = 0;
  };
  std::string prepare(Seat& seat);
  template <class Work>
  void call(Seat& seat, const char* what, const Work& work);
  void sample(Seat& seat);
  void show(const Step& step) { view_.refresh(step.end(), step.dt, step.cycle); }
  std::vector<ColumnTable> tables() const;

  Simulation& simulation_;
  const ModelInput& input_;
  SimulationView view_;
  std::vector<Seat> seats_;
  std::unique_ptr<ColumnFile> file_;
  std::vector<std::string> failures_;  // sentences about observers that were stopped
};

}  // namespace kerf
