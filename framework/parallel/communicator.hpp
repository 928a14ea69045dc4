// Typed wrappers of the few MPI calls that Kerf makes itself.
#pragma once

#include <mpi.h>

#include <cstdint>
#include <string>
#include <type_traits>
#include <utility>
#include <vector>

#include "core/waiting.hpp"
#include "parallel/sparse_exchange.hpp"

namespace kerf {

inline int rank_of(MPI_Comm comm) {
  int r = 0;
  MPI_Comm_rank(comm, &r);
  return r;
}
inline int size_of(MPI_Comm comm) {
  int n = 1;
  MPI_Comm_size(comm, &n);
  return n;
}
inline std::int64_t sum_of(MPI_Comm comm, std::int64_t v) {
  const Waiting waiting;
  MPI_Allreduce(MPI_IN_PLACE, &v, 1, MPI_INT64_T, MPI_SUM, comm);
  return v;
}
inline std::int64_t greatest(MPI_Comm comm, std::int64_t v) {
  const Waiting waiting;
  MPI_Allreduce(MPI_IN_PLACE, &v, 1, MPI_INT64_T, MPI_MAX, comm);
  return v;
}
inline double greatest(MPI_Comm comm, double v) {
  const Waiting waiting;
  MPI_Allreduce(MPI_IN_PLACE, &v, 1, MPI_DOUBLE, MPI_MAX, comm);
  return v;
}
inline double least(MPI_Comm comm, double v) {
  const Waiting waiting;
  MPI_Allreduce(MPI_IN_PLACE, &v, 1, MPI_DOUBLE, MPI_MIN, comm);
  return v;
}

/// A datatype of sizeof(T) bytes, so that counts are in items and messages may exceed 2 GiB.
template <class T>
class ItemType {
 public:
  static_assert(std::is_trivially_copyable_v<T>);
  ItemType() {
    MPI_Type_contiguous(static_cast<int>(sizeof(T)), MPI_BYTE, &type_);
    MPI_Type_commit(&type_);
  }
  ItemType(const ItemType&) = delete;
  ItemType& operator=(const ItemType&) = delete;
  ~ItemType() { MPI_Type_free(&type_); }
  operator MPI_Datatype() const { return type_; }

 private:
  MPI_Datatype type_ = MPI_DATATYPE_NULL;
};

/// Sends `outgoing[r]` to rank r; returns what came from each rank. Ranks that have nothing for one another say
/// nothing. Collective.
template <class T>
std::vector<std::vector<T>> all_to_all(MPI_Comm comm, std::vector<std::vector<T>> outgoing) {
  const int n = size_of(comm), here = rank_of(comm);
  if (n == 1) return outgoing;
  std::vector<OutgoingMessage> messages;
  for (int r = 0; r < n; ++r)
    if (r != here && !outgoing[r].empty()) messages.push_back({r, outgoing[r].data(), outgoing[r].size()});
  const ItemType<T> item;
  std::vector<std::vector<T>> incoming(static_cast<std::size_t>(n));
  incoming[here] = std::move(outgoing[here]);
  exchange_sparsely(comm, item, messages, [&incoming](int rank, std::size_t n_items) {
    incoming[static_cast<std::size_t>(rank)].resize(n_items);
    return static_cast<void*>(incoming[static_cast<std::size_t>(rank)].data());
  });
  return incoming;
}

/// All ranks' items on rank 0, in rank order; empty elsewhere. Collective.
template <class T>
std::vector<T> gather_to_root(MPI_Comm comm, const std::vector<T>& local) {
  std::vector<std::vector<T>> outgoing(static_cast<std::size_t>(size_of(comm)));
  outgoing[0] = local;
  const auto incoming = all_to_all(comm, outgoing);
  std::vector<T> all;
  for (const auto& part : incoming) all.insert(all.end(), part.begin(), part.end());
  return all;
}

/// The most bytes that broadcast() puts in one message: MPI counts them with 31 bits.
inline constexpr std::size_t largest_piece = std::size_t{1} << 30;

/// Rank 0's text on every rank, however long it is. Collective; `piece` is the same on all ranks.
std::string broadcast(MPI_Comm comm, std::string text, std::size_t piece = largest_piece);

/// The text of the lowest rank whose text is not empty, on every rank; empty where all are. Collective.
std::string first_text(MPI_Comm comm, const std::string& text);

}  // namespace kerf
