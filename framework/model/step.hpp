// One time step, as all phases see it.
#pragma once

#include <cstdint>

namespace kerf {

/// What a step is limited by: what is stable, or a key of the input's block `time`.
enum class StepLimit { stable, growth, initial_step, maximum_step, end };

struct Step {
  std::int64_t cycle = 0;  // number of the step, from 1
  double start = 0.0;  // [s]
  double dt = 0.0;  // positions advance by this [s]
  double last_dt = 0.0;  // the step before, 0 for the first [s]
  StepLimit limit = StepLimit::stable;

  double end() const { return start + dt; }
  double kick_dt() const { return 0.5 * (last_dt + dt); }  // velocities advance by this [s]
};

}  // namespace kerf
