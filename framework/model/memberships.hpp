// The parts and sets that nodes belong to: a table of the combinations that occur, of which a node keeps the number.
#pragma once

#include <mpi.h>

#include <compare>
#include <cstdint>
#include <vector>

namespace kerf {

/// What one node belongs to: places in the lists of parts and of sets of the input, in ascending order.
struct Membership {
  std::vector<std::int32_t> parts, sets;
  auto operator<=>(const Membership&) const = default;
};

/// The union of two combinations.
Membership joined(const Membership& a, const Membership& b);

/// All combinations of the model, in ascending order, the same on all ranks.
class Memberships {
 public:
  Memberships() = default;
  /// The combinations that any rank has. Collective.
  Memberships(MPI_Comm comm, const std::vector<Membership>& here);

  std::int32_t size() const { return static_cast<std::int32_t>(all_.size()); }
  const Membership& operator[](std::int32_t number) const { return all_[static_cast<std::size_t>(number)]; }
  const std::vector<Membership>& all() const { return all_; }
  /// Pre: the combination is one of the table.
  std::int32_t number_of(const Membership& membership) const;
  bool is_shared(std::int32_t number) const { return (*this)[number].parts.size() > 1; }

 private:
  std::vector<Membership> all_;
};

}  // namespace kerf
