// Recursive coordinate bisection by histograms: two reductions for each doubling of the number of parts, whatever the
// number of points. Contact uses it by default, because its boxes of space are made anew often.
//
// M.J. Berger & S.H. Bokhari, "A partitioning strategy for nonuniform problems on multiprocessors", IEEE Trans.
// Computers C-36 (1987) 570-580. All ranks find the same cuts: weights are summed up as whole numbers.
#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <numeric>
#include <span>

#include "kerf/partitioner.hpp"

namespace kerf {
namespace {

/// A region of space that is cut in two, or the region of one part.
struct Region {
  std::array<double, 3> low, high;  // [m]
  int first = 0, n_parts = 1;
  int axis = -1;  // -1 for the region of one part
  double cut = 0.0;  // what is above belongs to `upper` [m]
  std::int32_t lower = -1, upper = -1;  // regions

  int n_lower() const { return n_parts / 2; }
  double share() const { return static_cast<double>(n_lower()) / n_parts; }
};

/// The cuts, and where points are among them.
class Cuts {
 public:
  /// Cuts space so that the parts get equal weights. `coordinates` has three numbers for each point. Collective.
  void make(MPI_Comm comm, int n_parts, std::span<const double> coordinates, std::span<const double> weights);
  int part_of(Vec3 p) const {
    std::size_t r = 0;
    while (regions_[r].axis >= 0)
      r = static_cast<std::size_t>(p[regions_[r].axis] > regions_[r].cut ? regions_[r].upper : regions_[r].lower);
    return regions_[r].first;
  }
  /// Parts that a closed box touches, ascending.
  void parts_of(Vec3 low, Vec3 high, std::vector<int>& parts) const {
    parts.clear();
    add_parts(0, low, high, parts);
  }

 private:
  using Sums = std::vector<std::int64_t>;
  /// The interval of a region's axis that its cut is in.
  struct Window {
    double low, high;  // [m]
    std::int64_t below = 0, inside = 0, total = 0;  // weight of the region below the window, in it, and in all
  };
  void add_parts(std::size_t region, Vec3 low, Vec3 high, std::vector<int>& parts) const;
  double begin(MPI_Comm comm, int n_parts);
  void cut_level(MPI_Comm comm, std::vector<std::int32_t>& open);
  void narrow(MPI_Comm comm, const std::vector<std::int32_t>& open, std::vector<Window>& windows);
  static double cut_of(const Region& region, const Window& w);
  std::int32_t add_child(const Region& parent, bool upper);

