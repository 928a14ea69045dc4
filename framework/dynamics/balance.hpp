// Decides when the mesh is re-balanced, and does it.
#pragma once

#include <cstdint>
#include <vector>

#include "model/model.hpp"

namespace kerf {

struct RebalanceRecord {
  std::int64_t cycle = 0;
  double imbalance_before = 1.0, imbalance_after = 1.0;
  std::int64_t elements_moved = 0;
  double seconds = 0.0;
};

class Balancer {
 public:
  explicit Balancer(const BalanceInput& input) : input_(input) {}

  /// Distributes the generated or restored mesh for the first time. Collective.
  void distribute(Model& model) { move(model, 0); }
  /// Whether to re-balance after this cycle; `cycles_left` is an estimate. Collective, the same on all ranks.
  bool due(const Model& model, std::int64_t cycle, double cycles_left);
  /// Partitions and migrates. Collective.
  void move(Model& model, std::int64_t cycle);

  /// Max over mean of the work of all ranks, from the work model. Collective.
  static double imbalance(const Model& model);
  const std::vector<RebalanceRecord>& records() const { return records_; }
  std::int64_t last_cycle() const { return last_cycle_; }
  void restore(std::int64_t last_cycle) { last_cycle_ = last_cycle; }

 private:
  std::vector<int> partition(const Model& model) const;

  const BalanceInput& input_;
  std::int64_t last_cycle_ = 0;
  double last_imbalance_ = 1.0;
  std::vector<RebalanceRecord> records_;
};

}  // namespace kerf
