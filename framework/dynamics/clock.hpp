// Keeps time: chooses each step from what is stable, and says when the run is over.
#pragma once

#include <cstdint>

#include "input/model_input.hpp"
#include "model/step.hpp"

namespace kerf {

class Clock {
 public:
  explicit Clock(const TimeInput& input) : input_(input) {}

  bool running() const;
  /// Whether the end time has been reached.
  bool at_end() const;
  /// The step that would follow, given the least stable step of all elements [s].
  Step plan(double stable) const;
  Step advance(double stable);

  double time() const { return time_; }
  double last_dt() const { return last_dt_; }
  std::int64_t cycle() const { return cycle_; }
  void restore(double time, double last_dt, std::int64_t cycle) {
    time_ = time;
    last_dt_ = last_dt;
    cycle_ = cycle;
  }

 private:
  const TimeInput& input_;
  double time_ = 0.0, last_dt_ = 0.0;
  std::int64_t cycle_ = 0;
};

}  // namespace kerf
