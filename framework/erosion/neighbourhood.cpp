// Search for neighbours by a grid of cells as wide as the radius.
#include "erosion/neighbourhood.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

#include "core/assert.hpp"

namespace kerf {

namespace {

double weight_at(double r, const NonLocalAverage& law) {
  const double share = r / law.radius;
  if (law.bell) return (1.0 - share * share) * (1.0 - share * share);
  const double power = share > 1e-30 ? positive_power(share, law.p) : 0.0;
  return 1.0 / positive_power(1.0 + power, law.q);
}

using Cell = std::array<std::int64_t, 3>;

Cell cell_of(Vec3 x, double width) {
  return {static_cast<std::int64_t>(std::floor(x.x / width)), static_cast<std::int64_t>(std::floor(x.y / width)),
          static_cast<std::int64_t>(std::floor(x.z / width))};
}

/// Points by their cells.
class CellTable {
 public:
  CellTable(const std::vector<Neighbourhood::Point>& points, double width) : width_(width) {
    for (std::size_t i = 0; i < points.size(); ++i)
      entries_.push_back({cell_of(points[i].position, width), static_cast<std::int32_t>(i)});
    std::sort(entries_.begin(), entries_.end());
  }
  /// Calls `take` with all points of the cell of `x` and of the cells round it.
  template <class Take>
  void each_near(Vec3 x, const Take& take) const {
    const Cell home = cell_of(x, width_);
    for (std::int64_t i = -1; i <= 1; ++i)
      for (std::int64_t j = -1; j <= 1; ++j) {
        // Three cells in a row of the third direction lie side by side in the table.
        const std::int32_t least = std::numeric_limits<std::int32_t>::min();
        const Entry low{{home[0] + i, home[1] + j, home[2] - 1}, least};
        const Cell end{home[0] + i, home[1] + j, home[2] + 2};
        for (auto e = std::lower_bound(entries_.begin(), entries_.end(), low); e != entries_.end() && e->cell < end;
             ++e)
          take(e->point);
      }
  }

 private:
  struct Entry {
    Cell cell;
    std::int32_t point;
    auto operator<=>(const Entry&) const = default;
  };
  double width_;
  std::vector<Entry> entries_;
};

}  // namespace

Neighbourhood::Neighbourhood(const std::vector<Point>& points, std::size_t n_own, const NonLocalAverage& law) {
  KERF_ASSERT(law.radius > 0.0 && n_own <= points.size(), "a neighbourhood has a radius and points");
  const CellTable table(points, law.radius);
  first_.push_back(0);
  std::vector<std::int32_t> near;
  for (std::size_t i = 0; i < n_own; ++i) {
    near.clear();
    table.each_near(points[i].position, [&](std::int32_t k) {
      if (norm(points[k].position - points[i].position) <= law.radius) near.push_back(k);
    });
    std::sort(near.begin(), near.end(), [&](std::int32_t a, std::int32_t b) { return points[a].id < points[b].id; });
    double sum = 0.0;
    for (const std::int32_t k : near) {
      const double weight = weight_at(norm(points[k].position - points[i].position), law) * points[k].volume;
      terms_.push_back({k, weight});
      sum += weight;
    }
    first_.push_back(terms_.size());
    sum_.push_back(sum);
  }
}

double Neighbourhood::average(std::size_t i, const std::vector<double>& values) const {
  double sum = 0.0;
  for (std::size_t t = first_[i]; t < first_[i + 1]; ++t)
    sum += terms_[t].weight * values[static_cast<std::size_t>(terms_[t].point)];
  return sum / sum_[i];
}

}  // namespace kerf
