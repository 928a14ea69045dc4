// Arithmetic that takes numbers too small for a full mantissa as zero.
#pragma once

#ifdef __SSE2__
#include <immintrin.h>
#endif

namespace kerf {

/// While it lives, floats below 1.2e-38, and doubles below 2.2e-308, count as zero on this thread. Ahead of every wave
/// lie floats of all sizes, and those would slow the arithmetic down by an order of magnitude. Processors other than
/// x86 compute with them as ever.
class FlushDenormals {
 public:
#ifdef __SSE2__
  FlushDenormals() : before_(_mm_getcsr()) { _mm_setcsr(before_ | 0x8040u); }
  ~FlushDenormals() { _mm_setcsr(before_); }

 private:
  unsigned before_;
#else
  FlushDenormals() {}
#endif
  FlushDenormals(const FlushDenormals&) = delete;
  FlushDenormals& operator=(const FlushDenormals&) = delete;
};

}  // namespace kerf
