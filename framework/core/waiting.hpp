// The time that this rank has spent in messages: sending, receiving, and waiting for other ranks.
//
// One number for the whole program, as in core/activity.hpp: whoever sends a message is far from whoever keeps the
// time. One thread writes and reads it.
#pragma once

#include <chrono>

namespace kerf {

/// Counts the time until it goes out of scope as time in messages. Scopes may be nested: the outermost counts.
class Waiting {
 public:
  Waiting() : outermost_(depth_++ == 0) {
    if (outermost_) start_ = Clock::now();
  }
  Waiting(const Waiting&) = delete;
  Waiting& operator=(const Waiting&) = delete;
  ~Waiting() {
    --depth_;
    if (outermost_) total_ += std::chrono::duration<double>(Clock::now() - start_).count();
  }

  /// Of all scopes that have ended [s].
  static double seconds() { return total_; }

 private:
  using Clock = std::chrono::steady_clock;
  static inline double total_ = 0.0;
  static inline int depth_ = 0;
  bool outermost_;
  Clock::time_point start_;
};

}  // namespace kerf
