// Recursive coordinate bisection by histograms: two or three reductions for each doubling of the number of parts,
// whatever the number of points. Contact uses it by default, because its boxes of space are made anew often.
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
  std::array<double, 3> low{}, high{};  // of the box round its points [m]
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
  /// The interval of one axis that a region's cut across that axis is in.
  struct Window {
    std::int32_t region;
    int axis;
    double low, high;  // [m]
    std::int64_t below = 0, inside = 0, total = 0;  // weight of the region below the window, in it, and in all

    double target(const Region& r) const { return r.share() * static_cast<double>(total); }
    /// Whether the cut is below what is in the window, which is nearer to the share than above it.
    bool is_below(const Region& r) const {
      return target(r) - static_cast<double>(below) < 0.5 * static_cast<double>(inside);
    }
    /// Weight on the wrong side of the cut.
    double error(const Region& r) const {
      return std::fabs(static_cast<double>(is_below(r) ? below : below + inside) - target(r));
    }
  };
  void add_parts(std::size_t region, Vec3 low, Vec3 high, std::vector<int>& parts) const;
  double enclose(MPI_Comm comm, const std::vector<std::int32_t>& open);
  void cut_level(MPI_Comm comm, std::vector<std::int32_t>& open);
  void narrow(MPI_Comm comm, std::vector<Window>& windows, std::size_t n_bins);
  static const Window& best_of(const Region& region, const Window* of_axes);
  static double cut_of(const Region& region, const Window& w);
  std::int32_t add_child(const Region& parent, bool upper);

  std::vector<Region> regions_;
  // While cuts are made:
  std::span<const double> coordinates_, weights_;
  std::vector<std::int32_t> region_of_;  // per point
  double per_weight_ = 1.0;  // units of weight; 0 where no point has any
};

/// Sets the boxes of open regions to those round their points: a flat surface is cut within its plane, however thick
/// the region is. Returns the greatest weight of all points. Collective.
double Cuts::enclose(MPI_Comm comm, const std::vector<std::int32_t>& open) {
  constexpr double far = std::numeric_limits<double>::max();
  std::vector<std::int32_t> place(regions_.size(), -1);
  for (std::size_t k = 0; k < open.size(); ++k) place[open[k]] = static_cast<std::int32_t>(k);
  std::vector<double> most(6 * open.size() + 1, -far);  // of -x and x, and of weights
  most.back() = 0.0;
  for (std::size_t i = 0; i < weights_.size(); ++i) {
    most.back() = max_of(most.back(), weights_[i]);
    if (place[region_of_[i]] < 0) continue;
    double* row = &most[6 * static_cast<std::size_t>(place[region_of_[i]])];
    for (std::size_t d = 0; d < 3; ++d) {
      row[d] = max_of(row[d], -coordinates_[3 * i + d]);
      row[3 + d] = max_of(row[3 + d], coordinates_[3 * i + d]);
    }
  }
  MPI_Allreduce(MPI_IN_PLACE, most.data(), static_cast<int>(most.size()), MPI_DOUBLE, MPI_MAX, comm);
  for (std::size_t k = 0; k < open.size(); ++k)
    for (std::size_t d = 0; d < 3; ++d) {
      const bool empty = most[6 * k + d] == -far;
      regions_[open[k]].low[d] = empty ? 0.0 : -most[6 * k + d];
      regions_[open[k]].high[d] = empty ? 0.0 : most[6 * k + 3 + d];
    }
  return most.back();
}

std::int32_t Cuts::add_child(const Region& parent, bool upper) {
  Region child;
  child.n_parts = upper ? parent.n_parts - parent.n_lower() : parent.n_lower();
  child.first = parent.first + (upper ? parent.n_lower() : 0);
  regions_.push_back(child);
  return static_cast<std::int32_t>(regions_.size()) - 1;
}

