// Sums whose result does not depend on the order of their terms.
//
// Each term is split into two whole multiples of fixed powers of two, which add up exactly in integers. The
// bound that fixes the powers must be the same on all ranks.
#pragma once

#include <mpi.h>

#include <cmath>
#include <cstdint>
#include <span>
#include <vector>

namespace kerf {

/// The smallest power of two that is not below `value`; 1 for zero.
inline double power_of_two_above(double value) {
  if (!(value > 0.0) || !std::isfinite(value)) return 1.0;
  int exponent = 0;
  const double mantissa = std::frexp(value, &exponent);
  return std::ldexp(1.0, mantissa == 0.5 ? exponent - 1 : exponent);
}

/// Order-free sums over all terms of all ranks, of several lists at once: exact but for terms below 2^-72 of the
/// largest one of the list, and of 2^-972. NaN where any term of a list is not finite, or above 2^1000. Collective.
std::vector<double> order_free_sums(MPI_Comm comm, const std::vector<std::span<const double>>& lists);

/// The same of one list. Collective.
double order_free_sum(MPI_Comm comm, std::span<const double> values);

}  // namespace kerf
