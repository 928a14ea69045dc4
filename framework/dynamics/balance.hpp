// Asks the policy when the mesh is to be re-balanced, and does it.
#pragma once

#include <cstdint>
#include <memory>
#include <string>
#include <vector>

#include "contact/engine.hpp"
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

  /// Of this rank, without contact. Local.
  static RankWork of(const Model& model);
  /// Of the elements of all ranks, each with its work. Collective.
  static RankWork of_all(const Model& model, const std::vector<double>& work);
  /// Of all ranks once each element is on the rank of its part. Collective.
  static RankWork after(const Model& model, const std::vector<double>& work, const std::vector<int>& parts);
  /// Of all ranks, without contact. Collective.
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

/// What was decided in a cycle, and what came of it.
struct BalanceDecision {
  std::int64_t cycle = 0;
  double time = 0.0;  // [s]
  double imbalance = 1.0;
  BalanceReasons reasons;  // on rank 0
  std::string decision;  // one of those below
  BalanceMove move;  // where the mesh was moved

  static constexpr const char *stay = "stay", *moved = "move", *forced = "forced", *first = "first",
                              *resumed = "resumed";
  static constexpr const char* foreseen = "foreseen";  // reason of a first distribution
};

class Balancer {
 public:
  explicit Balancer(const BalanceInput& input) : input_(input) {}

  /// Distributes the generated mesh for the first time. Collective.
  void distribute(Model& model);
  /// Distributes a mesh that a restart file has brought, and forgets decisions of before. Collective.
  void distribute_again(Model& model, std::int64_t cycle, double time);
  /// Contact definitions whose nodes count where contact goes with the elements. They must outlive this.
  void watch(const std::vector<std::unique_ptr<ContactEngine>>& contacts) { contacts_ = &contacts; }
  /// Whether to re-balance after this step; `cycles_left` is an estimate, `known` the present work of all ranks without
  /// contact, or null where it has to be asked for. Throws PhysicsError on all ranks where the policy throws.
  /// Collective, the same on all ranks.
  bool due(Model& model, const Step& step, double cycles_left, const RankWork* known);
  /// Partitions and migrates, after due() has said so. Collective.
  void move(Model& model, std::int64_t cycle);

  /// Max over mean of the work of all ranks, from the work model. Collective.
  double imbalance(Model& model) const { return work_of_all(model).imbalance(model.n_ranks()); }
  /// Work of each live element of this rank in a cycle, in the order of the stores. Collective.
  std::vector<double> work_of_elements(Model& model) const;
  const std::vector<BalanceMove>& records() const { return records_; }
  /// In the order of cycles, the same number on all ranks.
  const std::vector<BalanceDecision>& decisions() const { return decisions_; }
  std::int64_t last_cycle() const { return last_cycle_; }
  /// What restart files keep beside the last cycle: rank 0's, whose policy is asked. Collective.
  PolicyProgress policy_progress(MPI_Comm comm) const;
  /// The numbers of another type of policy are not taken up: how a model is distributed may change at a restart.
  void restore(std::int64_t last_cycle, const PolicyProgress& progress);

 private:
  /// A partitioner that cannot answer on one rank must not pass unheard. Collective.
  void refuse_on_one_rank(Model& model) const;
  bool ask(const Model& model, const Step& step, double cycles_left, const RankWork& work);
  std::int64_t check_interval();
  /// Parts by the partitioner of the input. Collective.
  std::vector<int> parts_by(Model& model, std::vector<double> weights) const;
  /// Parts with which the run is expected to take least, if elements live for these shares of it. Equal work at the
  /// start is tried, too. Collective.
  std::vector<int> foreseen_parts(Model& model, const std::vector<double>& work,
                                  const std::vector<double>& lives) const;
  /// `lives` are the shares of the run that elements are expected to live, or null. Collective.
  BalanceMove migrate_elements(Model& model, std::int64_t cycle, const std::vector<double>* lives = nullptr);
  RankWork work_of_all(Model& model) const;
  bool has_contact() const { return input_.has_contact_with_elements() && contacts_ != nullptr && !contacts_->empty(); }

  const BalanceInput& input_;
  const std::vector<std::unique_ptr<ContactEngine>>* contacts_ = nullptr;
  std::int64_t last_cycle_ = 0;
  std::int64_t interval_ = -1;  // cycles between two questions; -1 until it is known
  std::vector<BalanceMove> records_;
  std::vector<BalanceDecision> decisions_;
};

}  // namespace kerf
