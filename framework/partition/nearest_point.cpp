// Sorts points into boxes, and searches the boxes from the inside to the outside.
#include "partition/nearest_point.hpp"

#include <algorithm>
#include <cmath>
#include <cstdlib>

#include "core/assert.hpp"
#include "kerf/functions.hpp"

namespace kerf {

void PointBounds::take(Vec3 x) {
  for (int d = 0; d < 3; ++d) {
    low[d] = std::min(low[d], x[d]);
    high[d] = std::max(high[d], x[d]);
  }
}

double PointBounds::longest_edge() const {
  double longest = 0.0;
  for (int d = 0; d < 3; ++d) longest = std::max(longest, high[d] - low[d]);
  return longest;
}

NearestPoint::NearestPoint(const std::vector<double>& points, const PointBounds& bounds)
    : points_(points), low_(bounds.low) {
  const std::size_t n = points.size() / 3;
  const double longest = bounds.longest_edge();
  KERF_ASSERT(n > 0 && longest > 0.0, "a search for the nearest point has points to search");
  double volume = 1.0;
  // A flat cloud of points has some thickness here, so that the number of boxes stays bounded.
  for (int d = 0; d < 3; ++d) volume *= std::max(bounds.high[d] - bounds.low[d], 1e-3 * longest);
  edge_ = kerf::pow(volume / static_cast<double>(n), 1.0 / 3.0);
  for (int d = 0; d < 3; ++d) n_[d] = static_cast<int>((bounds.high[d] - bounds.low[d]) / edge_) + 1;
  boxes_.resize(static_cast<std::size_t>(n_[0]) * n_[1] * n_[2]);
  for (std::size_t i = 0; i < n; ++i) boxes_[box_of(cell_of(point(i)))].push_back(i);
}

std::size_t NearestPoint::find(Vec3 x) const {
  const Cell home = cell_of(x);
  const int most = std::max({n_[0], n_[1], n_[2]});
  Best best;
  for (int ring = 0; ring <= most; ++ring) {
    // What is in this ring, or farther out, is at least so far away. A point outside of the grid is farther still.
    const double clear = (ring - 1) * edge_;
    if (clear > 0.0 && clear * clear > best.square) break;
    look_in_ring(home, ring, x, best);
  }
  return best.point;
}

NearestPoint::Cell NearestPoint::cell_of(Vec3 x) const {
  Cell cell{};
  for (int d = 0; d < 3; ++d)
    cell[d] = static_cast<int>(std::clamp((x[d] - low_[d]) / edge_, 0.0, static_cast<double>(n_[d] - 1)));
  return cell;
}

/// The boxes of the surface of a cube round the home box.
void NearestPoint::look_in_ring(const Cell& home, int ring, Vec3 x, Best& best) const {
  Cell c{};
  for (c[2] = std::max(home[2] - ring, 0); c[2] <= std::min(home[2] + ring, n_[2] - 1); ++c[2])
    for (c[1] = std::max(home[1] - ring, 0); c[1] <= std::min(home[1] + ring, n_[1] - 1); ++c[1]) {
      const bool on_side = std::abs(c[2] - home[2]) == ring || std::abs(c[1] - home[1]) == ring;
      const int step = on_side || ring == 0 ? 1 : 2 * ring;  // between the sides only the two ends
      for (c[0] = home[0] - ring; c[0] <= home[0] + ring; c[0] += step)
        if (c[0] >= 0 && c[0] < n_[0]) look_in_box(c, x, best);
    }
}

void NearestPoint::look_in_box(const Cell& cell, Vec3 x, Best& best) const {
  for (const std::size_t i : boxes_[box_of(cell)]) {
    const Vec3 way = point(i) - x;
    const double square = dot(way, way);
    if (square < best.square || (square == best.square && i < best.point)) best = {i, square};
  }
}

}  // namespace kerf