  std::vector<Region> regions_;
  // While cuts are made:
  std::span<const double> coordinates_, weights_;
  std::vector<std::int32_t> region_of_;  // per point
  double per_weight_ = 1.0;  // units of weight; 0 where no point has any
};

/// The first region, which has all points; returns the greatest weight. Collective.
double Cuts::begin(MPI_Comm comm, int n_parts) {
  constexpr double far = std::numeric_limits<double>::max();
  std::array<double, 7> most{-far, -far, -far, -far, -far, -far, 0.0};  // of -x and x, and of weights
  for (std::size_t i = 0; i < weights_.size(); ++i) {
    for (std::size_t d = 0; d < 3; ++d) {
      most[d] = max_of(most[d], -coordinates_[3 * i + d]);
      most[3 + d] = max_of(most[3 + d], coordinates_[3 * i + d]);
    }
    most[6] = max_of(most[6], weights_[i]);
  }
  MPI_Allreduce(MPI_IN_PLACE, most.data(), 7, MPI_DOUBLE, MPI_MAX, comm);
  Region all;
  for (std::size_t d = 0; d < 3; ++d) {
    const bool empty = most[d] == -far;
    all.low[d] = empty ? 0.0 : -most[d];
    all.high[d] = empty ? 0.0 : most[3 + d];
  }
  all.n_parts = n_parts;
  regions_.assign(1, all);
  return most[6];
}

std::int32_t Cuts::add_child(const Region& parent, bool upper) {
  Region child = parent;
  child.axis = -1;
  child.n_parts = upper ? parent.n_parts - parent.n_lower() : parent.n_lower();
  if (upper) {
    child.first += parent.n_lower();
    child.low[static_cast<std::size_t>(parent.axis)] = parent.cut;
  } else {
    child.high[static_cast<std::size_t>(parent.axis)] = parent.cut;
  }
  regions_.push_back(child);
  return static_cast<std::int32_t>(regions_.size()) - 1;
}

/// Narrows the window of every open region down to the bin of a histogram in which its share of the weight is reached.
void Cuts::narrow(MPI_Comm comm, const std::vector<std::int32_t>& open, std::vector<Window>& windows) {
  constexpr std::size_t most_bins = 256, least_bins = 32, most_sums = 1u << 17;
  const std::size_t n_bins = std::clamp(most_sums / open.size(), least_bins, most_bins), row = n_bins + 1;
  std::vector<std::int32_t> place(regions_.size(), -1);
  for (std::size_t k = 0; k < open.size(); ++k) place[open[k]] = static_cast<std::int32_t>(k);
  Sums sums(row * open.size(), 0);  // the last of a row is the weight of all points of the region
  for (std::size_t i = 0; i < weights_.size(); ++i) {
    const std::int32_t k = place[region_of_[i]];
    if (k < 0) continue;
    const Window& w = windows[k];
    const double x = coordinates_[3 * i + static_cast<std::size_t>(regions_[open[k]].axis)];
    const std::int64_t weight = per_weight_ > 0.0 ? std::llrint(weights_[i] * per_weight_) : 1;  // or all are zero
    sums[row * k + n_bins] += weight;
    if (!(x >= w.low && x <= w.high)) continue;
    const double at = w.high > w.low ? (x - w.low) / (w.high - w.low) * static_cast<double>(n_bins) : 0.0;
    sums[row * k + std::min(static_cast<std::size_t>(at), n_bins - 1)] += weight;
  }
  MPI_Allreduce(MPI_IN_PLACE, sums.data(), static_cast<int>(sums.size()), MPI_INT64_T, MPI_SUM, comm);
  for (std::size_t k = 0; k < open.size(); ++k) {
    Window& w = windows[k];
    w.total = sums[row * k + n_bins];
    const double target = regions_[open[k]].share() * static_cast<double>(w.total), edge = w.high - w.low;
    std::size_t bin = 0;
    while (bin + 1 < n_bins && static_cast<double>(w.below + sums[row * k + bin]) < target)
      w.below += sums[row * k + bin++];
    const double low = w.low;
    w.low = low + edge * static_cast<double>(bin) / static_cast<double>(n_bins);
    w.high = low + edge * static_cast<double>(bin + 1) / static_cast<double>(n_bins);
    w.inside = sums[row * k + bin];
  }
}

/// Above or below what is in the window, whichever is nearer to the share; in the middle of a region without points.
double Cuts::cut_of(const Region& region, const Window& w) {
  if (w.total == 0) return std::midpoint(region.low[region.axis], region.high[region.axis]);
  const double left = region.share() * static_cast<double>(w.total) - static_cast<double>(w.below);
  return left < 0.5 * static_cast<double>(w.inside) ? std::nextafter(w.low, region.low[region.axis]) : w.high;
}

/// Cuts all open regions, whose children take their place. Collective.
void Cuts::cut_level(MPI_Comm comm, std::vector<std::int32_t>& open) {
  std::vector<Window> windows;
  for (const std::int32_t r : open) {
    Region& region = regions_[r];
    region.axis = 0;
    for (int d = 1; d < 3; ++d)
      if (region.high[d] - region.low[d] > region.high[region.axis] - region.low[region.axis]) region.axis = d;
    windows.push_back({region.low[region.axis], region.high[region.axis]});
  }
  for (int k = 0; k < 2; ++k) narrow(comm, open, windows);
  std::vector<std::int32_t> next;
  for (std::size_t k = 0; k < open.size(); ++k) {
    Region region = regions_[open[k]];
    const Window& w = windows[k];
    region.cut = cut_of(region, w);
    region.lower = add_child(region, false);
    region.upper = add_child(region, true);
    regions_[open[k]] = region;
    for (const std::int32_t child : {region.lower, region.upper})
      if (regions_[child].n_parts > 1) next.push_back(child);
  }
  for (std::size_t i = 0; i < weights_.size(); ++i) {
    const Region& r = regions_[region_of_[i]];
    if (r.axis >= 0) region_of_[i] = coordinates_[3 * i + static_cast<std::size_t>(r.axis)] > r.cut ? r.upper : r.lower;
  }
  open = std::move(next);
}

void Cuts::make(MPI_Comm comm, int n_parts, std::span<const double> coordinates, std::span<const double> weights) {
  coordinates_ = coordinates;
  weights_ = weights;
  constexpr double units = 1u << 20;  // of the greatest weight
  const double greatest = begin(comm, n_parts);
  per_weight_ = greatest > 0.0 ? units / greatest : 0.0;
  region_of_.assign(weights.size(), 0);
  std::vector<std::int32_t> open;
  if (n_parts > 1) open.push_back(0);
  while (!open.empty()) cut_level(comm, open);
  coordinates_ = weights_ = {};
  region_of_.clear();
}

void Cuts::add_parts(std::size_t region, Vec3 low, Vec3 high, std::vector<int>& parts) const {
  const Region& r = regions_[region];
  if (r.axis < 0) {
    parts.push_back(r.first);
    return;
  }
  if (low[r.axis] <= r.cut) add_parts(static_cast<std::size_t>(r.lower), low, high, parts);
  if (high[r.axis] > r.cut) add_parts(static_cast<std::size_t>(r.upper), low, high, parts);
}

int n_ranks_of(MPI_Comm comm) {
  int n = 1;
  MPI_Comm_size(comm, &n);
  return n;
}

class BisectionDecomposition final : public SpatialDecomposition {
 public:
  void build(MPI_Comm comm, const std::vector<double>& coordinates, const std::vector<double>& weights) override {
    cuts_.make(comm, n_ranks_of(comm), coordinates, weights);
  }
  int owner(Vec3 point) const override { return cuts_.part_of(point); }
  void owners(Vec3 low, Vec3 high, std::vector<int>& ranks) const override { cuts_.parts_of(low, high, ranks); }

