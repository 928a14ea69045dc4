// Explicit vectors for element kernels, as wide as the machine's registers, and the transposing gather and scatter.
//
// A block of `lane_width` elements is computed in pieces of `register_lanes` doubles or `single_lanes` floats: vectors
// that are wider than a register would live in memory. A kernel that is written for both takes its number as the
// template parameter `Real`, and finds the types in `LanesOf` and `LaneIntsOf`.
#pragma once

#include <cmath>
#include <concepts>
#include <cstdint>
#include <cstring>
#include <type_traits>

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
/// A whole block of floats, or as many as a register of 16 bytes holds.
inline constexpr int single_lanes = register_lanes == 2 ? 4 : 8;
static_assert(lane_width % single_lanes == 0 && lane_width <= 8, "blocks are made of whole pieces");

typedef double Lanes __attribute__((vector_size(sizeof(double) * register_lanes)));
typedef std::int64_t LanesInt __attribute__((vector_size(sizeof(std::int64_t) * register_lanes)));
typedef float SingleLanes __attribute__((vector_size(sizeof(float) * single_lanes)));
typedef std::int32_t SingleLanesInt __attribute__((vector_size(sizeof(std::int32_t) * single_lanes)));

template <class Real>
using LanesOf = std::conditional_t<std::is_same_v<Real, float>, SingleLanes, Lanes>;
template <class Real>
using LaneIntsOf = std::conditional_t<std::is_same_v<Real, float>, SingleLanesInt, LanesInt>;
template <class Real>
inline constexpr int lanes_of = std::is_same_v<Real, float> ? single_lanes : register_lanes;
template <class Real>
inline constexpr int pieces_of = lane_width / lanes_of<Real>;
inline constexpr int n_pieces = pieces_of<double>;

/// Calls `work(first lane)` for every piece of a block. One piece of code serves all of them, so that no lane's
/// arithmetic is contracted in another way than its neighbour's.
template <class Real = double, class Work>
[[gnu::always_inline]] inline void each_piece(const Work& work) {
#pragma GCC unroll 1
  for (int lane = 0; lane < lane_width; lane += lanes_of<Real>) work(lane);
}

inline Lanes lanes(double v) { return Lanes{} + v; }
template <std::same_as<float> Number>  // and no whole numbers
inline SingleLanes lanes(Number v) {
  return SingleLanes{} + v;
}
namespace detail {
template <class Vector, class Number>
inline Vector load_vector(const Number* p) {
  Vector v;
  std::memcpy(&v, __builtin_assume_aligned(p, sizeof v), sizeof v);
  return v;
}
template <class Vector, class Number>
inline void store_vector(Number* p, Vector v) {
  std::memcpy(__builtin_assume_aligned(p, sizeof v), &v, sizeof v);
}
}  // namespace detail
/// Pre, here and below: `p` lies on a boundary of the vector's size, or of 32 bytes where floats come from, or go to,
/// doubles. Pieces of rows that are declared alignas(64) do on every machine, and so do the arrays of ElementArrays.
inline Lanes load_lanes(const double* p) { return detail::load_vector<Lanes>(p); }
inline LanesInt load_lanes(const std::int64_t* p) { return detail::load_vector<LanesInt>(p); }
inline SingleLanes load_lanes(const float* p) { return detail::load_vector<SingleLanes>(p); }
inline SingleLanesInt load_lanes(const std::int32_t* p) { return detail::load_vector<SingleLanesInt>(p); }
inline void store_lanes(double* p, Lanes v) { detail::store_vector(p, v); }
inline void store_lanes(std::int64_t* p, LanesInt v) { detail::store_vector(p, v); }
inline void store_lanes(float* p, SingleLanes v) { detail::store_vector(p, v); }
inline void store_lanes(std::int32_t* p, SingleLanesInt v) { detail::store_vector(p, v); }

