// Vectors of four numbers, as nodes store positions, velocities and forces: three components and one that is spare.
#pragma once

#include <cstdint>
#include <cstring>

#include "kerf/math.hpp"

namespace kerf {

typedef double Quad __attribute__((vector_size(32)));
typedef std::int64_t QuadInt __attribute__((vector_size(32)));

/// Row `i` of an array with four entries per row, on a boundary of 32 bytes.
inline Quad row_of(const double* rows, int i) {
  Quad q;
  std::memcpy(&q, __builtin_assume_aligned(rows + 4 * static_cast<std::int64_t>(i), sizeof q), sizeof q);
  return q;
}
inline QuadInt row_of(const std::int64_t* rows, int i) {
  QuadInt q;
  std::memcpy(&q, __builtin_assume_aligned(rows + 4 * static_cast<std::int64_t>(i), sizeof q), sizeof q);
  return q;
}
inline void set_row(double* rows, int i, Quad q) {
  std::memcpy(__builtin_assume_aligned(rows + 4 * static_cast<std::int64_t>(i), sizeof q), &q, sizeof q);
}

inline Vec3 vector_of(const Quad& q) { return {q[0], q[1], q[2]}; }
inline Quad quad_of(Vec3 v) { return Quad{v.x, v.y, v.z, 0.0}; }

}  // namespace kerf
