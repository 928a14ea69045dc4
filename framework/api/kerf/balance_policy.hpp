// The contract of balance policies: whether the mesh is re-balanced now.
#pragma once

#include <cstdint>
#include <limits>
#include <span>
#include <string>
#include <vector>

#include "kerf/input_files.hpp"
#include "kerf/plugin.hpp"

namespace kerf {

/// A re-balance of this run.
struct BalanceMove {
  std::int64_t cycle = 0;
  double imbalance_before = 1.0, imbalance_after = 1.0;
  std::int64_t elements_moved = 0;
  double seconds = 0.0;  // wall time of rank 0. A decision that hangs on it is not the same in the next run [s]
  double modelled_cost = 0.0;  // by the work model, in element cycles
  bool first = false;  // the distribution at the start, or at the start of a resumed run
};

/// What a re-balance costs every rank, by the work model, in element cycles.
struct MoveCost {
  double fixed = 0.0;
  double per_element = 0.0;  // that a rank holds, whether or not it moves
  double per_moved = 0.0;  // that leaves a rank
  double of(double elements_per_rank, double moved_per_rank) const {
    return fixed + per_element * elements_per_rank + per_moved * moved_per_rank;
  }
};

/// The numbers that a policy has decided from, for balance.csv. NaN for those that it does not have.
struct BalanceReasons {
  double mean_imbalance = std::numeric_limits<double>::quiet_NaN();  // over the last looks
  double saving = std::numeric_limits<double>::quiet_NaN();  // of the slowest rank, in element cycles
  double cost = std::numeric_limits<double>::quiet_NaN();  // of a re-balance, in element cycles
  std::string reason;  // a word or a few, without commas
};

/// What a policy sees after a cycle.
struct BalanceState {
  std::int64_t cycle = 0;
  double time = 0.0;  // at the end of the step [s]
  double cycles_left = 0.0;  // to the end of the run, if steps stay as long as this one
  int n_ranks = 1;
  std::int64_t n_elements = 0;  // that live, on all ranks
  double imbalance = 1.0;  // greatest over mean work of the ranks, from the work model
  double mean_work = 0.0;  // of the ranks in a cycle, in element cycles of hex8 with an elastic-plastic material
  std::int64_t cycles_since_move = 0;  // since the last re-balance, or since the start of the run
  MoveCost move_cost;
  /// Since the run was started or resumed, first distributions included.
  std::span<const BalanceMove> moves;
};

/// Decides when elements migrate. The work of ranks is modelled, never measured, so that runs repeat; results do not
/// depend on the decision.
class BalancePolicy : public Plugin {
 public:
  /// Reads what the policy needs, when the input is read. Returns what is wrong, as whole lines such as "moves.csv:7:
  /// error: ...". Called on all ranks.
  virtual std::vector<std::string> prepare(const InputFiles& /*files*/) { return {}; }
  /// Cycles between two questions: each costs a message of rank 0 to all ranks. 0 for a policy that never moves. Asked
  /// once, on all ranks, before the first question and after restore().
  virtual std::int64_t check_interval() const = 0;
  /// Whether to re-balance after this cycle. Asked on rank 0, whose answer all ranks follow. An exception stops the run
  /// on all ranks with the policy's name: throw std::runtime_error with a sentence.
  virtual bool move(const BalanceState& state) = 0;
  /// Why the last answer was what it was.
  virtual BalanceReasons reasons() const { return {}; }
  /// Numbers that restart files carry, of the same count throughout a run; restore() gets them back.
  virtual std::vector<double> state() const { return {}; }
  virtual void restore(std::span<const double>) {}
};

}  // namespace kerf

KERF_SIZES(balance_policy, KERF_SIZE(BalanceMove), KERF_SIZE(MoveCost), KERF_SIZE(BalanceReasons),
           KERF_SIZE(BalanceState), KERF_SIZE(BalancePolicy))
