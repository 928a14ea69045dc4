// What the program is doing, for the one sentence that it can still say when it crashes or stands still.
//
// The only state here that is not the caller's: a handler of signals can be handed nothing. One thread writes it, the
// one that computes; a handler in that thread and the watch over its progress read it.
#pragma once

#include <atomic>
#include <cstdint>
#include <string>

namespace kerf::activity {

/// How long nothing may happen in a run unless its input says otherwise [s].
inline constexpr double default_limit = 600.0;

inline std::atomic<const char*> task{"starting"};  // continues "while ..."
inline std::atomic<const char*> phase{nullptr};  // of timer_table; null outside of all
inline std::atomic<std::int64_t> cycle{0};
inline std::atomic<int> rank{-1};  // -1 where it is not known
inline std::atomic<std::uint64_t> beats{0};  // grows whenever something has been done
inline std::atomic<double> limit{0.0};  // without a beat, after which the program is stopped [s]; 0 for none
inline std::atomic<const char*> limit_name{""};  // where a user sets it
inline std::atomic<int> exit_code{1};  // when it is passed

/// How long a task may stand still, where a user sets it, and how the program ends then. The name is a constant.
struct Limit {
  double seconds;
  const char* name;
  int exit_code;
};

/// Something has been done. One store, so that the innermost loops of phases may call it.
inline void beat() { beats.store(beats.load(std::memory_order_relaxed) + 1, std::memory_order_relaxed); }

inline void begin_cycle(std::int64_t number) { cycle.store(number, std::memory_order_relaxed); }

/// Names the phase until it goes out of scope.
class Phase {
 public:
  explicit Phase(const char* name) : before_(phase.load(std::memory_order_relaxed)) {
    phase.store(name, std::memory_order_relaxed);
    beat();
  }
  Phase(const Phase&) = delete;
  Phase& operator=(const Phase&) = delete;
  ~Phase() {
    phase.store(before_, std::memory_order_relaxed);
    beat();
  }

 private:
  const char* before_;
};

/// Names the task and its limit until it goes out of scope.
class Task {
 public:
  Task(std::string text, const Limit& of_task)
      : text_(std::move(text)), task_before_(task), limit_before_{limit, limit_name, exit_code} {
    set(text_.c_str(), of_task);
  }
  Task(const Task&) = delete;
  Task& operator=(const Task&) = delete;
  ~Task() { set(task_before_, limit_before_); }

 private:
  static void set(const char* text, const Limit& now) {
    task = text;
    exit_code = now.exit_code;
    limit_name = now.name;
    beat();  // before the limit: whoever sees a shorter one must see that its time begins now
    limit = now.seconds;
  }
  std::string text_;
  const char* task_before_;
  Limit limit_before_;
};

}  // namespace kerf::activity
