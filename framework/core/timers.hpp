// Wall-clock time spent in named phases; a handful of additions per cycle.
#pragma once

#include <array>
#include <chrono>
#include <cstddef>
#include <string_view>

#include "core/activity.hpp"

namespace kerf {

/// A phase of a run that is timed.
struct TimerInfo {
  const char* name;
  const char* doc;  // half a sentence for the manual
};

/// All phases. A new timer is one line here; summary.json, the console and the manual follow.
inline constexpr TimerInfo timer_table[] = {
    {"setup", "meshes, masses, the first distribution"},
    {"elements", "strains, laws and forces of elements"},
    {"nodes", "the kick and drift of nodes, boundary conditions"},
    {"contact_search", "looking for what may touch"},
    {"contact_forces", "what touches, and its forces"},
    {"loads", "forces of loads"},
    {"halo", "exchange of nodal forces, and the step's reduction"},
    {"erosion", "deleting elements, and the surface behind them"},
    {"rebalance", "moving elements between ranks"},
    {"output", "results, histories, restart files"},
    {"observers", "observers of the input, without the writing of their columns"},
};

/// The place of a phase in timer_table. A name that is not there does not compile.
class TimerName {
 public:
  consteval TimerName(const char* name) : index_(place_of(name)) {}
  constexpr std::size_t index() const { return index_; }
  constexpr const char* name() const { return timer_table[index_].name; }

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

  /// Adds the time until it goes out of scope to one phase, which is what the program is doing meanwhile.
  class Scope {
   public:
    Scope(double& total, const char* name) : total_(total), start_(Clock::now()), phase_(name) {}
    Scope(const Scope&) = delete;
    Scope& operator=(const Scope&) = delete;
    ~Scope() { total_ += std::chrono::duration<double>(Clock::now() - start_).count(); }

   private:
    double& total_;
    Clock::time_point start_;
    activity::Phase phase_;
  };

  Scope measure(TimerName phase) { return Scope(seconds_[phase.index()], phase.name()); }
  double seconds(TimerName phase) const { return seconds_[phase.index()]; }
  /// Seconds per entry of timer_table.
  const std::array<double, std::size(timer_table)>& all() const { return seconds_; }

 private:
  std::array<double, std::size(timer_table)> seconds_{};
};

}  // namespace kerf
