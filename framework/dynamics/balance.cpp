// The work model, the decision, and the hand-over to partitioner and migrator.
#include "dynamics/balance.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <chrono>
#include <cmath>
#include <cstddef>
#include <limits>
#include <numeric>
#include <utility>

#include "core/assert.hpp"
#include "core/diagnostics.hpp"
#include "core/memory.hpp"
#include "core/physics_error.hpp"
#include "model/migrator.hpp"
#include "parallel/communicator.hpp"
#include "partition/foresight.hpp"
#include "partition/problem.hpp"

namespace kerf {

namespace {

/// Moments of the run that foresight looks at.
constexpr std::size_t n_moments = 20;
/// How far an element's weight falls with the share of the run in which it is dead: foresight tries them all.
constexpr std::array<double, 5> discounts{0.0, 0.25, 0.5, 0.75, 1.0};
/// An element that dies at once still has to be somewhere.
constexpr double least_weight = 0.01;

/// The greatest work of a rank, summed over the moments, if each element is on the rank of its part and dies when it is
/// expected to: what the run takes where ranks wait for one another in each cycle. Collective.
std::int64_t expected_time(const Model& model, const std::vector<double>& work, const std::vector<double>& lives,
                           const std::vector<int>& parts) {
  const auto n_ranks = static_cast<std::size_t>(model.n_ranks());
  std::vector<std::int64_t> of_part(n_moments * n_ranks, 0);
  for (std::size_t e = 0; e < work.size(); ++e)
    for (std::size_t k = 0; k < n_moments && lives[e] * n_moments > static_cast<double>(k) + 0.5; ++k)
      of_part[k * n_ranks + static_cast<std::size_t>(parts[e])] += std::llrint(RankWork::units * work[e]);
  MPI_Allreduce(MPI_IN_PLACE, of_part.data(), static_cast<int>(of_part.size()), MPI_INT64_T, MPI_SUM, model.comm);
  std::int64_t time = 0;
  for (auto moment = of_part.begin(); moment != of_part.end(); moment += static_cast<std::ptrdiff_t>(n_ranks))
    time += *std::max_element(moment, moment + static_cast<std::ptrdiff_t>(n_ranks));
  return time;
}

}  // namespace

RankWork RankWork::of(const Model& model) {
  double work = 0.0;
  for (const PartModel& p : model.parts) work += p.work * p.store->n_live();
  const std::int64_t mine = std::llrint(units * work);
  return {mine, mine, model.n_live_local()};
}

RankWork RankWork::of_all(const Model& model, const std::vector<double>& work) {
  std::int64_t mine = 0;
  for (const double w : work) mine += std::llrint(units * w);
  std::int64_t sums[2] = {mine, static_cast<std::int64_t>(work.size())};
  MPI_Allreduce(MPI_IN_PLACE, sums, 2, MPI_INT64_T, MPI_SUM, model.comm);
  return {sums[0], greatest(model.comm, mine), sums[1]};
}

RankWork RankWork::of_all(const Model& model) {
  const RankWork mine = of(model);
  std::int64_t sums[2] = {mine.sum, mine.n_elements};
  MPI_Allreduce(MPI_IN_PLACE, sums, 2, MPI_INT64_T, MPI_SUM, model.comm);
  return {sums[0], greatest(model.comm, mine.most), sums[1]};
}

RankWork RankWork::after(const Model& model, const std::vector<double>& work, const std::vector<int>& parts) {
  std::vector<std::int64_t> of_part(static_cast<std::size_t>(model.n_ranks()) + 1, 0);
  for (std::size_t e = 0; e < work.size(); ++e)
    of_part[static_cast<std::size_t>(parts[e])] += std::llrint(units * work[e]);
  of_part.back() = static_cast<std::int64_t>(work.size());
  MPI_Allreduce(MPI_IN_PLACE, of_part.data(), static_cast<int>(of_part.size()), MPI_INT64_T, MPI_SUM, model.comm);
  RankWork all;
  all.n_elements = of_part.back();
  of_part.pop_back();
  all.sum = std::accumulate(of_part.begin(), of_part.end(), std::int64_t{0});
  all.most = *std::max_element(of_part.begin(), of_part.end());
  return all;
}

std::vector<double> Balancer::work_of_elements(Model& model) const {
  std::vector<std::int64_t> candidates(static_cast<std::size_t>(model.nodes.n()), 0);
  if (has_contact())
    for (const auto& c : *contacts_) {
      const std::vector<std::int64_t>& of_nodes = c->candidates_of_nodes();
      for (std::size_t i = 0; i < of_nodes.size() && i < candidates.size(); ++i) candidates[i] += of_nodes[i];
    }
  return element_work(model, candidates);
}

RankWork Balancer::work_of_all(Model& model) const {
  return input_.has_contact_with_elements() ? RankWork::of_all(model, work_of_elements(model))
                                            : RankWork::of_all(model);
}

/// Asked once, while all ranks have the same policy: what it is asked later, it is asked on rank 0.
std::int64_t Balancer::check_interval() {
  if (interval_ < 0) {
    interval_ = input_.enabled ? input_.policy->check_interval() : 0;
    if (interval_ < 0)
      throw PhysicsError(
          fmt::format("the balance policy {} ({}) wants to be asked every {} cycles; expected a number from 0 "
                      "on",
                      input_.policy->type, input_.policy->origin, interval_));
  }
  return interval_;
}

bool Balancer::due(Model& model, const Step& step, double cycles_left, const RankWork* known) {
  if (model.n_ranks() == 1) return false;
  const bool forced = input_.force_interval > 0 && step.cycle % input_.force_interval == 0;
  const bool asked = !forced && check_interval() > 0 && step.cycle % check_interval() == 0;
  if (!forced && !asked) return false;
  // What the ranks have told each other in their one reduction is without contact.
  const RankWork now = known == nullptr || input_.has_contact_with_elements() ? work_of_all(model) : *known;
  BalanceDecision d;
  d.cycle = step.cycle;
  d.time = step.end();
  d.imbalance = now.imbalance(model.n_ranks());
  const bool moves = forced || ask(model, step, cycles_left, now);
  d.decision = forced ? BalanceDecision::forced : moves ? BalanceDecision::moved : BalanceDecision::stay;
  if (asked && model.rank() == 0) d.reasons = input_.policy->reasons();
  decisions_.push_back(std::move(d));
  return moves;
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
      s.move_cost = input_.work.move;
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

std::vector<int> Balancer::parts_by(Model& model, std::vector<double> weights) const {
  const PartitionProblem problem = problem_of(model, *input_.partitioner, model.n_ranks(), std::move(weights));
  return find_parts(*input_.partitioner, problem);
}

std::vector<int> Balancer::foreseen_parts(Model& model, const std::vector<double>& work,
                                          const std::vector<double>& lives) const {
  KERF_ASSERT(lives.size() == work.size(), "each element has a life and its work");
  std::vector<int> best;
  std::int64_t least = std::numeric_limits<std::int64_t>::max();
  for (const double discount : discounts) {
    std::vector<double> weights = work;
    for (std::size_t e = 0; e < work.size(); ++e)
      weights[e] *= std::max(1.0 - discount * (1.0 - lives[e]), least_weight);
    std::vector<int> parts = parts_by(model, std::move(weights));
    if (const std::int64_t time = expected_time(model, work, lives, parts); time < least) {
      least = time;
      best = std::move(parts);
    }
  }
  return best;
}

BalanceMove Balancer::migrate_elements(Model& model, std::int64_t cycle, const std::vector<double>* lives) {
  const ReturnedBlocks returned;
  const auto start = std::chrono::steady_clock::now();
  BalanceMove r;
  r.cycle = cycle;
  const std::vector<double> work = work_of_elements(model);
  const RankWork before = RankWork::of_all(model, work);
  r.imbalance_before = before.imbalance(model.n_ranks());
  const std::vector<int> parts = lives != nullptr ? foreseen_parts(model, work, *lives) : parts_by(model, work);
  // From the work before the move: contact does not know its candidates again before the next search.
  r.imbalance_after = RankWork::after(model, work, parts).imbalance(model.n_ranks());
  r.elements_moved = sum_of(model.comm, migrate(model, parts));
  r.seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
  r.modelled_cost = input_.work.move.of(static_cast<double>(before.n_elements) / model.n_ranks(),
                                        static_cast<double>(r.elements_moved) / model.n_ranks());
  return r;
}

void Balancer::distribute(Model& model) {
  std::vector<double> lives;
  if (!input_.foresee.empty()) lives = expected_lives(model, input_.foresee, input_.foresee_origin);
  if (model.n_ranks() == 1) return refuse_on_one_rank(model);
  BalanceMove r = migrate_elements(model, 0, input_.foresee.empty() ? nullptr : &lives);
  r.first = true;
  records_.push_back(r);
  BalanceDecision d{0, 0.0, r.imbalance_before, {}, BalanceDecision::first, r};
  if (!input_.foresee.empty()) d.reasons.reason = BalanceDecision::foreseen;
  decisions_.push_back(std::move(d));
}

void Balancer::distribute_again(Model& model, std::int64_t cycle, double time) {
  decisions_.clear();
  if (model.n_ranks() == 1) return refuse_on_one_rank(model);
  BalanceMove r = migrate_elements(model, 0);
  r.first = true;
  records_.push_back(r);
  decisions_.push_back({cycle, time, r.imbalance_before, {}, BalanceDecision::resumed, r});
}

void Balancer::move(Model& model, std::int64_t cycle) {
  const BalanceMove r = migrate_elements(model, cycle);
  last_cycle_ = cycle;
  records_.push_back(r);
  decisions_.back().move = r;
}

}  // namespace kerf