 private:
  Cuts cuts_;
};

class Bisection final : public Partitioner {
 public:
  static void describe(Schema<Bisection>&) {}

  std::vector<std::string> complaints(const PartitionProblem& problem) override {
    const auto finite = [](double x) { return std::isfinite(x); };
    int good = std::all_of(problem.coordinates.begin(), problem.coordinates.end(), finite) ? 1 : 0;
    for (const double w : problem.weights) good = good != 0 && w >= 0.0 && std::isfinite(w) ? 1 : 0;
    MPI_Allreduce(MPI_IN_PLACE, &good, 1, MPI_INT, MPI_MIN, problem.comm);
    if (good != 0) return {};
    return {origin +
            ": error: the partitioner `bisection` was given an element whose place or work is not finite, or "
            "whose work is negative; expected a run that is stable"};
  }

  std::vector<int> partition(const PartitionProblem& problem) override {
    const std::size_t n = problem.ids.size(), stride = static_cast<std::size_t>(problem.n_weights);
    std::vector<double> work(n);
    for (std::size_t i = 0; i < n; ++i) work[i] = problem.weights[i * stride];
    Cuts cuts;
    cuts.make(problem.comm, problem.n_parts, problem.coordinates, work);
    std::vector<int> parts(n);
    for (std::size_t i = 0; i < n; ++i) {
      const double* x = &problem.coordinates[3 * i];
      parts[i] = cuts.part_of({x[0], x[1], x[2]});
    }
    return parts;
  }
  std::unique_ptr<SpatialDecomposition> spatial() const override { return std::make_unique<BisectionDecomposition>(); }
};

}  // namespace
}  // namespace kerf

KERF_PARTITIONER(kerf::Bisection, "bisection", "recursive coordinate bisection by histograms: few messages, any count")
