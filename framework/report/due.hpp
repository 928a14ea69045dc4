// When output that comes at intervals is due.
#pragma once

#include "input/model_input.hpp"

namespace kerf {

/// The first of the times due, due + interval, due + 2 interval, ... after `now`. Where these are closer than numbers
/// can tell, a later time than `now`, so that every cycle is due.
inline double next_due(double due, double interval, double now) {
  constexpr int many = 100000;
  for (int i = 0; i < many && due <= now; ++i) due += interval;
  return due > now ? due : now + interval;
}

/// How much before the due time counts as having reached it [s].
inline double due_tolerance(const TimeInput& time) { return 1e-9 * time.end; }

/// Time between two rows of the history [s].
inline double history_interval(const OutputInput& output, const TimeInput& time) {
  return output.history_interval > 0.0 ? output.history_interval : time.end / 200.0;
}

}  // namespace kerf
