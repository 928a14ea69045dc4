// Explicit vectors of `lane_width` doubles for element kernels, and the transposing gather and scatter.
//
// Built on GCC's vector extension: on machines with narrower registers the compiler splits each operation.
#pragma once

#include <cmath>
#include <cstdint>
#include <cstring>

#if defined(__AVX512F__) && defined(__AVX512DQ__)
#include <immintrin.h>
#endif

#include "kerf/math.hpp"

namespace kerf {

typedef double Lanes __attribute__((vector_size(sizeof(double) * lane_width)));
typedef std::int64_t LanesInt __attribute__((vector_size(sizeof(std::int64_t) * lane_width)));

inline Lanes lanes(double v) { return Lanes{} + v; }
inline Lanes load_lanes(const double* p) {
  Lanes v;
  std::memcpy(&v, p, sizeof v);
  return v;
}
inline void store_lanes(double* p, Lanes v) { std::memcpy(p, &v, sizeof v); }
inline Lanes max_of(Lanes a, Lanes b) { return a > b ? a : b; }
inline Lanes min_of(Lanes a, Lanes b) { return a < b ? a : b; }
inline Lanes abs_of(Lanes a) { return a < 0.0 ? -a : a; }

// The masked forms below take all lanes; the plain intrinsics trip GCC 12's -Wmaybe-uninitialized.
inline Lanes sqrt_of(Lanes a) {
#if defined(__AVX512F__) && defined(__AVX512DQ__)
  return reinterpret_cast<Lanes>(_mm512_maskz_sqrt_pd(0xff, reinterpret_cast<__m512d>(a)));
#else
  Lanes r;
  for (int l = 0; l < lane_width; ++l) r[l] = std::sqrt(a[l]);
  return r;
#endif
}

/// Nearest integer, ties to even. Pre: |a| < 2^62.
inline LanesInt round_to_int(Lanes a) {
#if defined(__AVX512F__) && defined(__AVX512DQ__)
  return reinterpret_cast<LanesInt>(_mm512_maskz_cvtpd_epi64(0xff, reinterpret_cast<__m512d>(a)));
#else
  LanesInt r;
  for (int l = 0; l < lane_width; ++l) r[l] = static_cast<std::int64_t>(std::rint(a[l]));
  return r;
#endif
}

/// Bit l is set where lane l of a comparison's result is true.
inline unsigned mask_of(LanesInt comparison) {
#if defined(__AVX512F__) && defined(__AVX512DQ__)
  return _mm512_movepi64_mask(reinterpret_cast<__m512i>(comparison));
#else
  unsigned mask = 0;
  for (int l = 0; l < lane_width; ++l) mask |= (comparison[l] != 0 ? 1u : 0u) << l;
  return mask;
#endif
}

static_assert(lane_width == 8, "the transposes below are written for eight lanes");

namespace detail {
template <class V>
struct QuadOf;
template <>
struct QuadOf<Lanes> {
  typedef double type __attribute__((vector_size(32)));
  using scalar = double;
};
template <>
struct QuadOf<LanesInt> {
  typedef std::int64_t type __attribute__((vector_size(32)));
  using scalar = std::int64_t;
};
template <class V>
inline V join(const typename QuadOf<V>::type& low, const typename QuadOf<V>::type& high) {
  return __builtin_shufflevector(low, high, 0, 1, 2, 3, 4, 5, 6, 7);
}
}  // namespace detail

/// Reads x, y, z of eight nodes (four entries per node) into three vectors.
inline void gather_vector(const double* nodal, const std::int32_t* node, Lanes& x, Lanes& y, Lanes& z) {
  using Quad = detail::QuadOf<Lanes>::type;
  Quad row[8];
  for (int l = 0; l < 8; ++l) std::memcpy(&row[l], nodal + 4 * static_cast<std::int64_t>(node[l]), sizeof(Quad));
  const Lanes c0 = detail::join<Lanes>(row[0], row[4]), c1 = detail::join<Lanes>(row[1], row[5]),
              c2 = detail::join<Lanes>(row[2], row[6]), c3 = detail::join<Lanes>(row[3], row[7]);
  const Lanes xz01 = __builtin_shufflevector(c0, c1, 0, 8, 2, 10, 4, 12, 6, 14);
  const Lanes xz23 = __builtin_shufflevector(c2, c3, 0, 8, 2, 10, 4, 12, 6, 14);
  const Lanes yw01 = __builtin_shufflevector(c0, c1, 1, 9, 3, 11, 5, 13, 7, 15);
  const Lanes yw23 = __builtin_shufflevector(c2, c3, 1, 9, 3, 11, 5, 13, 7, 15);
  x = __builtin_shufflevector(xz01, xz23, 0, 1, 8, 9, 4, 5, 12, 13);
  z = __builtin_shufflevector(xz01, xz23, 2, 3, 10, 11, 6, 7, 14, 15);
  y = __builtin_shufflevector(yw01, yw23, 0, 1, 8, 9, 4, 5, 12, 13);
}

/// Adds three vectors to x, y, z of eight nodes, lane after lane, so that lanes may share a node.
inline void scatter_add(std::int64_t* nodal, const std::int32_t* node, LanesInt x, LanesInt y, LanesInt z) {
  using Quad = detail::QuadOf<LanesInt>::type;
  const LanesInt zero{};
  const LanesInt xy_even = __builtin_shufflevector(x, y, 0, 8, 2, 10, 4, 12, 6, 14);
  const LanesInt xy_odd = __builtin_shufflevector(x, y, 1, 9, 3, 11, 5, 13, 7, 15);
  const LanesInt z_even = __builtin_shufflevector(z, zero, 0, 8, 2, 10, 4, 12, 6, 14);
  const LanesInt z_odd = __builtin_shufflevector(z, zero, 1, 9, 3, 11, 5, 13, 7, 15);
  // [x0 y0 z0 0 | x4 y4 z4 0] and so on
  const LanesInt rows[4] = {__builtin_shufflevector(xy_even, z_even, 0, 1, 8, 9, 4, 5, 12, 13),
                            __builtin_shufflevector(xy_odd, z_odd, 0, 1, 8, 9, 4, 5, 12, 13),
                            __builtin_shufflevector(xy_even, z_even, 2, 3, 10, 11, 6, 7, 14, 15),
                            __builtin_shufflevector(xy_odd, z_odd, 2, 3, 10, 11, 6, 7, 14, 15)};
  for (int half = 0; half < 2; ++half)
    for (int l = 0; l < 4; ++l) {
      const Quad add = half == 0 ? __builtin_shufflevector(rows[l], rows[l], 0, 1, 2, 3)
                                 : __builtin_shufflevector(rows[l], rows[l], 4, 5, 6, 7);
      std::int64_t* target = nodal + 4 * static_cast<std::int64_t>(node[l + 4 * half]);
      Quad sum;
      std::memcpy(&sum, target, sizeof sum);
      sum += add;
      std::memcpy(target, &sum, sizeof sum);
    }
}

}  // namespace kerf
