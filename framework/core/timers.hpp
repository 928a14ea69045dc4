// Wall-clock time spent in named phases; a handful of additions per cycle.
#pragma once

#include <chrono>
#include <map>
#include <string>

namespace kerf {

class Timers {
 public:
  using Clock = std::chrono::steady_clock;

  /// Adds the time until it goes out of scope to one phase.
  class Scope {
   public:
    explicit Scope(double& total) : total_(total), start_(Clock::now()) {}
    Scope(const Scope&) = delete;
    Scope& operator=(const Scope&) = delete;
    ~Scope() { total_ += std::chrono::duration<double>(Clock::now() - start_).count(); }

   private:
    double& total_;
    Clock::time_point start_;
  };

  Scope measure(const char* phase) { return Scope(seconds_[phase]); }
  double& seconds(const std::string& phase) { return seconds_[phase]; }
  const std::map<std::string, double, std::less<>>& all() const { return seconds_; }

 private:
  std::map<std::string, double, std::less<>> seconds_;
};

}  // namespace kerf
