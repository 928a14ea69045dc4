// Closest points of facets, taken as four triangles round their centre, to a node.
#pragma once

#include <cmath>
#include <cstdint>

#include <kerf/contact_geometry.hpp>
#include <kerf/lanes.hpp>

#include <kerf/surfaces/side_by_side.hpp>

namespace kerf::surfaces {

// A facet has four triangles: a register of most machines holds one number of each.
typedef double Four __attribute__((vector_size(32)));
typedef std::int64_t FourInt __attribute__((vector_size(32)));
using FourVectors = SideBySide<Four>;

inline Four root(Four a) { return Four{std::sqrt(a[0]), std::sqrt(a[1]), std::sqrt(a[2]), std::sqrt(a[3])}; }
inline FourVectors all_four(Vec3 v) { return {Four{} + v.x, Four{} + v.y, Four{} + v.z}; }
/// Each lane takes its successor's vector, the last one the first one's.
inline FourVectors turned(const FourVectors& v) {
  const auto turn = [](Four a) { return __builtin_shufflevector(a, a, 1, 2, 3, 0); };
  return {turn(v.x), turn(v.y), turn(v.z)};
}

/// Four rows of three components and a fourth that is left out, as vectors side by side.
inline FourVectors transposed(const Four (&row)[4]) {
  const Four xz01 = __builtin_shufflevector(row[0], row[1], 0, 4, 2, 6);
  const Four xz23 = __builtin_shufflevector(row[2], row[3], 0, 4, 2, 6);
  const Four yw01 = __builtin_shufflevector(row[0], row[1], 1, 5, 3, 7);
  const Four yw23 = __builtin_shufflevector(row[2], row[3], 1, 5, 3, 7);
  return {__builtin_shufflevector(xz01, xz23, 0, 1, 4, 5), __builtin_shufflevector(yw01, yw23, 0, 1, 4, 5),
          __builtin_shufflevector(xz01, xz23, 2, 3, 6, 7)};
}

/// Closest point of a triangle to a point (Ericson, Real-Time Collision Detection, 2005, section 5.1.5).
struct Closest {
  double a = 0.0, b = 0.0, c = 0.0;  // barycentric
  bool inside = false;  // interior to the triangle
};

inline Closest closest_on_triangle(Vec3 p, Vec3 a, Vec3 b, Vec3 c) {
  const Vec3 ab = b - a, ac = c - a, ap = p - a;
  const double d1 = dot(ab, ap), d2 = dot(ac, ap);
  if (d1 <= 0.0 && d2 <= 0.0) return {1, 0, 0, false};
  const Vec3 bp = p - b;
  const double d3 = dot(ab, bp), d4 = dot(ac, bp);
  if (d3 >= 0.0 && d4 <= d3) return {0, 1, 0, false};
  const double vc = d1 * d4 - d3 * d2;
  if (vc <= 0.0 && d1 >= 0.0 && d3 <= 0.0) {
    const double t = d1 - d3 > 0.0 ? d1 / (d1 - d3) : 0.0;
    return {1 - t, t, 0, false};
  }
  const Vec3 cp = p - c;
  const double d5 = dot(ab, cp), d6 = dot(ac, cp);
  if (d6 >= 0.0 && d5 <= d6) return {0, 0, 1, false};
  const double vb = d5 * d2 - d1 * d6;
  if (vb <= 0.0 && d2 >= 0.0 && d6 <= 0.0) {
    const double t = d2 - d6 > 0.0 ? d2 / (d2 - d6) : 0.0;
    return {1 - t, 0, t, false};
  }
  const double va = d3 * d6 - d5 * d4;
  if (va <= 0.0 && d4 - d3 >= 0.0 && d5 - d6 >= 0.0) {
    const double sum = (d4 - d3) + (d5 - d6);
    const double t = sum > 0.0 ? (d4 - d3) / sum : 0.0;
    return {0, 1 - t, t, false};
  }
  const double denominator = va + vb + vc;
  if (!(denominator > 0.0)) return {1, 0, 0, false};
  const double v = vb / denominator, w = vc / denominator;
  return {1 - v - w, v, w, true};
}

/// The four triangles of a facet side by side: corners x[k], x[k + 1], centre.
struct Triangles {
  FourVectors corner, centre;

  Triangles(const ContactView& view, int facet) {
    const std::int32_t* n = view.facet_nodes + 4 * static_cast<std::int64_t>(facet);
    Four row[4];
    for (int k = 0; k < 4; ++k) row[k] = detail::row_of(view.position, n[k]);
    corner = transposed(row);
    const Four mean = (row[0] + row[1] + row[2] + row[3]) * 0.25;
    centre = all_four({mean[0], mean[1], mean[2]});
  }
};

/// Closest points of four triangles to one point, all at once: the same choices and the same arithmetic, lane by lane,
/// as closest_on_triangle.
struct FourClosest {
  Four a, b, c;  // barycentric
  FourInt inside;  // interior to the triangle
  FourVectors way;  // from the closest point to the node
  Four square;  // of its length [m2]

