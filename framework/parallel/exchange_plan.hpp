// Carries values between the owner of an item and its copies elsewhere, along the lists of a Tpetra Import.
#pragma once

#include <mpi.h>

#include <cstdint>
#include <memory>
#include <vector>

namespace kerf {

/// An item that this rank needs a copy of.
struct Needed {
  std::int64_t id = 0;
  int owner = 0;  // rank
};

/// Built when ownership or needs change; used every cycle. All members are collective.
/// Items are numbered: `needed` in the order given (the copies), `sources` as the owner's local indices.
class ExchangePlan {
 public:
  /// Pre: ids are unique within `needed`; `local_index(id)` is called on the owner only.
  template <class LocalIndex>
  ExchangePlan(MPI_Comm comm, const std::vector<Needed>& needed, const LocalIndex& local_index)
      : ExchangePlan(comm, needed) {
    sources_.reserve(requested().size());
    for (const std::int64_t id : requested()) sources_.push_back(local_index(id));
  }
  ~ExchangePlan();
  ExchangePlan(const ExchangePlan&) = delete;
  ExchangePlan& operator=(const ExchangePlan&) = delete;

  /// Owners' local indices of the items that somebody needs.
  const std::vector<std::int32_t>& sources() const { return sources_; }

  /// After the owner's local indices changed: `moved(old)` is the new index, or -1 for an item that is gone, whose
  /// copies receive zero from now on. Local.
  template <class Moved>
  void renumber(const Moved& moved) {
    for (std::int32_t& s : sources_)
      if (s >= 0) s = moved(s);
  }

  /// copies[i * copy_stride + c] = owner's values[source * stride + c] for c < n_components (at most 8).
  void pull(const double* values, int stride, double* copies, int copy_stride, int n_components);
  void pull(const std::int64_t* values, int stride, std::int64_t* copies, int copy_stride, int n_components);
  /// Owner's values[source * stride + c] += sum over all copies; exact, hence order-free.
  void push_add(const std::int64_t* copies, int copy_stride, std::int64_t* values, int stride, int n_components);

 private:
  ExchangePlan(MPI_Comm comm, const std::vector<Needed>& needed);
  const std::vector<std::int64_t>& requested() const;
  void check_order(const std::vector<std::int64_t>& ids);

  struct Plan;
  std::unique_ptr<Plan> plan_;
  std::vector<std::int32_t> sources_;
};

}  // namespace kerf
