// The contract of balance policies: whether the mesh is re-balanced now.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "kerf/plugin.hpp"

namespace kerf {

/// A re-balance of this run.
struct BalanceMove {
  std::int64_t cycle = 0;
  double imbalance_before = 1.0, imbalance_after = 1.0;
  std::int64_t elements_moved = 0;
  double seconds = 0.0;  // wall time of rank 0. A decision that hangs on it is not the same in the next run [s]
};

/// What a policy sees after a cycle.
struct BalanceState {
  std::int64_t cycle = 0;
  double time = 0.0;  // at the end of the step [s]
  double cycles_left = 0.0;  // to the end of the run, if steps stay as long as this one
  int n_ranks = 1;
  std::int64_t n_elements = 0;  // that live, on all ranks
  double imbalance = 1.0;  // greatest over mean work of the ranks, from the work model
  double mean_work = 0.0;  // of the ranks, in element cycles of hex8 with an elastic-plastic material
  std::int64_t cycles_since_move = 0;  // since the last re-balance, or since the start of the run
  /// Since the run was started or resumed; the first distribution is among them, with cycle 0.
  std::span<const BalanceMove> moves;
};

/// Decides when elements migrate. The work of ranks is modelled, never measured, so that runs repeat; results do not
/// depend on the decision.
class BalancePolicy : public Plugin {
 public:
  /// Cycles between two questions: each costs two messages to all ranks. 0 for a policy that never moves. Asked once,
  /// on all ranks, before the first question and after restore().
  virtual std::int64_t check_interval() const = 0;
  /// Whether to re-balance after this cycle. Asked on rank 0, whose answer all ranks follow. An exception stops the run
  /// on all ranks with the policy's name: throw std::runtime_error with a sentence.
  virtual bool move(const BalanceState& state) = 0;
  /// Numbers that restart files carry, of the same count throughout a run; restore() gets them back.
  virtual std::vector<double> state() const { return {}; }
  virtual void restore(std::span<const double>) {}
};

}  // namespace kerf

KERF_SIZES(balance_policy, KERF_SIZE(BalanceMove), KERF_SIZE(BalanceState), KERF_SIZE(BalancePolicy))
