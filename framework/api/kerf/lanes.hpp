// Explicit vectors for element kernels, as wide as the machine's registers, and the transposing gather and scatter.
//
// A block of `lane_width` elements is computed in `n_pieces` pieces of `register_lanes`: vectors that are wider than a
// register would live in memory.
#pragma once

#include <cmath>
#include <cstdint>
#include <cstring>

#ifdef __SSE2__
#include <immintrin.h>
#endif

#include "kerf/math.hpp"

namespace kerf {

#if defined(__AVX512F__) && defined(__AVX512DQ__)
inline constexpr int register_lanes = 8;
#elif defined(__AVX2__)
inline constexpr int register_lanes = 4;
#else
inline constexpr int register_lanes = 2;
#endif
inline constexpr int n_pieces = lane_width / register_lanes;
static_assert(lane_width % register_lanes == 0 && lane_width <= 8, "blocks are made of whole pieces");

typedef double Lanes __attribute__((vector_size(sizeof(double) * register_lanes)));
typedef std::int64_t LanesInt __attribute__((vector_size(sizeof(std::int64_t) * register_lanes)));

/// Calls `work(first lane)` for every piece of a block. One piece of code serves all of them, so that no lane's
/// arithmetic is contracted in another way than its neighbour's.
template <class Work>
[[gnu::always_inline]] inline void each_piece(const Work& work) {
#pragma GCC unroll 1
  for (int lane = 0; lane < lane_width; lane += register_lanes) work(lane);
}

inline Lanes lanes(double v) { return Lanes{} + v; }
/// Pre, here and below: `p` lies on a boundary of sizeof(Lanes). Rows of a block that are declared alignas(64) do on
/// every machine, and so do the arrays of ElementWork.
inline Lanes load_lanes(const double* p) {
  Lanes v;
  std::memcpy(&v, __builtin_assume_aligned(p, sizeof v), sizeof v);
  return v;
}
inline void store_lanes(double* p, Lanes v) { std::memcpy(__builtin_assume_aligned(p, sizeof v), &v, sizeof v); }
inline LanesInt load_lanes(const std::int64_t* p) {
  LanesInt v;
  std::memcpy(&v, __builtin_assume_aligned(p, sizeof v), sizeof v);
  return v;
}
inline void store_lanes(std::int64_t* p, LanesInt v) {
  std::memcpy(__builtin_assume_aligned(p, sizeof v), &v, sizeof v);
}
inline Lanes max_of(Lanes a, Lanes b) { return a > b ? a : b; }
inline Lanes min_of(Lanes a, Lanes b) { return a < b ? a : b; }
inline Lanes abs_of(Lanes a) {
  return reinterpret_cast<Lanes>(reinterpret_cast<LanesInt>(a) & std::int64_t{0x7fffffffffffffff});
}

#if defined(__AVX512F__) && defined(__AVX512DQ__)

// The masked forms below take all lanes; the plain intrinsics trip GCC 12's -Wmaybe-uninitialized.
inline Lanes sqrt_of(Lanes a) {
  return reinterpret_cast<Lanes>(_mm512_maskz_sqrt_pd(0xff, reinterpret_cast<__m512d>(a)));
}
/// Nearest integer, ties to even. Pre: |a| < 2^62.
inline LanesInt round_to_int(Lanes a) {
  return reinterpret_cast<LanesInt>(_mm512_maskz_cvtpd_epi64(0xff, reinterpret_cast<__m512d>(a)));
}
/// The same where |a| < small_limit.
inline LanesInt round_small_to_int(Lanes a) { return round_to_int(a); }
/// Bit l is set where lane l of a comparison's result is true.
inline unsigned mask_of(LanesInt comparison) { return _mm512_movepi64_mask(reinterpret_cast<__m512i>(comparison)); }

#else

inline constexpr double small_shift = 0x1.8p52;  // added, it leaves whole numbers in the low bits
/// The same as round_to_int where |a| < small_limit.
inline LanesInt round_small_to_int(Lanes a) {
  return reinterpret_cast<LanesInt>(a + small_shift) - reinterpret_cast<LanesInt>(lanes(small_shift));
}

#ifdef __AVX2__

inline Lanes sqrt_of(Lanes a) { return reinterpret_cast<Lanes>(_mm256_sqrt_pd(reinterpret_cast<__m256d>(a))); }
inline unsigned mask_of(LanesInt comparison) {
  return static_cast<unsigned>(_mm256_movemask_pd(reinterpret_cast<__m256d>(comparison)));
}
/// Nearest integer, ties to even. Pre: |a| < 2^62.
inline LanesInt round_to_int(Lanes a) {
  const __m256d whole = _mm256_round_pd(reinterpret_cast<__m256d>(a), _MM_FROUND_TO_NEAREST_INT | _MM_FROUND_NO_EXC);
  // High and low 32 bits apart: each is exact, and few enough bits to be shifted into place.
  const __m256d high = _mm256_floor_pd(_mm256_mul_pd(whole, _mm256_set1_pd(0x1p-32)));
  const __m256d low = _mm256_sub_pd(whole, _mm256_mul_pd(high, _mm256_set1_pd(0x1p32)));
  const __m256i high_bits = _mm256_castpd_si256(_mm256_add_pd(high, _mm256_set1_pd(small_shift)));
  const __m256i low_bits = _mm256_castpd_si256(_mm256_add_pd(low, _mm256_set1_pd(0x1p52)));
  return reinterpret_cast<LanesInt>(_mm256_blend_epi32(_mm256_slli_epi64(high_bits, 32), low_bits, 0b01010101));
}

#else

inline Lanes sqrt_of(Lanes a) {
  Lanes r;
  for (int l = 0; l < register_lanes; ++l) r[l] = std::sqrt(a[l]);
  return r;
}
inline unsigned mask_of(LanesInt comparison) {
  unsigned mask = 0;
  for (int l = 0; l < register_lanes; ++l) mask |= (comparison[l] != 0 ? 1u : 0u) << l;
  return mask;
}
/// Nearest integer, ties to even. Pre: |a| < 2^62.
inline LanesInt round_to_int(Lanes a) {
  LanesInt r;
  for (int l = 0; l < register_lanes; ++l) r[l] = std::llrint(a[l]);
  return r;
}

#endif
#endif

inline constexpr double small_limit = 0x1p51;  // of round_small_to_int
inline constexpr unsigned all_lanes = (1u << register_lanes) - 1u;  // mask_of a comparison that holds everywhere

namespace detail {
typedef double Quad __attribute__((vector_size(32), may_alias));
typedef std::int64_t QuadInt __attribute__((vector_size(32), may_alias));

/// One node's four entries. Nodes lie on boundaries of 32 bytes.
[[gnu::always_inline]] inline const Quad& row_of(const double* nodal, std::int32_t node) {
  return *reinterpret_cast<const Quad*>(nodal + 4 * static_cast<std::int64_t>(node));
}
[[gnu::always_inline]] inline void add_to_row(std::int64_t* nodal, std::int32_t node, const QuadInt& add) {
  *reinterpret_cast<QuadInt*>(nodal + 4 * static_cast<std::int64_t>(node)) += add;
}
}  // namespace detail

#if defined(__AVX512F__) && defined(__AVX512DQ__)

/// Reads the four entries of as many rows as there are lanes into four vectors. Rows lie on boundaries of 32 bytes.
inline void gather_rows(const double* rows, const std::int32_t* number, Lanes& x, Lanes& y, Lanes& z, Lanes& w) {
  detail::Quad row[8];
  for (int l = 0; l < 8; ++l) row[l] = detail::row_of(rows, number[l]);
  const auto join = [&](int a, int b) { return __builtin_shufflevector(row[a], row[b], 0, 1, 2, 3, 4, 5, 6, 7); };
  const Lanes c0 = join(0, 4), c1 = join(1, 5), c2 = join(2, 6), c3 = join(3, 7);
  const Lanes xz01 = __builtin_shufflevector(c0, c1, 0, 8, 2, 10, 4, 12, 6, 14);
  const Lanes xz23 = __builtin_shufflevector(c2, c3, 0, 8, 2, 10, 4, 12, 6, 14);
  const Lanes yw01 = __builtin_shufflevector(c0, c1, 1, 9, 3, 11, 5, 13, 7, 15);
  const Lanes yw23 = __builtin_shufflevector(c2, c3, 1, 9, 3, 11, 5, 13, 7, 15);
  x = __builtin_shufflevector(xz01, xz23, 0, 1, 8, 9, 4, 5, 12, 13);
  z = __builtin_shufflevector(xz01, xz23, 2, 3, 10, 11, 6, 7, 14, 15);
  y = __builtin_shufflevector(yw01, yw23, 0, 1, 8, 9, 4, 5, 12, 13);
  w = __builtin_shufflevector(yw01, yw23, 2, 3, 10, 11, 6, 7, 14, 15);
}

/// Adds three vectors to x, y, z of a piece's nodes, lane after lane, so that lanes may share a node.
inline void scatter_add(std::int64_t* nodal, const std::int32_t* node, LanesInt x, LanesInt y, LanesInt z) {
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
  for (int l = 0; l < 4; ++l) detail::add_to_row(nodal, node[l], __builtin_shufflevector(rows[l], rows[l], 0, 1, 2, 3));
  for (int l = 0; l < 4; ++l)
    detail::add_to_row(nodal, node[l + 4], __builtin_shufflevector(rows[l], rows[l], 4, 5, 6, 7));
}

#elif defined(__AVX2__)

/// Reads the four entries of as many rows as there are lanes into four vectors. Rows lie on boundaries of 32 bytes.
inline void gather_rows(const double* rows, const std::int32_t* number, Lanes& x, Lanes& y, Lanes& z, Lanes& w) {
  Lanes row[4];
  for (int l = 0; l < 4; ++l) row[l] = detail::row_of(rows, number[l]);
  const Lanes xz01 = __builtin_shufflevector(row[0], row[1], 0, 4, 2, 6);
  const Lanes xz23 = __builtin_shufflevector(row[2], row[3], 0, 4, 2, 6);
  const Lanes yw01 = __builtin_shufflevector(row[0], row[1], 1, 5, 3, 7);
  const Lanes yw23 = __builtin_shufflevector(row[2], row[3], 1, 5, 3, 7);
  x = __builtin_shufflevector(xz01, xz23, 0, 1, 4, 5);
  z = __builtin_shufflevector(xz01, xz23, 2, 3, 6, 7);
  y = __builtin_shufflevector(yw01, yw23, 0, 1, 4, 5);
  w = __builtin_shufflevector(yw01, yw23, 2, 3, 6, 7);
}

/// Adds three vectors to x, y, z of a piece's nodes, lane after lane, so that lanes may share a node.
inline void scatter_add(std::int64_t* nodal, const std::int32_t* node, LanesInt x, LanesInt y, LanesInt z) {
  const LanesInt zero{};
  const LanesInt xy_even = __builtin_shufflevector(x, y, 0, 4, 2, 6),
                 xy_odd = __builtin_shufflevector(x, y, 1, 5, 3, 7);
  const LanesInt z_even = __builtin_shufflevector(z, zero, 0, 4, 2, 6),
                 z_odd = __builtin_shufflevector(z, zero, 1, 5, 3, 7);
  detail::add_to_row(nodal, node[0], __builtin_shufflevector(xy_even, z_even, 0, 1, 4, 5));
  detail::add_to_row(nodal, node[1], __builtin_shufflevector(xy_odd, z_odd, 0, 1, 4, 5));
  detail::add_to_row(nodal, node[2], __builtin_shufflevector(xy_even, z_even, 2, 3, 6, 7));
  detail::add_to_row(nodal, node[3], __builtin_shufflevector(xy_odd, z_odd, 2, 3, 6, 7));
}

#else

/// Reads the four entries of as many rows as there are lanes into four vectors. Rows lie on boundaries of 32 bytes.
inline void gather_rows(const double* rows, const std::int32_t* number, Lanes& x, Lanes& y, Lanes& z, Lanes& w) {
  const double *a = rows + 4 * static_cast<std::int64_t>(number[0]),
               *b = rows + 4 * static_cast<std::int64_t>(number[1]);
  const Lanes xy_a = load_lanes(a), xy_b = load_lanes(b), zw_a = load_lanes(a + 2), zw_b = load_lanes(b + 2);
  x = __builtin_shufflevector(xy_a, xy_b, 0, 2);
  y = __builtin_shufflevector(xy_a, xy_b, 1, 3);
  z = __builtin_shufflevector(zw_a, zw_b, 0, 2);
  w = __builtin_shufflevector(zw_a, zw_b, 1, 3);
}

/// Adds three vectors to x, y, z of a piece's nodes, lane after lane, so that lanes may share a node.
inline void scatter_add(std::int64_t* nodal, const std::int32_t* node, LanesInt x, LanesInt y, LanesInt z) {
  for (int l = 0; l < register_lanes; ++l) {
    std::int64_t* target = nodal + 4 * static_cast<std::int64_t>(node[l]);
    store_lanes(target, load_lanes(target) + LanesInt{x[l], y[l]});
    target[2] += z[l];
  }
}

#endif

/// Reads x, y, z of a piece's nodes (four entries per node) into three vectors.
inline void gather_vector(const double* nodal, const std::int32_t* node, Lanes& x, Lanes& y, Lanes& z) {
  Lanes unused;
  gather_rows(nodal, node, x, y, z, unused);
}

}  // namespace kerf
