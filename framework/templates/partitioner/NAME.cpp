// Slabs of equal work across the longest axis of the model: for rods, and for plates whose width is in one direction.
#include <kerf/partitioner.hpp>

#include <algorithm>
#include <array>
#include <limits>

namespace {

using namespace kerf;

/// Cuts the model by planes across its longest axis, so that the elements between two planes have about the same weight
/// in every part. Elements are placed by their centres; those in one plane are never divided.
struct @TYPE@ final : Partitioner {
  std::int64_t halvings = 40;

  static void describe(Schema<@TYPE@>& s) {
    s.integer(&@TYPE@::halvings, "halvings", between(1, 60), "halvings of the interval that holds each cut")
        .by_default("40");
  }

  std::vector<int> partition(const PartitionProblem& problem) override {
    double low = 0.0, high = 0.0;
    const std::size_t axis = longest_axis(problem, low, high);
    const std::vector<double> cuts = cuts_of(problem, axis, low, high);
    std::vector<int> parts(problem.ids.size());
    for (std::size_t i = 0; i < parts.size(); ++i) {
      const double x = problem.coordinates[3 * i + axis];
      parts[i] = static_cast<int>(std::upper_bound(cuts.begin(), cuts.end(), x) - cuts.begin());
    }
    return parts;
  }

 private:
  /// The axis along which the centres of all elements reach farthest, and the interval that they fill. Collective.
  static std::size_t longest_axis(const PartitionProblem& problem, double& low, double& high) {
    constexpr double infinity = std::numeric_limits<double>::infinity();
    std::array<double, 6> most = {-infinity, -infinity, -infinity, -infinity, -infinity, -infinity};  // x and -x
    for (std::size_t i = 0; i < problem.ids.size(); ++i)
      for (std::size_t d = 0; d < 3; ++d) {
        most[d] = std::max(most[d], problem.coordinates[3 * i + d]);
        most[3 + d] = std::max(most[3 + d], -problem.coordinates[3 * i + d]);
      }
    MPI_Allreduce(MPI_IN_PLACE, most.data(), 6, MPI_DOUBLE, MPI_MAX, problem.comm);
    std::size_t axis = 0;
    for (std::size_t d = 1; d < 3; ++d)
      if (most[d] + most[3 + d] > most[axis] + most[3 + axis]) axis = d;
    low = -most[3 + axis];
    high = most[axis];
    return axis;
  }

  /// Places of the n_parts - 1 cuts, ascending: below cut k lies k / n_parts of all weight, as near as planes of
  /// elements allow. All cuts are bisected together, with one sum over all ranks for each halving. Collective.
  std::vector<double> cuts_of(const PartitionProblem& problem, std::size_t axis, double low, double high) const {
    const auto n = static_cast<std::size_t>(problem.n_parts - 1);
    std::vector<double> from(n, low), to(n, high), below(n + 1), middle(n);
    for (std::int64_t halving = 0; n > 0 && halving < halvings; ++halving) {
      for (std::size_t k = 0; k < n; ++k) middle[k] = 0.5 * (from[k] + to[k]);
      std::fill(below.begin(), below.end(), 0.0);
      for (std::size_t i = 0; i < problem.ids.size(); ++i) {
        const double x = problem.coordinates[3 * i + axis];
        // Middles ascend as cuts do: an element counts for each cut that it lies below.
        for (std::size_t k = n; k > 0 && x < middle[k - 1]; --k) below[k - 1] += problem.weights[i];
        below[n] += problem.weights[i];
      }
      MPI_Allreduce(MPI_IN_PLACE, below.data(), static_cast<int>(n + 1), MPI_DOUBLE, MPI_SUM, problem.comm);
      for (std::size_t k = 0; k < n; ++k) {
        const bool enough = below[k] * static_cast<double>(problem.n_parts) >= below[n] * static_cast<double>(k + 1);
        (enough ? to[k] : from[k]) = middle[k];
      }
    }
    return to;
  }
};

}  // namespace

KERF_PARTITIONER(@TYPE@, "@NAME@", "slabs of equal work across the longest axis of the model")
