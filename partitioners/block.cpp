// Contiguous ranges of element numbers with equal work: the division that needs to know nothing of the mesh.
#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>

#include "kerf/partitioner.hpp"

namespace kerf {
namespace {

/// Whole numbers of work, so that sums do not depend on the ranks that hold the elements.
constexpr double work_units = 1048576.0;  // of the heaviest element

class BlockPartitioner final : public Partitioner {
 public:
  static void describe(Schema<BlockPartitioner>&) {}

  std::vector<std::string> complaints(const PartitionProblem& problem) override {
    int bad = 0;
    for (std::size_t i = 0; i < problem.ids.size(); ++i) {
      const double w = problem.weights[i * static_cast<std::size_t>(problem.n_weights)];
      if (!(w >= 0.0) || !std::isfinite(w)) bad = 1;
    }
    MPI_Allreduce(MPI_IN_PLACE, &bad, 1, MPI_INT, MPI_MAX, problem.comm);
    if (bad == 0) return {};
    return {origin + ": error: the partitioner `block` was given an element whose work is negative or not finite"};
  }

  // 1. The work of each element in whole units.
  // 2. Between two numbers of elements lies the cut k: the least number such that the elements below it have the
  //    share k / n_parts of all work. All cuts are found by bisection together, with one sum over the ranks for each.
  // 3. An element belongs to the part between its two cuts.
  std::vector<int> partition(const PartitionProblem& problem) override {
    const Sorted sorted = sort(problem);
    std::int64_t ends[2] = {-1, -1};  // greatest id, and greatest negative one
    if (!sorted.ids.empty()) {
      ends[0] = sorted.ids.back();
      ends[1] = -sorted.ids.front();
    } else {
      ends[1] = std::numeric_limits<std::int64_t>::min();
    }
    MPI_Allreduce(MPI_IN_PLACE, ends, 2, MPI_INT64_T, MPI_MAX, problem.comm);
    std::int64_t total = sorted.before.back();
    MPI_Allreduce(MPI_IN_PLACE, &total, 1, MPI_INT64_T, MPI_SUM, problem.comm);
    if (ends[0] < 0) return {};
    const std::vector<std::int64_t> cuts = find_cuts(problem, sorted, -ends[1], ends[0] + 1, total);
    std::vector<int> parts(problem.ids.size());
    for (std::size_t i = 0; i < parts.size(); ++i)
      parts[i] = static_cast<int>(std::upper_bound(cuts.begin(), cuts.end(), problem.ids[i]) - cuts.begin());
    return parts;
  }

 private:
  struct Sorted {
    std::vector<std::int64_t> ids;
    std::vector<std::int64_t> before;  // work of the elements in front of each, and of all at the end
  };

  /// The elements of this rank in the order of their ids, with their work in whole units. Collective.
  static Sorted sort(const PartitionProblem& problem) {
    const auto stride = static_cast<std::size_t>(problem.n_weights);
    double heaviest = 0.0;
    for (std::size_t i = 0; i < problem.ids.size(); ++i) heaviest = std::max(heaviest, problem.weights[i * stride]);
    MPI_Allreduce(MPI_IN_PLACE, &heaviest, 1, MPI_DOUBLE, MPI_MAX, problem.comm);
    std::vector<std::size_t> order(problem.ids.size());
    std::iota(order.begin(), order.end(), std::size_t{0});
    std::sort(order.begin(), order.end(),
              [&](std::size_t a, std::size_t b) { return problem.ids[a] < problem.ids[b]; });
    Sorted sorted;
    sorted.before.push_back(0);
    for (const std::size_t i : order) {
      sorted.ids.push_back(problem.ids[i]);
      const double share = heaviest > 0.0 ? problem.weights[i * stride] / heaviest : 1.0;
      sorted.before.push_back(sorted.before.back() + std::llrint(share * work_units));
    }
    return sorted;
  }

  /// The n_parts - 1 cuts, ascending; ids run from `low` to below `high`. Collective.
  static std::vector<std::int64_t> find_cuts(const PartitionProblem& problem, const Sorted& sorted, std::int64_t low,
                                             std::int64_t high, std::int64_t total) {
    const auto n = static_cast<std::size_t>(problem.n_parts - 1);
    std::vector<std::int64_t> from(n, low), to(n, high), below(n);
    for (std::int64_t width = high - low; width > 0 && n > 0; width /= 2) {
      for (std::size_t k = 0; k < n; ++k) {
        const std::int64_t middle = from[k] + (to[k] - from[k]) / 2;
        const auto at = std::lower_bound(sorted.ids.begin(), sorted.ids.end(), middle) - sorted.ids.begin();
        below[k] = sorted.before[static_cast<std::size_t>(at)];
      }
      MPI_Allreduce(MPI_IN_PLACE, below.data(), static_cast<int>(n), MPI_INT64_T, MPI_SUM, problem.comm);
      for (std::size_t k = 0; k < n; ++k) {
        if (from[k] == to[k]) continue;
        const std::int64_t middle = from[k] + (to[k] - from[k]) / 2;
        // In floating point, for a product of whole numbers could be beyond 64 bits; the same on all ranks.
        const bool enough =
            static_cast<double>(below[k]) * problem.n_parts >= static_cast<double>(total) * static_cast<double>(k + 1);
        if (enough)
          to[k] = middle;
        else
          from[k] = middle + 1;
      }
    }
    return to;
  }
};

}  // namespace
}  // namespace kerf

KERF_PARTITIONER(kerf::BlockPartitioner, "block", "contiguous ranges of element numbers with equal work")