  FourClosest(const FourVectors& corner, const FourVectors& next, const FourVectors& centre, const FourVectors& p) {
    const FourVectors ab = next - corner, ac = centre - corner, ap = p - corner, bp = p - next, cp = p - centre;
    const Four d1 = dot(ab, ap), d2 = dot(ac, ap), d3 = dot(ab, bp), d4 = dot(ac, bp), d5 = dot(ab, cp),
               d6 = dot(ac, cp);
    const Four vc = d1 * d4 - d3 * d2, vb = d5 * d2 - d1 * d6, va = d3 * d6 - d5 * d4;
    // Whatever comes first wins.
    const FourInt at_a = (d1 <= 0.0) & (d2 <= 0.0);
    FourInt before = at_a;
    const auto first = [&before](FourInt holds) {
      const FourInt is_first = holds & ~before;
      before |= holds;
      return is_first;
    };
    const FourInt at_b = first((d3 >= 0.0) & (d4 <= d3)), on_ab = first((vc <= 0.0) & (d1 >= 0.0) & (d3 <= 0.0));
    const FourInt at_c = first((d6 >= 0.0) & (d5 <= d6)), on_ac = first((vb <= 0.0) & (d2 >= 0.0) & (d6 <= 0.0));
    const FourInt on_bc = first((va <= 0.0) & (d4 - d3 >= 0.0) & (d5 - d6 >= 0.0));
    const Four over = on_ab ? d1 : on_ac ? d2 : on_bc ? d4 - d3 : vb;
    const Four under = on_ab ? d1 - d3 : on_ac ? d2 - d6 : on_bc ? (d4 - d3) + (d5 - d6) : va + vb + vc;
    const FourInt sound = under > 0.0;
    const Four zero{}, one = zero + 1.0;
    const Four t = sound ? over / under : zero, w = vc / under;
    inside = sound & ~before;
    // Without a sound denominator the corner stands for the inside.
    const FourInt corner_a = at_a | ~(before | sound), corner_b = at_b, corner_c = at_c;
    a = corner_a ? one : (corner_b | corner_c | on_bc) ? zero : inside ? one - t - w : one - t;
    b = corner_b ? one : (corner_a | corner_c | on_ac) ? zero : on_bc ? one - t : t;
    c = corner_c ? one : (corner_a | corner_b | on_ab) ? zero : inside ? w : t;
    way = p - (corner * a + next * b + centre * c);
    square = dot(way, way);
  }
};

/// The closest point of a facet, and on which side of it the node lies.
struct Touch {
  double weights[4] = {};
  Vec3 direction;  // outward unit vector from the node to the point if below, from the point if above
  double distance = 1e300;  // [m]
  double side = 0.0;  // cosine between (node - point) and the normal there; negative below
  double lowest = 1.0;  // the least side of all triangles that hold the point
};

/// One piece of code for all callers: inlined, it might be contracted in another way at each.
[[gnu::noinline]] inline Touch touch_facet(const Triangles& facet, double size, Vec3 s) {
  const FourVectors next = turned(facet.corner);
  const FourClosest closest(facet.corner, next, facet.centre, all_four(s));
  const FourVectors twice = cross(next - facet.corner, facet.centre - facet.corner);
  const Four length = root(dot(twice, twice)), zero{};
  const FourVectors normal = twice * (1.0 / length);
  const Four distance = root(closest.square);
  const Four side = distance > 0.0 ? dot(closest.way, normal) / distance : zero;
  double least = closest.square[0];
  for (int k = 1; k < 4; ++k) least = min_of(closest.square[k], least);
  // Two triangles share the closest point on an edge: the one that faces the node decides the side.
  const double limit = std::sqrt(least) + 1e-9 * size;
  const FourInt counts = (closest.square <= limit * limit) & (length > 0.0);
  int found = -1;
  double lowest = 1.0;
  for (int k = 0; k < 4; ++k) {
    if (counts[k] == 0) continue;
    lowest = min_of(lowest, side[k]);
    if (found < 0 || std::fabs(side[k]) > std::fabs(side[found])) found = k;
  }
  Touch best;
  if (found < 0) return best;
  // Where several triangles are equally close and face the node equally well, their mean: what is symmetric stays so.
  Vec3 direction;
  double n = 0.0;
  for (int k = 0; k < 4; ++k) {
    if (counts[k] == 0 || !(side[k] * side[found] >= side[found] * side[found] * (1.0 - 1e-9))) continue;
    best.weights[k] += closest.a[k] + 0.25 * closest.c[k];
    best.weights[(k + 1) % 4] += closest.b[k] + 0.25 * closest.c[k];
    best.weights[(k + 2) % 4] += 0.25 * closest.c[k];
    best.weights[(k + 3) % 4] += 0.25 * closest.c[k];
    direction = direction + (closest.inside[k] != 0 || !(distance[k] > 0.0)
                                 ? normal.at(k)
                                 : closest.way.at(k) * ((side[k] < 0.0 ? -1.0 : 1.0) / distance[k]));
    n += 1.0;
  }
  if (n > 1.0) {
    for (double& weight : best.weights) weight /= n;
    const double size_of_sum = norm(direction);
    direction = size_of_sum > 0.0 ? direction * (1.0 / size_of_sum) : normal.at(found);
  }
  best.distance = distance[found];
  best.side = side[found];
  best.direction = direction;
  best.lowest = lowest;
  return best;
}

}  // namespace kerf::surfaces
