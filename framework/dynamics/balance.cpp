// The work model, the decision, and the hand-over to partitioner and migrator.
#include "dynamics/balance.hpp"

#include <fmt/format.h>

#include <chrono>
#include <cmath>

#include "core/memory.hpp"
#include "core/physics_error.hpp"
#include "model/migrator.hpp"
#include "parallel/communicator.hpp"

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

namespace {

/// Throws PhysicsError, on all ranks, where a partitioner has not answered for each element with a rank that there is.
void refuse_wrong_owners(const Model& model, const Partitioner& partitioner, const PartitionProblem& problem,
                         const std::vector<int>& owners) {
  std::string trouble;
  if (owners.size() != problem.ids.size())
    trouble = fmt::format("the partitioner `{}` returns {} owners for {} elements; expected one for each",
                          partitioner.type, owners.size(), problem.ids.size());
  for (std::size_t i = 0; i < owners.size() && trouble.empty(); ++i)
    if (owners[i] < 0 || owners[i] >= model.n_ranks())
      trouble = fmt::format("the partitioner `{}` gives element {} to rank {}; expected a rank from 0 to {}",
                            partitioner.type, problem.ids[i], owners[i], model.n_ranks() - 1);
  if (const std::string first = first_text(model.comm, trouble); !first.empty()) throw PhysicsError(first);
}

}  // namespace

std::vector<int> Balancer::partition(const Model& model) const {
  PartitionProblem problem;
  problem.comm = model.comm;
  const bool graph = input_.partitioner->needs_graph();
  if (graph) problem.first.push_back(0);
  for (std::size_t p = 0; p < model.parts.size(); ++p) {
    const PartStore& store = *model.parts[p].store;
    for (int s = 0; s < store.n_slots(); ++s) {
      if (!store.live(s)) continue;
      problem.ids.push_back(store.id(s));
      Vec3 centre;
      for (int k = 0; k < store.n_nodes(); ++k) centre = centre + model.nodes.x(store.node(s, k));
      centre = centre * (1.0 / store.n_nodes());
      problem.coordinates.insert(problem.coordinates.end(), {centre.x, centre.y, centre.z});
      problem.weights.push_back(model.parts[p].work);
      if (!graph) continue;
      model.surface.neighbours(model.surface_mesh(), static_cast<int>(p), s, problem.neighbours,
                               problem.neighbour_ranks);
      problem.first.push_back(static_cast<std::int64_t>(problem.neighbours.size()));
    }
  }
  std::vector<int> owners = input_.partitioner->partition(problem);
  refuse_wrong_owners(model, *input_.partitioner, problem, owners);
  return owners;
}

void Balancer::move(Model& model, std::int64_t cycle) {
  if (model.n_ranks() == 1) return;
  const ReturnedBlocks returned;
  const auto start = std::chrono::steady_clock::now();
  BalanceMove r;
  r.cycle = cycle;
  r.imbalance_before = imbalance(model);
  r.elements_moved = sum_of(model.comm, migrate(model, partition(model)));
  r.imbalance_after = imbalance(model);
  r.seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
  last_cycle_ = cycle;
  records_.push_back(r);
}

}  // namespace kerf
