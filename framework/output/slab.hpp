// Moves values between "whoever holds the entity now" and "equal contiguous slabs in global order".
//
// Files are written in the original global order whatever the owners are; this is the only place where the
// two orders meet. A rank may hold nothing, and there may be more ranks than entities.
#pragma once

#include <mpi.h>

#include <cstdint>
#include <memory>
#include <span>
#include <stdexcept>
#include <type_traits>
#include <vector>

namespace kerf {

/// Values of held entities: those of the i-th begin at data[i * stride] or, where there are rows, one per entity, at
/// data[row[i] * stride]. Empty by default.
template <class T>
struct HeldValues {
  const T* data = nullptr;
  std::size_t n_entities = 0, stride = 0;
  const std::int32_t* row = nullptr;

  /// All entities' values one after another.
  static HeldValues in_order(std::span<const T> values, int components) {
    const auto n = static_cast<std::size_t>(components);
    if (components <= 0 || values.size() % n != 0)
      throw std::invalid_argument("there have to be `components` values per held id");
    return {values.data(), values.size() / n, n, nullptr};
  }
  std::size_t offset_of(std::size_t i) const {
    return (row != nullptr ? static_cast<std::size_t>(row[i]) : i) * stride;
  }
};

/// A communication plan from the entities that ranks hold to contiguous slabs, built once and used often.
///
/// Rank r of R is responsible for the global ids [r N / R, (r + 1) N / R). The communicator is not duplicated
/// and has to outlive the plan. Values are for T = double, float, int64_t, int32_t, uint8_t, and for doubles
/// that are rounded to float on the way (to_slab<float, double>), which halves what is sent.
class SlabExchange {
 public:
  /// Pre: every gid is in [0, n_global) and held by at most one rank, once. Collective; where the precondition
  /// does not hold every rank throws std::invalid_argument.
  SlabExchange(MPI_Comm comm, std::int64_t n_global, std::span<const std::int64_t> gids);

  /// The slab of `rank`: its first global id; the slab of rank + 1 begins where this one ends.
  static std::int64_t slab_begin(std::int64_t n_global, int rank, int n_ranks) { return rank * n_global / n_ranks; }
  /// Rank whose slab holds `gid`. Pre: 0 <= gid < n_global.
  static int slab_owner(std::int64_t n_global, std::int64_t gid, int n_ranks) {
    return static_cast<int>(((gid + 1) * n_ranks - 1) / n_global);
  }

  std::int64_t begin() const { return begin_; }
  std::int64_t slab_size() const { return static_cast<std::int64_t>(present_.size()); }
  std::int64_t n_global() const { return n_global_; }
  /// Number of gids that this rank passed to the constructor.
  std::int64_t n_held() const { return n_held_; }
  /// One entry per entity of the slab: 1 where some rank holds it, 0 where nobody does.
  std::span<const std::uint8_t> present() const { return present_; }
  bool all_present() const { return all_present_; }

  /// Pre: values has `components` entries per held gid, in the order of the gids.
  /// Post: values of this rank's slab in global order, `fill` where nobody holds the entity. Collective.
  template <class T, class Given = T>
  std::vector<T> to_slab(std::span<const std::type_identity_t<Given>> values, int components,
                         std::type_identity_t<T> fill) const {
    std::vector<T> slab(static_cast<std::size_t>(slab_size()) * static_cast<std::size_t>(components), fill);
    update_slab<T, Given>(HeldValues<Given>::in_order(values, components), components, slab);
    return slab;
  }

  /// As to_slab, but leaves the entries of `slab` alone where nobody holds the entity. Pre: as many entities as gids,
  /// no fewer values from one to the next than `components`. Collective.
  template <class T, class Given = T>
  void update_slab(const std::type_identity_t<HeldValues<Given>>& values, int components,
                   std::span<std::type_identity_t<T>> slab) const;

  /// Pre: `slab` has `components` entries per entity of this rank's slab.
  /// Post: values of the held gids, in the order of the gids. Collective.
  template <class T>
  std::vector<T> from_slab(std::span<const std::type_identity_t<T>> slab, int components) const;

 private:
  MPI_Comm comm_;
  std::int64_t n_global_ = 0, begin_ = 0, n_held_ = 0;
  std::vector<std::uint8_t> present_;
  bool all_present_ = false;
  // Held entities that stay on this rank: place among the gids, place in the slab.
  std::vector<std::int32_t> local_held_, local_slot_;
  // Held entities that others store, ordered by rank; slab places that others fill, ordered by rank.
  std::vector<std::int32_t> remote_held_, remote_slot_;
  std::vector<int> held_counts_, held_starts_, slot_counts_, slot_starts_;
};

/// Keeps the last plan, for the same gids, and builds a new one for others. It takes the caller's word for what is the
/// same: copies of the gids to compare with would be as large as what is written.
class SlabExchangeCache {
 public:
  /// Collective. The reference is valid until the next call. Ids that stand where those of the call before stood are
  /// taken to be the same, unless forget() was called.
  const SlabExchange& get(MPI_Comm comm, std::int64_t n_global, std::span<const std::int64_t> gids);
  /// The next ids may be others.
  void forget() { current_ = false; }
  /// The next ids are the same, wherever they stand.
  void expect_same() { place_ = nullptr; }

 private:
  bool current_ = false;
  const std::int64_t* place_ = nullptr;  // null: anywhere
  std::unique_ptr<SlabExchange> plan_;
};

}  // namespace kerf
