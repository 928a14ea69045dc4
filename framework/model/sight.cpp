// Boxes are halved along their longest side until few facets are left.
#include "model/sight.hpp"

#include <algorithm>
#include <cmath>

namespace kerf {

namespace {

constexpr double touch = 1e-9;  // of the way, and of the sides of a triangle

/// Where the way from + s d, 0 < s < 1, goes through a triangle (Moeller & Trumbore 1997).
bool crosses(Vec3 from, Vec3 d, Vec3 a, Vec3 b, Vec3 c) {
  const Vec3 u = b - a, v = c - a, normal = cross(d, v);
  const double det = dot(u, normal);
  if (!(std::fabs(det) > 1e-12 * norm(u) * norm(v) * norm(d))) return false;  // along the way, or no triangle
  const Vec3 to = from - a, other = cross(to, u);
  const double su = dot(to, normal) / det, sv = dot(d, other) / det, s = dot(v, other) / det;
  return s > touch && s < 1.0 - touch && su >= -touch && sv >= -touch && su + sv <= 1.0 + touch;
}

}  // namespace

Sight::Box Sight::box_of(const SightFacet& f) {
  Box b{f[0], f[0]};
  for (const Vec3 x : f)
    for (int d = 0; d < 3; ++d) {
      b.low[d] = std::min(b.low[d], x[d]);
      b.high[d] = std::max(b.high[d], x[d]);
    }
  return b;
}

Sight::Sight(std::vector<SightFacet> facets) : facets_(std::move(facets)) {
  if (!facets_.empty()) split(0, static_cast<int>(facets_.size()));
}

/// Makes the branch of some facets, and returns its number.
int Sight::split(int first, int last) {
  constexpr int few = 4;
  const auto begin = facets_.begin();
  Box all = box_of(facets_[static_cast<std::size_t>(first)]);
  for (int i = first; i < last; ++i) {
    const Box b = box_of(facets_[static_cast<std::size_t>(i)]);
    for (int d = 0; d < 3; ++d) {
      all.low[d] = std::min(all.low[d], b.low[d]);
      all.high[d] = std::max(all.high[d], b.high[d]);
    }
  }
  const int number = static_cast<int>(branches_.size());
  branches_.push_back({all, first, last, -1, -1});
  if (last - first <= few) return number;
  const Vec3 size = all.high - all.low;
  const int d = size.x >= size.y && size.x >= size.z ? 0 : size.y >= size.z ? 1 : 2;
  const int middle = (first + last) / 2;
  const auto place = [d](const SightFacet& f) { return f[0][d] + f[1][d] + f[2][d] + f[3][d]; };
  std::nth_element(begin + first, begin + middle, begin + last,
                   [&](const SightFacet& a, const SightFacet& b) { return place(a) < place(b); });
  const int left = split(first, middle), right = split(middle, last);
  branches_[static_cast<std::size_t>(number)].left = left;
  branches_[static_cast<std::size_t>(number)].right = right;
  return number;
}

bool Sight::is_free(Vec3 from, Vec3 to) const {
  if (branches_.empty()) return true;
  const Vec3 d = to - from;
  const auto may_meet = [&](const Box& box) {
    double enter = 0.0, leave = 1.0;
    for (int k = 0; k < 3; ++k) {
      const double slack = touch * (std::fabs(box.low[k]) + std::fabs(box.high[k]) + std::fabs(d[k]));
      const double low = box.low[k] - slack - from[k], high = box.high[k] + slack - from[k];
      if (d[k] == 0.0) {
        if (low > 0.0 || high < 0.0) return false;
        continue;
      }
      enter = std::max(enter, std::min(low / d[k], high / d[k]));
      leave = std::min(leave, std::max(low / d[k], high / d[k]));
    }
    return enter <= leave;
  };
  std::vector<int> open = {0};
  while (!open.empty()) {
    const Branch& b = branches_[static_cast<std::size_t>(open.back())];
    open.pop_back();
    if (!may_meet(b.box)) continue;
    if (b.left >= 0) {
      open.push_back(b.left);
      open.push_back(b.right);
      continue;
    }
    for (int i = b.first; i < b.last; ++i) {
      const SightFacet& f = facets_[static_cast<std::size_t>(i)];
      if (crosses(from, d, f[0], f[1], f[2]) || crosses(from, d, f[0], f[2], f[3])) return false;
    }
  }
  return true;
}

}  // namespace kerf