/// Narrows every window down to the bin of a histogram in which its region's share of the weight is reached. There are
/// three windows for each region, one after the other.
void Cuts::narrow(MPI_Comm comm, std::vector<Window>& windows, std::size_t n_bins) {
  const std::size_t row = n_bins + 1;
  std::vector<std::int32_t> first(regions_.size(), -1);
  for (std::size_t k = 0; k < windows.size(); k += 3) first[windows[k].region] = static_cast<std::int32_t>(k);
  Sums sums(row * windows.size(), 0);  // the last of a row is the weight of all points of the region
  for (std::size_t i = 0; i < weights_.size(); ++i) {
    if (first[region_of_[i]] < 0) continue;
    const std::int64_t weight = per_weight_ > 0.0 ? std::llrint(weights_[i] * per_weight_) : 1;  // or all are zero
    for (std::size_t d = 0; d < 3; ++d) {
      const std::size_t k = static_cast<std::size_t>(first[region_of_[i]]) + d;
      const Window& w = windows[k];
      const double x = coordinates_[3 * i + d];
      sums[row * k + n_bins] += weight;
      if (!(x >= w.low && x <= w.high)) continue;
      const double at = w.high > w.low ? (x - w.low) / (w.high - w.low) * static_cast<double>(n_bins) : 0.0;
      sums[row * k + std::min(static_cast<std::size_t>(at), n_bins - 1)] += weight;
    }
  }
  MPI_Allreduce(MPI_IN_PLACE, sums.data(), static_cast<int>(sums.size()), MPI_INT64_T, MPI_SUM, comm);
  for (std::size_t k = 0; k < windows.size(); ++k) {
    Window& w = windows[k];
    w.total = sums[row * k + n_bins];
    const double target = w.target(regions_[w.region]), edge = w.high - w.low;
    std::size_t bin = 0;
    while (bin + 1 < n_bins && static_cast<double>(w.below + sums[row * k + bin]) < target)
      w.below += sums[row * k + bin++];
    const double low = w.low;
    w.low = low + edge * static_cast<double>(bin) / static_cast<double>(n_bins);
    w.high = low + edge * static_cast<double>(bin + 1) / static_cast<double>(n_bins);
    w.inside = sums[row * k + bin];
  }
}

/// Of the cuts across the three axes, the one across the longest edge that leaves little on the wrong side; where all
/// leave much, the one that leaves least. Many points in one plane cannot be parted across the plane.
const Cuts::Window& Cuts::best_of(const Region& region, const Window* of_axes) {
  const double little = std::max(0.1 / region.n_parts, 0.01);  // of the weight of the region
  const auto edge = [&](const Window& w) { return region.high[w.axis] - region.low[w.axis]; };
  const Window *longest = nullptr, *fairest = of_axes;
  for (const Window* w = of_axes; w != of_axes + 3; ++w) {
    if (w->error(region) < fairest->error(region)) fairest = w;
    if (w->error(region) > little * static_cast<double>(w->total)) continue;
    if (longest == nullptr || edge(*w) > edge(*longest)) longest = w;
  }
  return longest ? *longest : *fairest;
}

/// Above or below what is in the window, whichever is nearer to the share; in the middle of a region without points.
double Cuts::cut_of(const Region& region, const Window& w) {
  if (w.total == 0) return std::midpoint(region.low[w.axis], region.high[w.axis]);
  return w.is_below(region) ? std::nextafter(w.low, -std::numeric_limits<double>::infinity()) : w.high;
}

/// Cuts all open regions, whose children take their place. Collective.
void Cuts::cut_level(MPI_Comm comm, std::vector<std::int32_t>& open) {
  constexpr double units = 1u << 20;  // of the greatest weight
  const double greatest = enclose(comm, open);
  per_weight_ = greatest > 0.0 ? units / greatest : 0.0;
  std::vector<Window> windows;
  for (const std::int32_t r : open)
    for (int d = 0; d < 3; ++d) windows.push_back({r, d, regions_[r].low[d], regions_[r].high[d]});
  constexpr std::size_t most_bins = 4096, least_bins = 32, most_sums = 1u << 17, fine = 1024;
  const std::size_t n_bins = std::clamp(most_sums / windows.size(), least_bins, most_bins);
  for (std::size_t slices = 1; slices < fine; slices *= n_bins) narrow(comm, windows, n_bins);
  std::vector<std::int32_t> next;
  for (std::size_t k = 0; k < open.size(); ++k) {
    Region region = regions_[open[k]];
    const Window& w = best_of(region, &windows[3 * k]);
    region.axis = w.axis;
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
  Region all;
  all.n_parts = n_parts;
  regions_.assign(1, all);
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
