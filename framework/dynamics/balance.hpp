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

/// The work of ranks by the work model, in whole units, so that sums do not depend on any order.
struct RankWork {
  static constexpr double units = 1024.0;  // of an element cycle
  std::int64_t sum = 0, most = 0, n_elements = 0;

  /// Of this rank. Local.
  static RankWork of(const Model& model);
  /// Of all ranks. Collective.
  static RankWork of_all(const Model& model);
  void join(const RankWork& other) {
    sum += other.sum;
    most = most < other.most ? other.most : most;
    n_elements += other.n_elements;
  }
  double mean(int n_ranks) const { return static_cast<double>(sum) / units / n_ranks; }
  /// Greatest over mean.
  double imbalance(int n_ranks) const {
    return sum > 0 ? static_cast<double>(most) * n_ranks / static_cast<double>(sum) : 1.0;
  }
};

class Balancer {
 public:
  explicit Balancer(const BalanceInput& input) : input_(input) {}

  /// Distributes the generated or restored mesh for the first time. Collective.
  void distribute(Model& model) { move(model, 0); }
  /// Whether to re-balance after this step; `cycles_left` is an estimate, `work` that of all ranks. Throws PhysicsError
  /// on all ranks where the policy throws. Collective, the same on all ranks.
  bool due(const Model& model, const Step& step, double cycles_left, const RankWork& work);
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
  bool ask(const Model& model, const Step& step, double cycles_left, const RankWork& work);

  const BalanceInput& input_;
  std::int64_t last_cycle_ = 0;
  std::int64_t interval_ = -1;  // cycles between two questions; -1 until it is known
  std::vector<BalanceMove> records_;
};

}  // namespace kerf
