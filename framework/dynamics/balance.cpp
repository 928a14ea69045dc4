// The work model, the decision, and the hand-over to partitioner and migrator.
#include "dynamics/balance.hpp"

#include <fmt/format.h>

#include <chrono>
#include <cmath>

#include "core/diagnostics.hpp"
#include "core/memory.hpp"
#include "core/physics_error.hpp"
#include "model/migrator.hpp"
#include "parallel/communicator.hpp"
#include "partition/problem.hpp"

namespace kerf {

RankWork RankWork::of(const Model& model) {
  double work = 0.0;
  for (const PartModel& p : model.parts) work += p.work * p.store->n_live();
  const std::int64_t mine = std::llrint(units * work);
  return {mine, mine, model.n_live_local()};
}

RankWork RankWork::of_all(const Model& model) {
  const RankWork mine = of(model);
  std::int64_t sums[2] = {mine.sum, mine.n_elements};
  MPI_Allreduce(MPI_IN_PLACE, sums, 2, MPI_INT64_T, MPI_SUM, model.comm);
  return {sums[0], greatest(model.comm, mine.most), sums[1]};
}

double Balancer::imbalance(const Model& model) { return RankWork::of_all(model).imbalance(model.n_ranks()); }

bool Balancer::due(const Model& model, const Step& step, double cycles_left, const RankWork& work) {
  if (model.n_ranks() == 1) return false;
  if (input_.force_interval > 0 && step.cycle % input_.force_interval == 0) return true;
  // Once, while all ranks have the same policy: what it is asked later, it is asked on rank 0.
  if (interval_ < 0) {
    interval_ = input_.enabled ? input_.policy->check_interval() : 0;
    if (interval_ < 0)
      throw PhysicsError(
          fmt::format("the balance policy {} ({}) wants to be asked every {} cycles; expected a number from 0 "
                      "on",
                      input_.policy->type, input_.policy->origin, interval_));
  }
  return interval_ > 0 && step.cycle % interval_ == 0 && ask(model, step, cycles_left, work);
}

/// Rank 0 asks, and tells the others.
bool Balancer::ask(const Model& model, const Step& step, double cycles_left, const RankWork& work) {
  std::string failure;
  int moves = 0;
  if (model.rank() == 0) try {
      BalanceState s;
      s.cycle = step.cycle;
      s.time = step.end();
      s.cycles_left = cycles_left;
      s.n_ranks = model.n_ranks();
      s.n_elements = work.n_elements;
      s.imbalance = work.imbalance(model.n_ranks());
      s.mean_work = work.mean(model.n_ranks());
      s.cycles_since_move = step.cycle - last_cycle_;
      s.moves = records_;
      moves = input_.policy->move(s) ? 1 : 0;
    } catch (const std::exception& e) {
      failure = fmt::format("the balance policy {} ({}) failed: {}; at time {:.6g} s, cycle {}", input_.policy->type,
                            input_.policy->origin, e.what(), step.end(), step.cycle);
      moves = -1;
    }
  MPI_Bcast(&moves, 1, MPI_INT, 0, model.comm);
  if (moves < 0) throw PhysicsError(broadcast(model.comm, failure));
  return moves == 1;
}

PolicyProgress Balancer::policy_progress(MPI_Comm comm) const {
  PolicyProgress p{input_.policy->type, input_.policy->state()};
  std::int64_t size = static_cast<std::int64_t>(p.numbers.size());
  MPI_Bcast(&size, 1, MPI_INT64_T, 0, comm);
  p.numbers.resize(static_cast<std::size_t>(size));  // on other ranks, whose policies are never asked
  MPI_Bcast(p.numbers.data(), static_cast<int>(size), MPI_DOUBLE, 0, comm);
  return p;
}

void Balancer::restore(std::int64_t last_cycle, const PolicyProgress& progress) {
  last_cycle_ = last_cycle;
  if (progress.type == input_.policy->type) input_.policy->restore(progress.numbers);
}

void Balancer::refuse_on_one_rank(Model& model) const {
  Partitioner& partitioner = *input_.partitioner;
  if (const auto lines = partitioner.complaints(problem_of(model, partitioner, 1)); !lines.empty())
    throw InputError(lines);
}

void Balancer::move(Model& model, std::int64_t cycle) {
  if (model.n_ranks() == 1) return refuse_on_one_rank(model);
  const ReturnedBlocks returned;
  const auto start = std::chrono::steady_clock::now();
  BalanceMove r;
  r.cycle = cycle;
  r.imbalance_before = imbalance(model);
  const PartitionProblem problem = problem_of(model, *input_.partitioner, model.n_ranks());
  r.elements_moved = sum_of(model.comm, migrate(model, find_parts(*input_.partitioner, problem)));
  r.imbalance_after = imbalance(model);
  r.seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
  last_cycle_ = cycle;
  records_.push_back(r);
}

}  // namespace kerf