inline Lanes max_of(Lanes a, Lanes b) { return a > b ? a : b; }
inline Lanes min_of(Lanes a, Lanes b) { return a < b ? a : b; }
inline SingleLanes max_of(SingleLanes a, SingleLanes b) { return a > b ? a : b; }
inline SingleLanes min_of(SingleLanes a, SingleLanes b) { return a < b ? a : b; }
inline Lanes abs_of(Lanes a) {
  return reinterpret_cast<Lanes>(reinterpret_cast<LanesInt>(a) & std::int64_t{0x7fffffffffffffff});
}
inline SingleLanes abs_of(SingleLanes a) {
  return reinterpret_cast<SingleLanes>(reinterpret_cast<SingleLanesInt>(a) & std::int32_t{0x7fffffff});
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
inline unsigned mask_of_ints(LanesInt comparison) {
  return _mm512_movepi64_mask(reinterpret_cast<__m512i>(comparison));
}

#else

inline constexpr double small_shift = 0x1.8p52;  // added, it leaves whole numbers in the low bits
/// The same as round_to_int where |a| < small_limit.
inline LanesInt round_small_to_int(Lanes a) {
  return reinterpret_cast<LanesInt>(a + small_shift) - reinterpret_cast<LanesInt>(lanes(small_shift));
}

#ifdef __AVX2__

inline Lanes sqrt_of(Lanes a) { return reinterpret_cast<Lanes>(_mm256_sqrt_pd(reinterpret_cast<__m256d>(a))); }
inline unsigned mask_of_ints(LanesInt comparison) {
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
inline unsigned mask_of_ints(LanesInt comparison) {
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

#ifdef __AVX2__
inline SingleLanes sqrt_of(SingleLanes a) {
  return reinterpret_cast<SingleLanes>(_mm256_sqrt_ps(reinterpret_cast<__m256>(a)));
}
inline unsigned mask_of_ints(SingleLanesInt comparison) {
  return static_cast<unsigned>(_mm256_movemask_ps(reinterpret_cast<__m256>(comparison)));
}
#else
inline SingleLanes sqrt_of(SingleLanes a) {
  SingleLanes r;
  for (int l = 0; l < single_lanes; ++l) r[l] = std::sqrt(a[l]);
  return r;
}
inline unsigned mask_of_ints(SingleLanesInt comparison) {
  unsigned mask = 0;
  for (int l = 0; l < single_lanes; ++l) mask |= (comparison[l] != 0 ? 1u : 0u) << l;
  return mask;
}
#endif

/// Bit l is set where lane l of a comparison's result is true. Compilers disagree on the type of the result: it is a
/// vector of some integers of the size of the numbers compared.
template <class Comparison>
[[gnu::always_inline]] inline unsigned mask_of(Comparison comparison) {
  if constexpr (sizeof comparison[0] == sizeof(std::int64_t)) {
    static_assert(sizeof comparison == sizeof(LanesInt));
    return mask_of_ints(reinterpret_cast<LanesInt>(comparison));
  } else {
    static_assert(sizeof comparison == sizeof(SingleLanesInt));
    return mask_of_ints(reinterpret_cast<SingleLanesInt>(comparison));
  }
}

inline constexpr double small_limit = 0x1p51;  // of round_small_to_int
template <class Real>
inline constexpr unsigned all_lanes_of = (1u << (lanes_of<Real>)) - 1u;  // mask_of a comparison that holds everywhere
inline constexpr unsigned all_lanes = all_lanes_of<double>;

namespace detail {
typedef double Quad __attribute__((vector_size(32), may_alias));
typedef std::int64_t QuadInt __attribute__((vector_size(32), may_alias));
typedef double Pair __attribute__((vector_size(16), may_alias));

/// One node's four entries. Nodes lie on boundaries of 32 bytes.
[[gnu::always_inline]] inline const Quad& row_of(const double* nodal, std::int32_t node) {
  return *reinterpret_cast<const Quad*>(nodal + 4 * static_cast<std::int64_t>(node));
}
[[gnu::always_inline]] inline Quad& row_at(double* rows, std::int32_t number) {
  return *reinterpret_cast<Quad*>(rows + 4 * static_cast<std::int64_t>(number));
}
[[gnu::always_inline]] inline const Pair& half_of(const double* nodal, std::int32_t node, int half) {
  return *reinterpret_cast<const Pair*>(nodal + 4 * static_cast<std::int64_t>(node) + 2 * half);
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
/// Halves of rows are put side by side as they are read: to move halves of registers is slow on some machines.
inline void gather_rows(const double* rows, const std::int32_t* number, Lanes& x, Lanes& y, Lanes& z, Lanes& w) {
  const auto two = [&](int l, int half) {
    const detail::Pair low = detail::half_of(rows, number[l], half), high = detail::half_of(rows, number[l + 2], half);
    return __builtin_shufflevector(low, high, 0, 1, 2, 3);
  };
  const Lanes xy02 = two(0, 0), xy13 = two(1, 0), zw02 = two(0, 1), zw13 = two(1, 1);
  x = __builtin_shufflevector(xy02, xy13, 0, 4, 2, 6);
  y = __builtin_shufflevector(xy02, xy13, 1, 5, 3, 7);
  z = __builtin_shufflevector(zw02, zw13, 0, 4, 2, 6);
  w = __builtin_shufflevector(zw02, zw13, 1, 5, 3, 7);
}

/// Adds three vectors to x, y, z of a piece's nodes, lane after lane, so that lanes may share a node.
inline void scatter_add(std::int64_t* nodal, const std::int32_t* node, LanesInt x, LanesInt y, LanesInt z) {
  const LanesInt zero{};
  const LanesInt xy02 = __builtin_shufflevector(x, y, 0, 4, 2, 6), xy13 = __builtin_shufflevector(x, y, 1, 5, 3, 7);
  const LanesInt z02 = __builtin_shufflevector(z, zero, 0, 4, 2, 6), z13 = __builtin_shufflevector(z, zero, 1, 5, 3, 7);
  const auto low = [](LanesInt v) { return _mm256_castsi256_si128(reinterpret_cast<__m256i>(v)); };
  const auto high = [](LanesInt v) { return _mm256_extracti128_si256(reinterpret_cast<__m256i>(v), 1); };
  const auto add = [&](int l, __m128i xy, __m128i z0) {
    auto* row = reinterpret_cast<__m128i*>(nodal + 4 * static_cast<std::int64_t>(node[l]));
    _mm_store_si128(row, _mm_add_epi64(_mm_load_si128(row), xy));
    _mm_store_si128(row + 1, _mm_add_epi64(_mm_load_si128(row + 1), z0));
  };
  add(0, low(xy02), low(z02));
  add(1, low(xy13), low(z13));
  add(2, high(xy02), high(z02));
  add(3, high(xy13), high(z13));
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

// Between the two precisions. Floats go in groups of four, which are one row of doubles.
namespace detail {
typedef float Four __attribute__((vector_size(16)));

#ifdef __AVX2__
inline SingleLanes join(const Four* four) { return __builtin_shufflevector(four[0], four[1], 0, 1, 2, 3, 4, 5, 6, 7); }
inline Four group(SingleLanes v, int g) {
  return g == 0 ? __builtin_shufflevector(v, v, 0, 1, 2, 3) : __builtin_shufflevector(v, v, 4, 5, 6, 7);
}
#else
inline SingleLanes join(const Four* four) { return four[0]; }
inline Four group(SingleLanes v, int) { return v; }
#endif
inline constexpr int n_groups = single_lanes / 4;
}  // namespace detail

/// Lanes of either precision from a row of doubles; floats are rounded to nearest.
template <class Real>
[[gnu::always_inline]] inline LanesOf<Real> load_lanes_as(const double* p) {
  if constexpr (std::is_same_v<Real, double>) {
    return load_lanes(p);
  } else {
    detail::Four four[detail::n_groups];
    for (int g = 0; g < detail::n_groups; ++g) four[g] = __builtin_convertvector(detail::row_of(p, g), detail::Four);
    return detail::join(four);
  }
}
[[gnu::always_inline]] inline void store_lanes(double* p, SingleLanes v) {
  for (int g = 0; g < detail::n_groups; ++g)
    detail::row_at(p, g) = __builtin_convertvector(detail::group(v, g), detail::Quad);
}
/// Adds to a row of doubles, in double precision.
[[gnu::always_inline]] inline void add_lanes(double* p, Lanes v) { store_lanes(p, load_lanes(p) + v); }
[[gnu::always_inline]] inline void add_lanes(double* p, SingleLanes v) {
  for (int g = 0; g < detail::n_groups; ++g)
    detail::row_at(p, g) += __builtin_convertvector(detail::group(v, g), detail::Quad);
}

/// Vectors of doubles that hold the lanes of one vector of `Real`.
template <class Real>
inline constexpr int n_wide = lanes_of<Real> / register_lanes;
template <int part>
[[gnu::always_inline]] inline Lanes widened(Lanes v) {
  static_assert(part == 0);
  return v;
}
/// The lanes from part * register_lanes on, in double precision.
template <int part>
[[gnu::always_inline]] inline Lanes widened(SingleLanes v) {
#if defined(__AVX512F__) && defined(__AVX512DQ__)
  return __builtin_convertvector(v, Lanes);
#elif defined(__AVX2__)
  return __builtin_convertvector(detail::group(v, part), Lanes);
#else
  return Lanes{v[2 * part], v[2 * part + 1]};
#endif
}

/// The lanes of `n_wide<float>` vectors of doubles, rounded to nearest.
[[gnu::always_inline]] inline SingleLanes narrowed(const Lanes* v) {
#if defined(__AVX512F__) && defined(__AVX512DQ__)
  return __builtin_convertvector(v[0], SingleLanes);
#elif defined(__AVX2__)
  const detail::Four four[2] = {__builtin_convertvector(v[0], detail::Four),
                                __builtin_convertvector(v[1], detail::Four)};
  return detail::join(four);
#else
  return SingleLanes{static_cast<float>(v[0][0]), static_cast<float>(v[0][1]), static_cast<float>(v[1][0]),
                     static_cast<float>(v[1][1])};
#endif
}

}  // namespace kerf
