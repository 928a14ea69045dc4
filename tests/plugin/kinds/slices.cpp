// A partitioner outside of Kerf's tree: slices of equal work along a direction, for long bodies.
#include <algorithm>
#include <limits>

#include <kerf/partitioner.hpp>

/// Cuts are found in a histogram of the work along the direction, the same on all ranks.
struct Slices final : kerf::Partitioner {
  kerf::Vec3 direction;
  static constexpr int bins = 4096;

  static void describe(kerf::Schema<Slices>& s) {
    s.vector(&Slices::direction, "direction", "-", kerf::any_value, "normal of the cuts, of any length");
    s.rule("direction", "direction must not have zero length", [](const Slices& p) { return norm(p.direction) > 0.0; });
  }

  std::vector<int> partition(const kerf::PartitionProblem& problem) override {
    const std::size_t n = problem.ids.size();
    std::vector<double> along(n);
    // The greatest coordinate and the greatest negative one, so that one reduction finds both ends.
    double ends[2] = {-std::numeric_limits<double>::infinity(), -std::numeric_limits<double>::infinity()};
    for (std::size_t e = 0; e < n; ++e) {
      const double* x = problem.coordinates.data() + 3 * e;
      along[e] = dot(direction, {x[0], x[1], x[2]});
      ends[0] = std::max(ends[0], along[e]);
      ends[1] = std::max(ends[1], -along[e]);
    }
    MPI_Allreduce(MPI_IN_PLACE, ends, 2, MPI_DOUBLE, MPI_MAX, problem.comm);
    const double low = -ends[1], width = std::max(ends[0] - low, std::numeric_limits<double>::min());
    const auto bin_of = [&](std::size_t e) {
      return std::clamp(static_cast<int>((along[e] - low) / width * bins), 0, bins - 1);
    };
    std::vector<double> work(bins, 0.0);
    for (std::size_t e = 0; e < n; ++e) work[static_cast<std::size_t>(bin_of(e))] += problem.weights[e];
    // Summed on one rank, and told to all: they must agree on the cuts in every bit.
    int rank = 0;
    MPI_Comm_rank(problem.comm, &rank);
    MPI_Reduce(rank == 0 ? MPI_IN_PLACE : work.data(), work.data(), bins, MPI_DOUBLE, MPI_SUM, 0, problem.comm);
    MPI_Bcast(work.data(), bins, MPI_DOUBLE, 0, problem.comm);

    double total = 0.0, before = 0.0;
    for (const double w : work) total += w;
    std::vector<int> part_of_bin;
    for (const double w : work) {
      const double middle = (before + 0.5 * w) / std::max(total, std::numeric_limits<double>::min());
      part_of_bin.push_back(std::min(static_cast<int>(middle * problem.n_parts), problem.n_parts - 1));
      before += w;
    }
    std::vector<int> parts(n);
    for (std::size_t e = 0; e < n; ++e) parts[e] = part_of_bin[static_cast<std::size_t>(bin_of(e))];
    return parts;
  }
};

KERF_PARTITIONER(Slices, "slices", "slices of equal work along a direction")
