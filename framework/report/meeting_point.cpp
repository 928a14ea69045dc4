// The agreement of ranks on where they are in a plugin.
#include "report/meeting_point.hpp"

#include <fmt/format.h>

#include <cmath>
#include <limits>
#include <utility>

#include "core/fixed_sum.hpp"
#include "parallel/communicator.hpp"

namespace kerf {

namespace {

const char* name_of(MeetingPoint::Place place) {
  constexpr const char* names[] = {"an exception", "its end",     "sums",          "greatest",        "least",
                                   "nearest",      "from_holder", "reactions",     "contacts",        "mass_in",
                                   "least_by_key", "sums_by_key", "bytes_on_root", "visit_undeformed"};
  return names[place];
}

}  // namespace

void MeetingPoint::come_to(Place place) const {
  int range[2] = {place, -place};
  MPI_Allreduce(MPI_IN_PLACE, range, 2, MPI_INT, MPI_MIN, comm_);
  if (range[0] == failed) throw LeftBehind();
  if (range[0] == -range[1]) return;
  parted_ = true;
  throw std::runtime_error(fmt::format(
      "some ranks have come to {} and others to {}; collective functions have to be called by all ranks alike",
      name_of(static_cast<Place>(range[0])), name_of(static_cast<Place>(-range[1]))));
}

/// Tells ranks that are in the plugin still, unless all have left it.
void MeetingPoint::leave() const {
  if (std::exchange(parted_, false)) return;
  int range[2] = {failed, 0};
  MPI_Allreduce(MPI_IN_PLACE, range, 2, MPI_INT, MPI_MIN, comm_);
}

std::vector<double> MeetingPoint::add_up(const std::vector<std::span<const double>>& lists) const {
  come_to(sums);
  return order_free_sums(comm_, lists);
}

std::vector<double> MeetingPoint::greatest_of(std::vector<double> values) const {
  come_to(greatest);
  for (double& v : values)
    if (std::isnan(v)) v = -std::numeric_limits<double>::infinity();
  MPI_Allreduce(MPI_IN_PLACE, values.data(), static_cast<int>(values.size()), MPI_DOUBLE, MPI_MAX, comm_);
  return values;
}

std::vector<double> MeetingPoint::least_of(std::vector<double> values) const {
  come_to(least);
  for (double& v : values)
    if (std::isnan(v)) v = std::numeric_limits<double>::infinity();
  MPI_Allreduce(MPI_IN_PLACE, values.data(), static_cast<int>(values.size()), MPI_DOUBLE, MPI_MIN, comm_);
  return values;
}

std::string MeetingPoint::common(const std::string& failure) const { return first_text(comm_, failure); }

}  // namespace kerf
