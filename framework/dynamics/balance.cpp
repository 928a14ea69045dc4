// The work model, the decision, and the hand-over to partitioner and migrator.
#include "dynamics/balance.hpp"

#include <fmt/format.h>

#include <chrono>

#include "core/physics_error.hpp"
#include "model/migrator.hpp"
#include "parallel/communicator.hpp"

namespace kerf {

namespace {

/// Work of re-balancing, in element cycles per element; see doc/developers/performance.md. A constant of the work
/// model, not a measured time, so that runs repeat.
constexpr double migration_cost = 60.0;

double local_work(const Model& model) {
  double work = 0.0;
  for (const PartModel& p : model.parts) work += p.work * p.store->n_live();
  return work;
}

}  // namespace

double Balancer::imbalance(const Model& model) {
  const double mine = local_work(model);
  double most = 0.0, sum = 0.0;
  MPI_Reduce(&mine, &most, 1, MPI_DOUBLE, MPI_MAX, 0, model.comm);
  MPI_Reduce(&mine, &sum, 1, MPI_DOUBLE, MPI_SUM, 0, model.comm);
  double ratio = sum > 0.0 ? most * model.n_ranks() / sum : 1.0;
  // From one rank to all, because a decision that all must take alike hangs on its last bit.
  MPI_Bcast(&ratio, 1, MPI_DOUBLE, 0, model.comm);
  return ratio;
}

bool Balancer::due(const Model& model, std::int64_t cycle, double cycles_left) {
  if (model.n_ranks() == 1) return false;
  if (input_.force_interval > 0 && cycle % input_.force_interval == 0) return true;
  if (!input_.enabled || cycle % input_.check_interval != 0) return false;
  last_imbalance_ = imbalance(model);
  if (last_imbalance_ <= input_.threshold || cycle - last_cycle_ < input_.cooldown) return false;
  // Both sides per element of the mean rank: cycles saved until the end (or for a thousand), and the move.
  const double saved = (last_imbalance_ - 1.0) * (cycles_left < 1000.0 ? cycles_left : 1000.0);
  return saved > input_.cost_factor * migration_cost;
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
  const auto start = std::chrono::steady_clock::now();
  RebalanceRecord r;
  r.cycle = cycle;
  r.imbalance_before = imbalance(model);
  r.elements_moved = sum_of(model.comm, migrate(model, partition(model)));
  r.imbalance_after = imbalance(model);
  r.seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
  last_cycle_ = cycle;
  last_imbalance_ = r.imbalance_after;
  records_.push_back(r);
}

}  // namespace kerf
