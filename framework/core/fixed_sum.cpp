// Collective helpers of the order-independent sums.
#include "core/fixed_sum.hpp"

#include <limits>

namespace kerf {

double largest_magnitude(MPI_Comm comm, const std::vector<double>& values) {
  double largest = 0.0;
  for (const double v : values) {
    const double size = std::fabs(v);
    if (!(size <= std::numeric_limits<double>::max())) {
      largest = std::numeric_limits<double>::infinity();
      break;
    }
    largest = size > largest ? size : largest;
  }
  MPI_Allreduce(MPI_IN_PLACE, &largest, 1, MPI_DOUBLE, MPI_MAX, comm);
  return std::isfinite(largest) ? largest : std::numeric_limits<double>::quiet_NaN();
}

double order_free_sum(MPI_Comm comm, const std::vector<double>& values) {
  const double bound = largest_magnitude(comm, values);
  if (std::isnan(bound)) return bound;
  FixedSum sum(bound);
  for (const double v : values) sum.add(v);
  sum.reduce(comm);
  return sum.total();
}

}  // namespace kerf
