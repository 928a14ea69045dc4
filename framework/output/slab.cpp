// The communication behind SlabExchange: one all-to-all of ids to build a plan, one of values to use it.
#include "output/slab.hpp"

#include <algorithm>
#include <limits>
#include <numeric>
#include <stdexcept>

namespace kerf {

namespace {

/// An MPI type of `n` bytes, so that counts and displacements are in entities and stay small.
class ByteBlock {
 public:
  explicit ByteBlock(std::size_t n) {
    MPI_Type_contiguous(static_cast<int>(n), MPI_BYTE, &type_);
    MPI_Type_commit(&type_);
  }
  ByteBlock(const ByteBlock&) = delete;
  ByteBlock& operator=(const ByteBlock&) = delete;
  ~ByteBlock() { MPI_Type_free(&type_); }
  MPI_Datatype get() const { return type_; }

 private:
  MPI_Datatype type_ = MPI_DATATYPE_NULL;
};

std::vector<int> starts_of(const std::vector<int>& counts) {
  std::vector<int> starts(counts.size(), 0);
  std::exclusive_scan(counts.begin(), counts.end(), starts.begin(), 0);
  return starts;
}

void require(bool holds, const char* sentence) {
  if (!holds) throw std::invalid_argument(sentence);
}

/// Copies n values per entity, from source + from(i) to target + to(i). Common numbers of components are constants,
/// which lets the compiler unroll.
template <class T, class Given, class From, class To>
void copy_entities(std::size_t count, std::size_t n, const Given* source, From&& from, T* target, To&& to) {
  const auto copy = [&](auto components) {
    for (std::size_t i = 0; i < count; ++i) {
      const Given* in = source + from(i);
      T* out = target + to(i);
      for (std::size_t c = 0; c < components; ++c) out[c] = static_cast<T>(in[c]);
    }
  };
  switch (n) {
    case 1:
      return copy(std::integral_constant<std::size_t, 1>{});
    case 3:
      return copy(std::integral_constant<std::size_t, 3>{});
    case 6:
      return copy(std::integral_constant<std::size_t, 6>{});
    default:
      return copy(n);
  }
}

/// The index functions of copy_entities for lists of n values per entity.
auto listed(const std::vector<std::int32_t>& list, std::size_t n) {
  return [data = list.data(), n](std::size_t i) { return static_cast<std::size_t>(data[i]) * n; };
}
auto in_order(std::size_t n) {
  return [n](std::size_t i) { return i * n; };
}
template <class Given>
auto held(const std::vector<std::int32_t>& list, const HeldValues<Given>& values) {
  return [data = list.data(), &values](std::size_t i) { return values.offset_of(static_cast<std::size_t>(data[i])); };
}

enum Fault { none = 0, out_of_range = 1, repeated = 2, too_many = 3 };

void throw_everywhere(MPI_Comm comm, int fault) {
  MPI_Allreduce(MPI_IN_PLACE, &fault, 1, MPI_INT, MPI_MAX, comm);
  require(fault != out_of_range, "a global id is negative or not below the global number of entities");
  require(fault != repeated, "a global id is held twice, by one rank or by two");
  require(fault != too_many, "one rank holds or stores more than 2^31 - 1 entities; use more ranks");
}

}  // namespace

SlabExchange::SlabExchange(MPI_Comm comm, std::int64_t n_global, std::span<const std::int64_t> gids)
    : comm_(comm), n_global_(n_global), n_held_(static_cast<std::int64_t>(gids.size())) {
  int rank = 0, n_ranks = 1;
  MPI_Comm_rank(comm, &rank);
  MPI_Comm_size(comm, &n_ranks);
  begin_ = slab_begin(n_global, rank, n_ranks);
  const std::int64_t end = slab_begin(n_global, rank + 1, n_ranks);
  constexpr std::int64_t limit = std::numeric_limits<std::int32_t>::max();
  throw_everywhere(comm, n_held_ > limit || end - begin_ > limit ? too_many : none);
  present_.assign(static_cast<std::size_t>(end - begin_), 0);
  int fault = none;

  // (i) split the held ids into those that stay and those that go, the latter counted by destination
  const auto is_known = [n_global](std::int64_t gid) { return gid >= 0 && gid < n_global; };
  held_counts_.assign(static_cast<std::size_t>(n_ranks), 0);
  for (std::size_t i = 0; i < gids.size(); ++i) {
    if (!is_known(gids[i])) {
      fault = out_of_range;
    } else if (gids[i] >= begin_ && gids[i] < end) {
      local_held_.push_back(static_cast<std::int32_t>(i));
      local_slot_.push_back(static_cast<std::int32_t>(gids[i] - begin_));
    } else {
      ++held_counts_[static_cast<std::size_t>(slab_owner(n_global, gids[i], n_ranks))];
    }
  }
  held_starts_ = starts_of(held_counts_);

  // (ii) order those that go by destination and tell each destination which ids it will get
  std::vector<int> next = held_starts_;
  remote_held_.resize(static_cast<std::size_t>(held_starts_.back() + held_counts_.back()));
  std::vector<std::int64_t> sent(remote_held_.size());
  for (std::size_t i = 0; i < gids.size(); ++i) {
    if (!is_known(gids[i]) || (gids[i] >= begin_ && gids[i] < end)) continue;
    const auto owner = static_cast<std::size_t>(slab_owner(n_global, gids[i], n_ranks));
    const auto at = static_cast<std::size_t>(next[owner]++);
    remote_held_[at] = static_cast<std::int32_t>(i);
    sent[at] = gids[i];
  }
  slot_counts_.assign(static_cast<std::size_t>(n_ranks), 0);
  MPI_Alltoall(held_counts_.data(), 1, MPI_INT, slot_counts_.data(), 1, MPI_INT, comm);
  slot_starts_ = starts_of(slot_counts_);
  std::vector<std::int64_t> received(static_cast<std::size_t>(slot_starts_.back() + slot_counts_.back()));
  MPI_Alltoallv(sent.data(), held_counts_.data(), held_starts_.data(), MPI_INT64_T, received.data(),
                slot_counts_.data(), slot_starts_.data(), MPI_INT64_T, comm);

  // (iii) note where they go, and that nobody claims a place twice
  remote_slot_.resize(received.size());
  std::transform(received.begin(), received.end(), remote_slot_.begin(),
                 [this](std::int64_t gid) { return static_cast<std::int32_t>(gid - begin_); });
  for (const auto* slots : {&local_slot_, &remote_slot_})
    for (const std::int32_t slot : *slots) {
      std::uint8_t& taken = present_[static_cast<std::size_t>(slot)];
      if (taken) fault = std::max<int>(fault, repeated);
      taken = 1;
    }
  throw_everywhere(comm, fault);
  all_present_ = std::find(present_.begin(), present_.end(), std::uint8_t{0}) == present_.end();
}

template <class T, class Given>
void SlabExchange::update_slab(const std::type_identity_t<HeldValues<Given>>& values, int components,
                               std::span<std::type_identity_t<T>> slab) const {
  require(components > 0, "the number of components has to be positive");
  const auto n = static_cast<std::size_t>(components);
  require(values.n_entities == static_cast<std::size_t>(n_held_) && (n_held_ == 0 || values.stride >= n),
          "there have to be `components` values per held id");
  require(slab.size() == present_.size() * n, "the slab has the wrong size");
  copy_entities(local_held_.size(), n, values.data, held(local_held_, values), slab.data(), listed(local_slot_, n));
  if (held_counts_.size() == 1) return;

  std::vector<T> sent(remote_held_.size() * n), received(remote_slot_.size() * n);
  copy_entities(remote_held_.size(), n, values.data, held(remote_held_, values), sent.data(), in_order(n));
  const ByteBlock entity(n * sizeof(T));
  MPI_Alltoallv(sent.data(), held_counts_.data(), held_starts_.data(), entity.get(), received.data(),
                slot_counts_.data(), slot_starts_.data(), entity.get(), comm_);
  copy_entities(remote_slot_.size(), n, received.data(), in_order(n), slab.data(), listed(remote_slot_, n));
}

template <class T>
std::vector<T> SlabExchange::from_slab(std::span<const std::type_identity_t<T>> slab, int components) const {
  require(components > 0, "the number of components has to be positive");
  const auto n = static_cast<std::size_t>(components);
  require(slab.size() == present_.size() * n, "the slab has the wrong size");
  std::vector<T> values(static_cast<std::size_t>(n_held_) * n);
  copy_entities(local_held_.size(), n, slab.data(), listed(local_slot_, n), values.data(), listed(local_held_, n));
  if (held_counts_.size() == 1) return values;

  std::vector<T> sent(remote_slot_.size() * n), received(remote_held_.size() * n);
  copy_entities(remote_slot_.size(), n, slab.data(), listed(remote_slot_, n), sent.data(), in_order(n));
  const ByteBlock entity(n * sizeof(T));
  MPI_Alltoallv(sent.data(), slot_counts_.data(), slot_starts_.data(), entity.get(), received.data(),
                held_counts_.data(), held_starts_.data(), entity.get(), comm_);
  copy_entities(remote_held_.size(), n, received.data(), in_order(n), values.data(), listed(remote_held_, n));
  return values;
}

const SlabExchange& SlabExchangeCache::get(MPI_Comm comm, std::int64_t n_global, std::span<const std::int64_t> gids) {
  const bool here = place_ == nullptr || place_ == gids.data();
  int same = plan_ && current_ && here && plan_->n_global() == n_global &&
             plan_->n_held() == static_cast<std::int64_t>(gids.size());
  MPI_Allreduce(MPI_IN_PLACE, &same, 1, MPI_INT, MPI_LAND, comm);
  if (!same) {
    plan_.reset();
    plan_ = std::make_unique<SlabExchange>(comm, n_global, gids);
  }
  current_ = true;
  place_ = gids.data();
  return *plan_;
}

#define KERF_SLAB_TYPES(T, Given)                                                                        \
  template void SlabExchange::update_slab<T, Given>(const std::type_identity_t<HeldValues<Given>>&, int, \
                                                    std::span<std::type_identity_t<T>>) const;
KERF_SLAB_TYPES(double, double)
KERF_SLAB_TYPES(float, float)
KERF_SLAB_TYPES(float, double)
KERF_SLAB_TYPES(std::int64_t, std::int64_t)
KERF_SLAB_TYPES(std::int32_t, std::int32_t)
KERF_SLAB_TYPES(std::uint8_t, std::uint8_t)
#undef KERF_SLAB_TYPES

template std::vector<double> SlabExchange::from_slab<double>(std::span<const double>, int) const;
template std::vector<float> SlabExchange::from_slab<float>(std::span<const float>, int) const;
template std::vector<std::int64_t> SlabExchange::from_slab<std::int64_t>(std::span<const std::int64_t>, int) const;
template std::vector<std::int32_t> SlabExchange::from_slab<std::int32_t>(std::span<const std::int32_t>, int) const;
template std::vector<std::uint8_t> SlabExchange::from_slab<std::uint8_t>(std::span<const std::uint8_t>, int) const;

}  // namespace kerf
