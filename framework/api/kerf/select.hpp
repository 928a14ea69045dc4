// Choices without branches, which loops over points are written with.
#pragma once

#include <bit>
#include <cfloat>
#include <concepts>
#include <cstdint>

// Results are promised to have the same bits on every machine, which these options give up.
#ifdef __FAST_MATH__
#error "Kerf and its plugins must be compiled without -ffast-math and -Ofast: they change the order of operations"
#endif
#if FLT_EVAL_METHOD != 0
#error "Kerf and its plugins need arithmetic that rounds every result to its type, as SSE2 has; x87 has not"
#endif

namespace kerf {

// By value on purpose: std::max and std::clamp take references, which stops GCC 12 from vectorising.
// Where one argument is NaN, max_of and min_of return the second.

/// c ? a : b without a branch, whatever the optimiser thinks of it: in long loop bodies GCC 12 turns conditional
/// expressions into control flow, and then does not vectorise the loop.
constexpr double select(bool c, double a, double b) {
  const auto mask = -static_cast<std::int64_t>(c);
  return std::bit_cast<double>((std::bit_cast<std::int64_t>(a) & mask) | (std::bit_cast<std::int64_t>(b) & ~mask));
}
// Of floats only where both are: whole numbers stay doubles.
template <std::same_as<float> Number>
constexpr Number select(bool c, Number a, Number b) {
  const auto mask = -static_cast<std::int32_t>(c);
  return std::bit_cast<float>((std::bit_cast<std::int32_t>(a) & mask) | (std::bit_cast<std::int32_t>(b) & ~mask));
}
constexpr double max_of(double a, double b) { return select(a > b, a, b); }
constexpr double min_of(double a, double b) { return select(a < b, a, b); }
template <std::same_as<float> Number>
constexpr Number max_of(Number a, Number b) {
  return select(a > b, a, b);
}
template <std::same_as<float> Number>
constexpr Number min_of(Number a, Number b) {
  return select(a < b, a, b);
}
constexpr double clamp_to(double value, double low, double high) { return min_of(max_of(value, low), high); }

}  // namespace kerf
