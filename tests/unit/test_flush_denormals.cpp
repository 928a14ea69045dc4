// Numbers too small for a full mantissa are zero while FlushDenormals lives, and are themselves before and after.
#include "core/flush_denormals.hpp"

#include <gtest/gtest.h>

#include <bit>
#include <cstdint>
#include <limits>

namespace {

using namespace kerf;

#ifdef __SSE2__
/// Whether results, and operands, too small for a full mantissa are zero. By their bits: a comparison would flush, too.
template <class Number, class Bits>
void expect_flushed(bool flushed) {
  volatile Number least = std::numeric_limits<Number>::min(), half = 0.5, large = 4.0;
  volatile Number denormal = std::bit_cast<Number>(Bits{1} << 20);
  const volatile Number result = least * half, grown = denormal * large;
  EXPECT_EQ(std::bit_cast<Bits>(static_cast<Number>(result)) == 0, flushed);
  EXPECT_EQ(std::bit_cast<Bits>(static_cast<Number>(grown)) == 0, flushed);
}

TEST(FlushDenormals, acts_on_results_and_operands_while_it_lives) {
  expect_flushed<float, std::uint32_t>(false);
  expect_flushed<double, std::uint64_t>(false);
  {
    const FlushDenormals while_it_lives;
    expect_flushed<float, std::uint32_t>(true);
    expect_flushed<double, std::uint64_t>(true);
  }
  expect_flushed<float, std::uint32_t>(false);
  expect_flushed<double, std::uint64_t>(false);
}
#endif

}  // namespace
