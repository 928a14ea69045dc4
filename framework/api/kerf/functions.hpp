// Elementary functions that give the same bits on every machine, with every compiler and in every lane: exp, expm1,
// log, log10, pow, sin, cos, tan, asin, acos, atan, atan2, tanh, hypot.
//
// The functions of the C library differ in the last bit between its releases, between processors with and without
// fused multiply-add, and between its scalar and its vector versions. Whatever enters the state of a model is computed
// with the functions below instead. They consist of additions, multiplications, divisions and square roots, which
// IEEE 754 defines to the last bit, of conditional moves, and of integer operations on the bits of numbers. So loops
// over points that call them vectorise. Kerf's compile options forbid the compiler to fuse or reorder operations.
//
// Methods: argument reduction by constants in two or three parts (Cody & Waite 1980), minimax polynomials (found with
// Sollya), double-double arithmetic (Dekker 1971) where one double is not enough. The largest errors, in units in the
// last place, stand beside each function; tests/point/test_functions.cpp measures them against long double.
// Errors are those of normal results. NaN, infinities and zeros are treated as in the C library.
#pragma once

#include <bit>
#include <cmath>
#include <concepts>
#include <cstdint>
#include <limits>

#include "kerf/select.hpp"

namespace kerf {

namespace detail {

using Bits = std::uint64_t;
inline constexpr double infinity = std::numeric_limits<double>::infinity();
inline constexpr double not_a_number = std::numeric_limits<double>::quiet_NaN();
/// Added to a number of magnitude below 2^51, it leaves the nearest integer in the low bits.
inline constexpr double integer_shift = 0x1.8p52;

constexpr Bits bits_of(double x) { return std::bit_cast<Bits>(x); }
constexpr double from_bits(Bits b) { return std::bit_cast<double>(b); }
constexpr double with_sign_of(double magnitude, double sign) {
  constexpr Bits sign_bit = Bits{1} << 63;
  return from_bits((bits_of(magnitude) & ~sign_bit) | (bits_of(sign) & sign_bit));
}

/// Polynomial with the constant coefficient first. Pairs of terms are evaluated side by side: the chain of operations
/// that wait for each other is half as long as in Horner's scheme.
template <std::floating_point Real, int n>
[[gnu::always_inline]] constexpr Real polynomial(const Real (&c)[n], Real x) {
  const Real xx = x * x;
  Real sum = n % 2 == 1 ? c[n - 1] : c[n - 2] + c[n - 1] * x;
#pragma GCC unroll 8
  for (int i = n - 3 - (n + 1) % 2; i >= 0; i -= 2) sum = sum * xx + (c[i] + c[i + 1] * x);
  return sum;
}

/// An unevaluated sum; |low| is at most half a unit in the last place of `high`.
struct TwoPart {
  double high, low;
};
/// a + b exactly. Pre: |a| >= |b|, or a = 0.
constexpr TwoPart exact_sum_of_ordered(double a, double b) {
  const double sum = a + b;
  return {sum, b - (sum - a)};
}
constexpr TwoPart exact_sum(double a, double b) {
  const double sum = a + b, from_b = sum - a;
  return {sum, (a - (sum - from_b)) + (b - from_b)};
}
/// a * b exactly, without fused multiply-add. Pre: magnitudes below 2^970, and no underflow.
constexpr TwoPart exact_product(double a, double b) {
  constexpr double splitter = 0x1p27 + 1.0;
  const double sa = splitter * a, sb = splitter * b;
  const double a1 = sa - (sa - a), a2 = a - a1, b1 = sb - (sb - b), b2 = b - b1;
  const double product = a * b;
  return {product, ((a1 * b1 - product) + a1 * b2 + a2 * b1) + a2 * b2};
}

/// e^x = (1 + tail) * 2^n.
struct ExpParts {
  double tail, n;
  Bits n_bits;  // of n + integer_shift
};
/// Parts of e^(x + low), or of e^x without `has_low`. Pre: |x| < 2^10, |low| at most a unit in the last place of x.
template <bool has_low>
[[gnu::always_inline]] constexpr ExpParts exp_parts(double x, double low = 0.0) {
  constexpr double c[] = {0x1.5555555555556p-3,  0x1.5555555555556p-5,  0x1.111111111070ap-7,  0x1.6c16c16c15f3ep-10,
                          0x1.a01a01a9031c8p-13, 0x1.a01a01a8a0aa8p-16, 0x1.71de0a39316c7p-19, 0x1.27e4d64a59394p-22,
                          0x1.af3f0f353b53cp-26, 0x1.1f7ca2d6ebd55p-29};
  constexpr double ln2_high = 0x1.62e42fefa2p-1, ln2_low = 0x1.9ef35793c7673p-41;
  const double shifted = x * 0x1.71547652b82fep0 + integer_shift, n = shifted - integer_shift;
  TwoPart left = {x - n * ln2_high, 0.0};  // exact
  if constexpr (has_low) left = exact_sum(left.high, low);
  const double rest = n * ln2_low, r = left.high - rest, rr = r * r;
  double lost = (left.high - r) - rest;
  if constexpr (has_low) lost += left.low;
  return {r + (lost + (0.5 * rr + r * rr * polynomial(c, r))), n, bits_of(shifted)};
}
/// value * 2^n, rounded once. Pre: |n| < 2040.
constexpr double scaled(double value, Bits n_bits) {
  const Bits biased = n_bits - bits_of(integer_shift) + 2 * 1023, half = biased >> 1;
  return value * from_bits(half << 52) * from_bits((biased - half) << 52);
}
/// Pre of exp_parts on -746 to 710; beyond, e^x is 0 or infinity.
constexpr double kept_for_exp(double x) { return max_of(-746.0, min_of(710.0, x)); }  // NaN remains
/// e^(x + low).
[[gnu::always_inline]] constexpr double exp_of_sum(double x, double low) {
  const double kept = kept_for_exp(x);
  const ExpParts e = exp_parts<true>(kept, select(kept == x, low, 0.0));
  return scaled(1.0 + e.tail, e.n_bits);
}

/// x = 2^k (1 + f), with 1 + f between the square roots of 1/2 and of 2. Pre: x is positive and finite.
struct LogParts {
  double k, f;
};
[[gnu::always_inline]] constexpr LogParts log_parts(double x) {
  const bool subnormal = x < 0x1p-1022;
  const double normal = select(subnormal, x * 0x1p54, x);
  constexpr Bits root_of_half = 0x3fe6a09e667f3bcd, mantissa = (Bits{1} << 52) - 1;
  const Bits b = bits_of(normal) - root_of_half + (Bits{1023} << 52);
  const double biased_k = from_bits((b >> 52) | bits_of(0x1p52));
  return {biased_k - select(subnormal, 0x1p52 + 1023.0 + 54.0, 0x1p52 + 1023.0),
          from_bits((b & mantissa) + root_of_half) - 1.0};
}
/// What log gives for all x but positive finite ones, and `result` for those.
constexpr double log_result(double x, double result) {
  return select(x > 0.0, select(x < infinity, result, x), select(x == 0.0, -infinity, not_a_number));
}

}  // namespace detail

/// 0.9 units in the last place.
[[gnu::always_inline]] constexpr double exp(double x) {
  const detail::ExpParts e = detail::exp_parts<false>(detail::kept_for_exp(x));
  return detail::scaled(1.0 + e.tail, e.n_bits);
}

/// e^x - 1. 1.5 units in the last place.
[[gnu::always_inline]] constexpr double expm1(double x) {
  const detail::ExpParts e = detail::exp_parts<false>(max_of(-60.0, min_of(700.0, x)));
  const double power = detail::scaled(1.0, e.n_bits);
  return select(x > 700.0, exp(x), select(x == 0.0, x, power * e.tail + (power - 1.0)));
}

/// 0.9 units in the last place.
[[gnu::always_inline]] constexpr double log(double x) {
  constexpr double c[] = {0x1.5555555555558p-1, 0x1.9999999995239p-2, 0x1.2492492e0c875p-2, 0x1.c71c62bf42ed4p-3,
                          0x1.7462bfebe8471p-3, 0x1.39fce62a80fc1p-3, 0x1.2b6a94c8ac989p-3};
  constexpr double ln2_high = 0x1.62e42fefa2p-1, ln2_low = 0x1.9ef35793c7673p-41;
  const auto [k, f] = detail::log_parts(x);
  // log(1 + f) = f - f^2/2 + s (f^2/2 + z P(z)) with s = f / (2 + f), z = s^2.
  const double s = f / (2.0 + f), z = s * s, half = 0.5 * f * f;
  const double result = k * ln2_high - ((half - (s * (half + z * detail::polynomial(c, z)) + k * ln2_low)) - f);
  return detail::log_result(x, result);
}

/// 2 units in the last place.
[[gnu::always_inline]] constexpr double log10(double x) { return log(x) * 0x1.bcb7b1526e50ep-2; }

namespace detail {

/// log x to about 2^-65 of itself. Pre: x is positive and finite.
[[gnu::always_inline]] constexpr TwoPart log_two_part(double x) {
  constexpr double c[] = {0x1.999999999999fp-2, 0x1.249249248e254p-2, 0x1.c71c71d86515ap-3, 0x1.745d09abe912dp-3,
                          0x1.3b18ca7d650f8p-3, 0x1.101692e796e1p-3,  0x1.0891014a9847cp-3};
  constexpr double ln2_high = 0x1.62e42fefa2p-1, ln2_low = 0x1.9ef35793c7673p-41;
  constexpr TwoPart two_thirds = {0x1.5555555555555p-1, 0x1.5555555555555p-55};
  const auto [k, f] = log_parts(x);
  // log(1 + f) = 2 s + s z (2/3 + z P(z)) with s = f / (2 + f), z = s^2.
  const TwoPart d = exact_sum_of_ordered(2.0, f);
  const double inverse = 1.0 / d.high, s = f * inverse;
  const TwoPart back = exact_product(s, d.high);
  const double s_low = (((f - back.high) - back.low) - s * d.low) * inverse;
  const TwoPart z = exact_product(s, s);
  const double z_low = z.low + 2.0 * s * s_low;
  const TwoPart w = exact_sum_of_ordered(two_thirds.high, z.high * polynomial(c, z.high));
  const double w_low = w.low + two_thirds.low;
  const TwoPart sz = exact_product(s, z.high);
  const double sz_low = sz.low + (s * z_low + s_low * z.high);
  const TwoPart szw = exact_product(sz.high, w.high);
  const double szw_low = szw.low + (sz.high * w_low + sz_low * w.high);
  const TwoPart sum = exact_sum_of_ordered(k * ln2_high, 2.0 * s);
  const TwoPart all = exact_sum_of_ordered(sum.high, szw.high);
  return exact_sum_of_ordered(all.high, all.low + (sum.low + (k * ln2_low + 2.0 * s_low + szw_low)));
}

}  // namespace detail

/// x^y. 1.5 units in the last place. Costs about as much as three of exp(y * log(x)), whose error is |y log x| times as
/// large.
[[gnu::always_inline]] constexpr double pow(double x, double y) {
  using namespace detail;
  const double size = with_sign_of(x, 1.0), y_size = with_sign_of(y, 1.0), half_y = 0.5 * y_size;
  // Larger exponents give the same zeros and infinities, but overflow on the way; so would the log of 0 or infinity.
  const double y_kept = max_of(-0x1p900, min_of(0x1p900, y));
  const TwoPart l = log_two_part(select((size > 0.0) & (size < infinity), size, 2.0));
  const TwoPart p = exact_product(l.high, y_kept);
  double result = exp_of_sum(p.high, p.low + l.low * y_kept);
  result = select(size == 0.0, select(y < 0.0, infinity, 0.0), result);
  result = select(size == infinity, select(y < 0.0, 0.0, infinity), result);
  const bool whole = (y_size >= 0x1p52) | ((y_size + 0x1p52) - 0x1p52 == y_size);
  const bool odd = (y_size < 0x1p53) & whole & ((half_y + 0x1p52) - 0x1p52 != half_y);
  const bool negative = with_sign_of(1.0, x) < 0.0;
  result = select(negative & odd, -result, result);
  result = select((x < 0.0) & (x > -infinity) & !whole, not_a_number, result);
  result = select((x == x) & (y == y), result, not_a_number);
  return select((y == 0.0) | (x == 1.0), 1.0, result);
}

namespace detail {

/// x = quarter turns + (r + low), |r| <= pi/4. Pre: |x| <= 2^20.
struct Turned {
  double r, low;
  Bits quarters;  // modulo 2^51
};
[[gnu::always_inline]] constexpr Turned turned(double x) {
  constexpr double quarter[] = {0x1.921fb544p0, 0x1.0b4611a6p-34, 0x1.3198a2ep-69, 0x1.b839a252049c1p-104};
  const double shifted = x * 0x1.45f306dc9c883p-1 + integer_shift, n = shifted - integer_shift;
  // The first three products are exact, and so is the first difference.
  const TwoPart first = exact_sum(x - n * quarter[0], -(n * quarter[1]));
  const TwoPart second = exact_sum(first.high, -(n * quarter[2]));
  const TwoPart r = exact_sum_of_ordered(second.high, first.low + second.low - n * quarter[3]);
  return {r.high, r.low, bits_of(shifted)};
}
[[gnu::always_inline]] constexpr double sin_of_turned(const Turned& t) {
  constexpr double c[] = {-0x1.5555555555555p-3, 0x1.1111111110c7ap-7,   -0x1.a01a019e9eaf2p-13,
                          0x1.71de37ae58898p-19, -0x1.ae601d5079abfp-26, 0x1.5e1033fed3b73p-33};
  const double z = t.r * t.r;
  return t.r + (t.low * (1.0 - 0.5 * z) + t.r * z * polynomial(c, z));
}
[[gnu::always_inline]] constexpr double cos_of_turned(const Turned& t) {
  constexpr double c[] = {0x1.5555555555555p-5,   -0x1.6c16c16c168c8p-10, 0x1.a01a019f37922p-16,
                          -0x1.27e4fa01e48dfp-22, 0x1.1eeb56ab2f1a1p-29,  -0x1.90729f53673fdp-37};
  const double z = t.r * t.r, half = 0.5 * z, one = 1.0 - half;
  return one + (((1.0 - one) - half) + (z * z * polynomial(c, z) - t.r * t.low));
}
/// The sine, or after another quarter turn the cosine, of x.
[[gnu::always_inline]] constexpr double sin_after(double x, Bits quarters) {
  const Turned t = turned(x);
  const Bits q = t.quarters + quarters, is_cos = Bits{0} - (q & 1);
  const Bits value = (bits_of(cos_of_turned(t)) & is_cos) | (bits_of(sin_of_turned(t)) & ~is_cos);
  return select((x <= 0x1p20) & (x >= -0x1p20), from_bits(value ^ ((q & 2) << 62)), not_a_number);
}

}  // namespace detail

/// 0.9 units in the last place. NaN where |x| > 2^20.
[[gnu::always_inline]] constexpr double sin(double x) { return select(x == 0.0, x, detail::sin_after(x, 0)); }
/// 0.9 units in the last place. NaN where |x| > 2^20.
[[gnu::always_inline]] constexpr double cos(double x) { return detail::sin_after(x, 1); }
/// 2.5 units in the last place. NaN where |x| > 2^20.
[[gnu::always_inline]] constexpr double tan(double x) { return sin(x) / cos(x); }

namespace detail {

/// `quarters` times pi/4, plus `more`. Pre: `quarters` is one of 0 to 4.
constexpr double quarters_of_pi(double quarters, double more) {
  return quarters * 0x1.921fb54442d1p-1 + (quarters * 0x1.08d313198a2ep-50 + more);
}

/// asin(|x|) = p, or pi/2 - 2 p where |x| > 1/2.
struct AsinParts {
  double p;
  bool large;
};
[[gnu::always_inline]] inline AsinParts asin_parts(double size) {
  constexpr double c[] = {0x1.5555555555556p-3, 0x1.3333333332da2p-4, 0x1.6db6db6e48603p-5, 0x1.f1c71c11deeap-6,
                          0x1.6e8bb37521acap-6, 0x1.1c4d112ced71bp-6, 0x1.c9d30ac3ce817p-7, 0x1.78010220106fp-7,
                          0x1.532a91490f8afp-7, 0x1.5e2915df0d638p-8, 0x1.220541f4ab3acp-6, -0x1.f58c57c572f98p-7,
                          0x1.dc181d65cb50ap-6};
  const bool large = size > 0.5;
  const double z = select(large, 0.5 - 0.5 * size, size * size);
  const double root = std::sqrt(z), s = select(large, root, size);
  return {s + s * z * polynomial(c, z), large};
}

}  // namespace detail

/// 2.3 units in the last place.
[[gnu::always_inline]] inline double asin(double x) {
  const auto [p, large] = detail::asin_parts(detail::with_sign_of(x, 1.0));
  return detail::with_sign_of(select(large, detail::quarters_of_pi(2.0, -2.0 * p), p), x);
}
/// 1.3 units in the last place.
[[gnu::always_inline]] inline double acos(double x) {
  const auto [p, large] = detail::asin_parts(detail::with_sign_of(x, 1.0));
  const double signed_p = detail::with_sign_of(p, x);
  return select(large, select(x < 0.0, detail::quarters_of_pi(4.0, -2.0 * p), 2.0 * p),
                detail::quarters_of_pi(2.0, -signed_p));
}

/// The angle of (x, y) to the x axis, from -pi to pi. 2.3 units in the last place.
[[gnu::always_inline]] constexpr double atan2(double y, double x) {
  using namespace detail;
  constexpr double c[] = {-0x1.5555555555555p-2, 0x1.9999999999452p-3, -0x1.249249243faa8p-3, 0x1.c71c718a1a80ep-4,
                          -0x1.745d0bd21e6eap-4, 0x1.3b12709f90fc9p-4, -0x1.10fb24631800bp-4, 0x1.dff0fee7a3496p-5,
                          -0x1.a0cd519ea4971p-5, 0x1.41eda3f7b1ecbp-5, -0x1.3b6fea66c5688p-6};
  const double a = with_sign_of(y, 1.0), b = with_sign_of(x, 1.0);
  const bool steep = a > b, backward = with_sign_of(1.0, x) < 0.0;
  // Sums of the two must not overflow, and infinities stand for directions.
  const double larger = select(steep, a, b), scale = select(larger > 0x1p1000, 0x1p-100, 1.0);
  const bool infinite = larger == infinity;
  const double high = select(infinite, 1.0, larger * scale);
  const double other = select(steep, b, a), low = select(infinite, select(other == infinity, 1.0, 0.0), other * scale);
  const bool wide = low > 0x1.a827999fcef32p-2 * high;  // tan(pi/8)
  const double r = select(wide, low - high, low) / select(high == 0.0, 1.0, select(wide, low + high, high));
  const double z = r * r, arc = r + r * z * polynomial(c, z);
  double quarters = select(wide, 1.0, 0.0);
  quarters = select(steep, 2.0 - quarters, quarters);
  quarters = select(backward, 4.0 - quarters, quarters);
  const double angle = quarters_of_pi(quarters, select(steep != backward, -arc, arc));
  return select((x == x) & (y == y), with_sign_of(angle, y), not_a_number);
}
/// 2.3 units in the last place.
[[gnu::always_inline]] constexpr double atan(double x) { return atan2(x, 1.0); }

/// 3 units in the last place.
[[gnu::always_inline]] constexpr double tanh(double x) {
  const double e = expm1(2.0 * min_of(22.0, detail::with_sign_of(x, 1.0)));
  return detail::with_sign_of(e / (e + 2.0), x);
}

/// sqrt(x^2 + y^2) without overflow or underflow on the way. 1.2 units in the last place.
[[gnu::always_inline]] inline double hypot(double x, double y) {
  const double a = detail::with_sign_of(x, 1.0), b = detail::with_sign_of(y, 1.0), larger = select(b > a, b, a);
  const double scale = select(larger > 0x1p500, 0x1p-600, select(larger < 0x1p-450, 0x1p600, 1.0));
  const double back = select(larger > 0x1p500, 0x1p600, select(larger < 0x1p-450, 0x1p-600, 1.0));
  const double root = std::sqrt((a * scale) * (a * scale) + (b * scale) * (b * scale)) * back;
  return select((a == detail::infinity) | (b == detail::infinity), detail::infinity, root);
}

// Of floats only where all arguments are: whole numbers become doubles. Computed as doubles and rounded, they err by
// 0.5001 units in the last place of a float; a loop of floats that calls them runs at the pace of doubles.
#define KERF_FUNCTION_OF_FLOAT(name)                                \
  template <std::same_as<float> Number>                             \
  [[gnu::always_inline]] inline Number name(Number x) {             \
    return static_cast<Number>(kerf::name(static_cast<double>(x))); \
  }
#define KERF_FUNCTION_OF_FLOATS(name)                                                       \
  template <std::same_as<float> Number>                                                     \
  [[gnu::always_inline]] inline Number name(Number x, Number y) {                           \
    return static_cast<Number>(kerf::name(static_cast<double>(x), static_cast<double>(y))); \
  }
KERF_FUNCTION_OF_FLOAT(exp)
KERF_FUNCTION_OF_FLOAT(expm1)
KERF_FUNCTION_OF_FLOAT(log)
KERF_FUNCTION_OF_FLOAT(log10)
KERF_FUNCTION_OF_FLOAT(sin)
KERF_FUNCTION_OF_FLOAT(cos)
KERF_FUNCTION_OF_FLOAT(tan)
KERF_FUNCTION_OF_FLOAT(asin)
KERF_FUNCTION_OF_FLOAT(acos)
KERF_FUNCTION_OF_FLOAT(atan)
KERF_FUNCTION_OF_FLOAT(tanh)
KERF_FUNCTION_OF_FLOATS(pow)
KERF_FUNCTION_OF_FLOATS(atan2)
KERF_FUNCTION_OF_FLOATS(hypot)
#undef KERF_FUNCTION_OF_FLOAT
#undef KERF_FUNCTION_OF_FLOATS

}  // namespace kerf
