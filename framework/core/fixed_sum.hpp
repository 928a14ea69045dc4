// Sums whose result does not depend on the order of their terms.
//
// Each term is split into two whole multiples of fixed powers of two, which add up exactly in integers. The
// bound that fixes the powers must be the same on all ranks.
#pragma once

#include <mpi.h>

#include <cmath>
#include <cstdint>
#include <vector>

namespace kerf {

/// The smallest power of two that is not below `value`; 1 for zero.
inline double power_of_two_above(double value) {
  if (!(value > 0.0) || !std::isfinite(value)) return 1.0;
  int exponent = 0;
  const double mantissa = std::frexp(value, &exponent);
  return std::ldexp(1.0, mantissa == 0.5 ? exponent - 1 : exponent);
}

/// An exact sum of terms no larger in magnitude than `bound`, resolved to bound * 2^-72.
class FixedSum {
 public:
  explicit FixedSum(double bound) {
    const double top = power_of_two_above(bound);
    high_ = top * 0x1p-36;
    low_ = top * 0x1p-72;
    per_high_ = 1.0 / high_;
    per_low_ = 1.0 / low_;
  }
  void add(double value) {
    const double whole = std::rint(value * per_high_);
    high_sum_ += static_cast<std::int64_t>(whole);
    low_sum_ += static_cast<std::int64_t>(std::rint(std::fma(-whole, high_, value) * per_low_));
  }
  /// Adds up all ranks' terms. Collective.
  void reduce(MPI_Comm comm) {
    constexpr __int128 limb = static_cast<__int128>(1) << 48;
    __int128 total = static_cast<__int128>(high_sum_) * (static_cast<__int128>(1) << 36) + low_sum_;
    std::int64_t limbs[3];
    for (auto& part : limbs) {
      part = static_cast<std::int64_t>(((total % limb) + limb) % limb);
      total = (total - part) / limb;
    }
    limbs[2] += static_cast<std::int64_t>(total) << 48;
    MPI_Allreduce(MPI_IN_PLACE, limbs, 3, MPI_INT64_T, MPI_SUM, comm);
    __int128 sum = limbs[2];
    sum = sum * limb + limbs[1];
    sum = sum * limb + limbs[0];
    total_ = static_cast<double>(static_cast<long double>(sum) * static_cast<long double>(low_));
  }
  double total() const { return total_; }

 private:
  double high_, low_, per_high_, per_low_, total_ = 0.0;
  std::int64_t high_sum_ = 0;
  __int128 low_sum_ = 0;
};

/// Largest magnitude over all ranks; NaN where any term is not finite. Collective.
double largest_magnitude(MPI_Comm comm, const std::vector<double>& values);

/// Order-free sum over all terms of all ranks. Collective.
double order_free_sum(MPI_Comm comm, const std::vector<double>& values);

}  // namespace kerf
