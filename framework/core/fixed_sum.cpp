// The order-independent sums, in loops without branches.
#include "core/fixed_sum.hpp"

#include <algorithm>
#include <bit>
#include <limits>

#include "core/waiting.hpp"

namespace kerf {

namespace {

using Wide = __int128;

/// The largest magnitude as the bits of a double: they are ordered like the numbers, and NaN comes last of all.
std::int64_t largest_bits(std::span<const double> values) {
  std::int64_t most = 0;
  for (const double v : values) {
    const std::int64_t bits = std::bit_cast<std::int64_t>(v) & std::numeric_limits<std::int64_t>::max();
    most = bits > most ? bits : most;
  }
  return most;
}

/// Units that terms no larger than a bound are split into.
struct Units {
  explicit Units(double bound) {
    const double top = std::max(power_of_two_above(bound), 0x1p-900);  // whose 2^-72 still has an inverse
    high = top * 0x1p-36;
    low = top * 0x1p-72;
  }
  double high, low;
};

/// Sum of all terms in low units.
Wide exact_sum(std::span<const double> values, const Units& units) {
  constexpr std::size_t chunk = 1 << 20;  // of which the parts, below 2^37 in magnitude, cannot overflow 64 bits
  constexpr Wide low_per_high = static_cast<Wide>(1) << 36;
  const double per_high = 1.0 / units.high, per_low = 1.0 / units.low;
  Wide sum = 0;
  for (std::size_t from = 0; from < values.size(); from += chunk) {
    const std::size_t to = std::min(values.size(), from + chunk);
    std::int64_t high_sum = 0, low_sum = 0;
    for (std::size_t i = from; i < to; ++i) {
      const double whole = std::rint(values[i] * per_high);
      high_sum += static_cast<std::int64_t>(whole);
      low_sum += static_cast<std::int64_t>(std::rint(std::fma(-whole, units.high, values[i]) * per_low));
    }
    sum += static_cast<Wide>(high_sum) * low_per_high + low_sum;
  }
  return sum;
}

/// Numbers of 48 bits that make up a wide one, of which ranks can add up their own.
constexpr Wide limb = static_cast<Wide>(1) << 48;

void split(Wide sum, std::int64_t* limbs) {
  for (int k = 0; k < 3; ++k) {
    limbs[k] = static_cast<std::int64_t>(((sum % limb) + limb) % limb);
    sum = (sum - limbs[k]) / limb;
  }
  limbs[2] += static_cast<std::int64_t>(sum) << 48;
}

Wide join(const std::int64_t* limbs) { return (static_cast<Wide>(limbs[2]) * limb + limbs[1]) * limb + limbs[0]; }

/// Whether sums of terms of a size can be formed; NaN and infinity are larger than any number.
bool summable(std::int64_t largest) { return std::bit_cast<double>(largest) <= 0x1p1000; }

}  // namespace

std::vector<double> order_free_sums(MPI_Comm comm, const std::vector<std::span<const double>>& lists) {
  const auto n = static_cast<int>(lists.size());
  std::vector<std::int64_t> largest;
  for (const auto& list : lists) largest.push_back(largest_bits(list));
  const Waiting waiting;
  MPI_Allreduce(MPI_IN_PLACE, largest.data(), n, MPI_INT64_T, MPI_MAX, comm);
  std::vector<Units> units;
  std::vector<std::int64_t> limbs(3 * lists.size(), 0);
  for (std::size_t k = 0; k < lists.size(); ++k) {
    units.emplace_back(std::bit_cast<double>(largest[k]));
    if (summable(largest[k])) split(exact_sum(lists[k], units[k]), &limbs[3 * k]);
  }
  MPI_Allreduce(MPI_IN_PLACE, limbs.data(), 3 * n, MPI_INT64_T, MPI_SUM, comm);
  std::vector<double> sums;
  for (std::size_t k = 0; k < lists.size(); ++k) {
    const bool finite = summable(largest[k]);
    const auto exact = static_cast<long double>(join(&limbs[3 * k]));
    sums.push_back(finite ? static_cast<double>(exact * static_cast<long double>(units[k].low))
                          : std::numeric_limits<double>::quiet_NaN());
  }
  return sums;
}

double order_free_sum(MPI_Comm comm, std::span<const double> values) { return order_free_sums(comm, {values}).front(); }

}  // namespace kerf
