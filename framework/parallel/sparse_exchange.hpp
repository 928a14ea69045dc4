// Messages that their receivers do not know of before: each rank tells only the ranks that it has something for.
//
// The ranks agree that all messages have arrived by a consensus that costs one barrier, which nobody stands still in
// (T. Hoefler, C. Siebert & A. Lumsdaine, "Scalable communication protocols for dynamic sparse data exchange", PPoPP
// 2010, algorithm NBX).
#pragma once

#include <mpi.h>

#include <cstdint>
#include <cstring>
#include <functional>
#include <map>
#include <set>
#include <span>
#include <type_traits>
#include <utility>
#include <vector>

namespace kerf {

/// The count of items as MPI takes it. Throws std::runtime_error where there are too many.
int count_of_items(std::size_t n_items);

/// Items of one kind for one rank.
struct OutgoingMessage {
  int rank = 0;
  const void* data = nullptr;
  std::size_t n_items = 0;
};
/// Gives the place for `n_items` items from a rank, which stays where it is until the exchange is over.
using MessagePlace = std::function<void*(int rank, std::size_t n_items)>;

/// Sends every message and puts those for this rank where `place` says, in any order. At most one message per rank;
/// none to the rank itself. `item` is a datatype. Collective.
void exchange_sparsely(MPI_Comm comm, MPI_Datatype item, const std::vector<OutgoingMessage>& outgoing,
                       const MessagePlace& place);

/// Several lists of items for several ranks, in one message to each.
class SparseExchange {
 public:
  explicit SparseExchange(MPI_Comm comm, int n_lists) : comm_(comm), n_lists_(static_cast<std::size_t>(n_lists)) {}

  template <class T>
  void put(int list, int rank, const T& item) {
    static_assert(std::is_trivially_copyable_v<T>);
    auto& bytes = lists_for(rank)[static_cast<std::size_t>(list)];
    const char* data = reinterpret_cast<const char*>(&item);
    bytes.insert(bytes.end(), data, data + sizeof(T));
  }
  /// Collective.
  void deliver();
  /// The same without any agreement, where all receivers are among `to`; this rank is told by all of `from`, perhaps
  /// that there is nothing. Collective among ranks that list each other.
  void deliver_among(const std::set<int>& to, const std::set<int>& from);
  /// Ranks that something has been put in for.
  std::vector<int> receivers() const;
  /// Ranks that something has come from.
  std::vector<int> senders() const;

  /// What has come in a list: `visit(rank, item)`, ordered by rank, and of each rank in the order that it was put in.
  template <class T, class Visit>
  void each(int list, const Visit& visit) const {
    for (const auto& [rank, lists] : incoming_) {
      const std::span<const char> bytes = lists[static_cast<std::size_t>(list)];
      for (std::size_t at = 0; at + sizeof(T) <= bytes.size(); at += sizeof(T)) {
        T item;
        std::memcpy(&item, bytes.data() + at, sizeof(T));
        visit(rank, item);
      }
    }
  }
  template <class T>
  std::vector<T> take(int list) const {
    static_assert(std::is_trivially_copyable_v<T>);
    std::size_t n = 0;
    for (const auto& [rank, lists] : incoming_) n += lists[static_cast<std::size_t>(list)].size() / sizeof(T);
    std::vector<T> items(n);
    T* at = items.data();
    for (const auto& [rank, lists] : incoming_) {
      const std::span<const char> bytes = lists[static_cast<std::size_t>(list)];
      if (!bytes.empty()) std::memcpy(static_cast<void*>(at), bytes.data(), bytes.size());
      at += bytes.size() / sizeof(T);
    }
    return items;
  }

 private:
  using Lists = std::vector<std::vector<char>>;

  /// What is on the way to a rank.
  Lists& lists_for(int rank) {
    if (rank == last_rank_) return *last_;
    last_rank_ = rank;
    last_ = &outgoing_[rank];
    last_->resize(n_lists_);
    return *last_;
  }
  std::map<int, std::vector<std::int64_t>> pack();
  void unpack();

  MPI_Comm comm_;
  std::size_t n_lists_;
  std::map<int, Lists> outgoing_;  // by rank and list
  int last_rank_ = -1;
  Lists* last_ = nullptr;  // of last_rank_, in outgoing_
  Lists kept_;  // what this rank has put in for itself, which is not packed; empty where there is nothing
  std::map<int, std::vector<std::int64_t>> messages_;  // by other rank that has sent them
  std::vector<std::pair<int, std::vector<std::span<const char>>>> incoming_;  // rank; lists in messages_ or kept_
};

}  // namespace kerf
