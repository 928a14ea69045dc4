// The choice of the time step.
#include "dynamics/clock.hpp"

#include <algorithm>

namespace kerf {

bool Clock::running() const {
  if (input_.maximum_cycles > 0 && cycle_ >= input_.maximum_cycles) return false;
  return !at_end();
}

bool Clock::at_end() const {
  // A remainder far below a step is round-off of the sum of steps.
  return !(input_.end - time_ > 1e-6 * std::max(last_dt_, 1e-12 * input_.end));
}

Step Clock::plan(double stable) const {
  Step s;
  s.cycle = cycle_ + 1;
  s.start = time_;
  s.last_dt = last_dt_;
  s.dt = input_.safety_factor * stable;
  const auto shorten = [&s](double dt, StepLimit limit) {
    if (!(dt < s.dt)) return;
    s.dt = dt;
    s.limit = limit;
  };
  if (last_dt_ > 0.0)
    shorten(input_.growth * last_dt_, StepLimit::growth);
  else if (input_.initial_step > 0.0)
    shorten(input_.initial_step, StepLimit::initial_step);
  if (input_.maximum_step > 0.0) shorten(input_.maximum_step, StepLimit::maximum_step);
  shorten(std::max(input_.end - time_, 0.0), StepLimit::end);
  if (!(s.dt > 0.0)) s.dt = last_dt_;
  return s;
}

Step Clock::advance(double stable) {
  const Step s = plan(stable);
  time_ = s.end();
  last_dt_ = s.dt;
  cycle_ = s.cycle;
  return s;
}

}  // namespace kerf
