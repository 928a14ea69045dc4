// Lists of peers.
#include "parallel/peer_messages.hpp"

#include <algorithm>

namespace kerf {

Peer& peer_of(std::vector<Peer>& peers, int rank) {
  const auto at =
      std::lower_bound(peers.begin(), peers.end(), rank, [](const Peer& p, int value) { return p.rank < value; });
  if (at != peers.end() && at->rank == rank) return *at;
  return *peers.insert(at, {rank, {}});
}

}  // namespace kerf
