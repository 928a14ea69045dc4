// Messages between ranks that know of each other what they send: rows of numbers, one for each item of a list.
#pragma once

#include <mpi.h>

#include <cstddef>
#include <cstdint>
#include <stdexcept>
#include <vector>

#include "core/waiting.hpp"
#include "parallel/sparse_exchange.hpp"

namespace kerf {

/// Another rank, and the items that go to it or come from it.
struct Peer {
  int rank = 0;
  std::vector<std::int32_t> items;
};

/// The entry of a rank in a list that is ordered by rank; it is made where there is none.
Peer& peer_of(std::vector<Peer>& peers, int rank);

/// Rows of `T`, which takes eight bytes, sent and received with buffers that are kept from call to call.
template <class T>
class PeerMessages {
 public:
  static_assert(sizeof(T) == sizeof(std::int64_t));

  /// `pack(item, row)` fills the row of each item of `to`, and `unpack(item, row)` takes the one of each item of
  /// `from`. What one rank lists for another, the other lists for it, in the same number. Peers without items say
  /// nothing.
  template <class Pack, class Unpack>
  void exchange(MPI_Comm comm, const std::vector<Peer>& to, const std::vector<Peer>& from, int width, const Pack& pack,
                const Unpack& unpack) {
    post_receives(comm, from, width);
    std::size_t at = 0;
    outgoing_.resize(size_of(to, width));
    sends_.clear();
    for (const Peer& p : to) {
      if (p.items.empty()) continue;
      T* const rows = &outgoing_[at];
      for (std::size_t k = 0; k < p.items.size(); ++k) pack(p.items[k], rows + k * static_cast<std::size_t>(width));
      const std::size_t n = p.items.size() * static_cast<std::size_t>(width);
      at += n;
      const Waiting waiting;
      sends_.emplace_back();
      MPI_Isend(rows, count_of_items(n), MPI_INT64_T, p.rank, tag, comm, &sends_.back());
    }
    for (std::size_t n_left = receives_.size(); n_left > 0; --n_left) {
      const Arrival a = next_arrival();
      for (std::size_t k = 0; k < a.peer->items.size(); ++k)
        unpack(a.peer->items[k], a.rows + k * static_cast<std::size_t>(width));
    }
    const Waiting waiting;
    MPI_Waitall(static_cast<int>(sends_.size()), sends_.data(), MPI_STATUSES_IGNORE);
  }

 private:
  static constexpr int tag = 7000;

  struct Arrival {
    const Peer* peer = nullptr;
    const T* rows = nullptr;
    std::size_t n = 0;
  };
  static std::size_t size_of(const std::vector<Peer>& peers, int width) {
    std::size_t n = 0;
    for (const Peer& p : peers) n += p.items.size() * static_cast<std::size_t>(width);
    return n;
  }
  void post_receives(MPI_Comm comm, const std::vector<Peer>& from, int width) {
    const Waiting waiting;
    incoming_.resize(size_of(from, width));
    receives_.clear();
    expected_.clear();
    std::size_t at = 0;
    for (const Peer& p : from) {
      if (p.items.empty()) continue;
      const std::size_t n = p.items.size() * static_cast<std::size_t>(width);
      expected_.push_back({&p, &incoming_[at], n});
      receives_.emplace_back();
      MPI_Irecv(&incoming_[at], count_of_items(n), MPI_INT64_T, p.rank, tag, comm, &receives_.back());
      at += n;
    }
  }
  Arrival next_arrival() {
    const Waiting waiting;
    int which = 0, n = 0;
    MPI_Status status;
    MPI_Waitany(static_cast<int>(receives_.size()), receives_.data(), &which, &status);
    const Arrival& a = expected_[static_cast<std::size_t>(which)];
    MPI_Get_count(&status, MPI_INT64_T, &n);
    if (static_cast<std::size_t>(n) != a.n) throw std::logic_error("two ranks do not agree on what they exchange");
    return a;
  }

  std::vector<T> outgoing_, incoming_;
  std::vector<MPI_Request> sends_, receives_;
  std::vector<Arrival> expected_;  // one for each of receives_
};

}  // namespace kerf
