// Asks the policy when the mesh is to be re-balanced, and does it.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "kerf/balance_policy.hpp"
#include "model/model.hpp"
#include "model/step.hpp"

namespace kerf {

/// What a policy keeps, and which type has kept it.
struct PolicyProgress {
  std::string type;
  std::vector<double> numbers;
};

class Balancer {
 public:
  explicit Balancer(const BalanceInput& input) : input_(input) {}

  /// Distributes the generated or restored mesh for the first time. Collective.
  void distribute(Model& model) { move(model, 0); }
  /// Whether to re-balance after this step; `cycles_left` is an estimate. Throws PhysicsError on all ranks where the
  /// policy throws. Collective, the same on all ranks.
  bool due(const Model& model, const Step& step, double cycles_left);
  /// Partitions and migrates. Collective.
  void move(Model& model, std::int64_t cycle);

  /// Max over mean of the work of all ranks, from the work model. Collective.
  static double imbalance(const Model& model);
  const std::vector<BalanceMove>& records() const { return records_; }
  std::int64_t last_cycle() const { return last_cycle_; }
  /// What restart files keep beside the last cycle: rank 0's, whose policy is asked. Collective.
  PolicyProgress policy_progress(MPI_Comm comm) const;
  /// The numbers of another type of policy are not taken up: how a model is distributed may change at a restart.
  void restore(std::int64_t last_cycle, const PolicyProgress& progress);

 private:
  /// A partitioner that cannot answer on one rank must not pass unheard. Collective.
  void refuse_on_one_rank(Model& model) const;
  bool ask(const Model& model, const Step& step, double cycles_left);

  const BalanceInput& input_;
  std::int64_t last_cycle_ = 0;
  std::int64_t interval_ = -1;  // cycles between two questions; -1 until it is known
  std::vector<BalanceMove> records_;
};

}  // namespace kerf
