// Wall-clock time spent in named phases; a handful of additions per cycle.
#pragma once

#include <array>
#include <chrono>
#include <cstddef>
#include <string_view>

#include "core/activity.hpp"
#include "core/marks.hpp"
#include "core/waiting.hpp"

namespace kerf {

/// A phase of a run that is timed.
struct TimerInfo {
  const char* name;
  const char* doc;  // half a sentence for the manual
  bool in_step = true;  // whether every step needs it
};

/// All phases. A new timer is one line here; summary.json, the console and the manual follow.
inline constexpr TimerInfo timer_table[] = {
    {"setup", "meshes, masses, the first distribution", false},
    {"elements", "strains, laws and forces of elements"},
    {"nodes", "the kick and drift of nodes, boundary conditions"},
    {"contact_search", "looking for what may touch"},
    {"contact_forces", "what touches, and its forces"},
    {"loads", "forces of loads"},
    {"halo", "exchange of nodal forces, and the step's reduction"},
    {"erosion", "deleting elements, and the surface behind them"},
    {"rebalance", "moving elements between ranks", false},
    {"output", "results, histories, restart files", false},
    {"observers", "observers of the input, without the writing of their columns", false},
};

/// The place of a phase in timer_table. A name that is not there does not compile.
class TimerName {
 public:
  consteval TimerName(const char* name) : index_(place_of(name)) {}
  constexpr std::size_t index() const { return index_; }
  constexpr const char* name() const { return timer_table[index_].name; }
  constexpr int mark() const {
    return (timer_table[index_].in_step ? marks::phase : marks::beside) + 1 + static_cast<int>(index_);
  }

 private:
  static consteval std::size_t place_of(std::string_view name) {
    for (std::size_t i = 0; i < std::size(timer_table); ++i)
      if (timer_table[i].name == name) return i;
    throw "there is no such timer in timer_table";
  }
  std::size_t index_;
};

class Timers {
 public:
  using Clock = std::chrono::steady_clock;

  /// Time of one phase [s].
  struct Time {
    double total = 0.0, in_messages = 0.0;  // the second is part of the first
  };

  /// Adds the time until it goes out of scope to one phase, which is what the program is doing meanwhile.
  class Scope {
   public:
    Scope(Time& time, TimerName phase)
        : time_(time),
          start_(Clock::now()),
          in_messages_(Waiting::seconds()),
          mark_(marks::present),
          phase_(phase.name()) {
      marks::enter(phase.mark());
    }
    Scope(const Scope&) = delete;
    Scope& operator=(const Scope&) = delete;
    ~Scope() {
      time_.total += std::chrono::duration<double>(Clock::now() - start_).count();
      time_.in_messages += Waiting::seconds() - in_messages_;
      marks::enter(mark_);
    }

   private:
    Time& time_;
    Clock::time_point start_;
    double in_messages_;
    int mark_;  // of the phase before
    activity::Phase phase_;
  };

  Scope measure(TimerName phase) { return Scope(times_[phase.index()], phase); }
  /// Per entry of timer_table.
  using Times = std::array<Time, std::size(timer_table)>;
  const Times& all() const { return times_; }

 private:
  Times times_{};
};

}  // namespace kerf
