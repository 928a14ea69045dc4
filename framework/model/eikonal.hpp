// When a front with |grad t| = slowness arrives at a point, from its times at the corners of what lies in between:
// Fermat's principle over points, lines and triangles on which the time is taken as linear.
//
// Sources: R. Kimmel & J.A. Sethian, "Computing geodesic paths on manifolds", Proc. Natl. Acad. Sci. 95 (1998)
// 8431-8435, for the update from simplices. Sums, products, quotients and square roots only, so that the bits are the
// same everywhere.
#pragma once

#include <cmath>
#include <limits>

#include "kerf/math.hpp"

namespace kerf::eikonal {

inline constexpr double never = std::numeric_limits<double>::infinity();

/// A point at which the time of arrival is known.
struct Known {
  Vec3 x;  // [m]
  double time = never;  // [s]
};

inline double from_point(Vec3 x, const Known& p, double slowness) { return p.time + slowness * norm(x - p.x); }

/// By a point inside of the line, where such a way is the shortest; otherwise `never`, for an end is on the shorter
/// way.
inline double from_line(Vec3 x, const Known& p, const Known& q, double slowness) {
  const Vec3 along = q.x - p.x, to = x - p.x;
  const double length2 = dot(along, along);
  if (!(length2 > 0.0) || !(p.time < never) || !(q.time < never)) return never;
  const double length = std::sqrt(length2), rate = (q.time - p.time) / length;
  const double across2 = slowness * slowness - rate * rate;
  if (!(across2 > 0.0)) return never;
  const double place = dot(to, along) / length;
  const Vec3 beside = to - along * (place / length);
  const double height = norm(beside), across = std::sqrt(across2), crossing = place - height * rate / across;
  return crossing >= 0.0 && crossing <= length ? p.time + rate * place + across * height : never;
}

/// The same of a triangle.
inline double from_triangle(Vec3 x, const Known& a, const Known& b, const Known& c, double slowness) {
  if (!(a.time < never) || !(b.time < never) || !(c.time < never)) return never;
  const Vec3 u = b.x - a.x, v = c.x - a.x, to = x - a.x;
  const double uu = dot(u, u), uv = dot(u, v), vv = dot(v, v), det = uu * vv - uv * uv;
  if (!(det > 1e-12 * uu * vv)) return never;  // a line
  const auto shares = [&](double on_u, double on_v, double& of_u, double& of_v) {
    of_u = (vv * on_u - uv * on_v) / det;
    of_v = (uu * on_v - uv * on_u) / det;
  };
  double gu = 0.0, gv = 0.0;
  shares(b.time - a.time, c.time - a.time, gu, gv);
  const Vec3 gradient = u * gu + v * gv;
  const double across2 = slowness * slowness - dot(gradient, gradient);
  if (!(across2 > 0.0)) return never;
  const Vec3 area = cross(u, v);
  const double height = std::fabs(dot(to, area)) / std::sqrt(dot(area, area)), across = std::sqrt(across2);
  // The way to x leaves the triangle's plane beside x by the gradient's share.
  const Vec3 from = to - gradient * (height / across);
  double su = 0.0, sv = 0.0;
  shares(dot(from, u), dot(from, v), su, sv);
  if (!(su >= 0.0 && sv >= 0.0 && su + sv <= 1.0)) return never;
  return a.time + dot(gradient, to) + across * height;
}

}  // namespace kerf::eikonal
