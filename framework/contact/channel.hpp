// The way between the ranks that own nodes and the ranks that look at the same nodes for contact.
//
// A rank that looks at nodes of others is their holder. Owners and holders get to know of each other with the records
// of the contact surface; from then on they know what the other sends, so that no operation of all ranks is needed.
// Two lists are kept: of all nodes that are held, for positions and velocities, and of the active ones, which touch
// something in this step, for the sums of contact.
#pragma once

#include <mpi.h>

#include <cstdint>
#include <functional>
#include <span>
#include <utility>
#include <vector>

#include "contact/candidates.hpp"
#include "parallel/peer_messages.hpp"

namespace kerf {

class ContactChannel {
 public:
  explicit ContactChannel(MPI_Comm comm);

  /// Forgets all nodes and all other ranks. Local.
  void clear();
  /// This rank looks at records with nodes that `owner` owns. Local.
  void meet_owner(int owner);
  /// `holder` looks at records with nodes that this rank owns; it has said meet_owner(). Local.
  void meet_holder(int holder);
  /// Asks the owners for the nodes of the view from number `first` on; `local_node(id)` is this rank's number of one of
  /// its own. Collective among ranks that have met, who all call it after the same changes.
  void request(const Candidates& view, std::size_t first, const std::function<std::int32_t(std::int64_t)>& local_node);

  /// `read(node, row)` fills eight numbers for a node that this rank owns, and `write(view_node, row)` takes those of a
  /// node of the view. Collective among ranks that have met.
  template <class Read, class Write>
  void pull_states(const Read& read, const Write& write) {
    double row[state_width];
    for (const auto& [view_node, node] : own_) {
      read(node, row);
      write(view_node, row);
    }
    reals_.exchange(comm_, holders_, owners_, state_width, read, write);
  }
  /// Adds a number of each node of the view to the owner's, wherever it is looked at. Collective as above.
  void add_to_owners(std::span<const std::int64_t> of_view, std::span<std::int64_t> of_nodes);

  /// The nodes of the view that take part in sums until the next call. Sums up their rows of shares, three numbers by
  /// node of the view, on all ranks. Collective as above.
  void activate(const std::vector<std::int32_t>& active, std::span<std::int64_t> shares);
  /// Sums up rows of `width` numbers of the active nodes, `stride` apart by node of the view. `totals` may be `rows`.
  void sum(const std::int64_t* rows, std::int64_t* totals, int stride, int width);
  /// The sums for the nodes that this rank owns and somebody holds as active: four numbers for each of active_nodes().
  const std::vector<std::int64_t>& collect(const std::int64_t* rows, int stride, int width);
  /// Local numbers of the nodes that this rank owns and that are active anywhere.
  const std::vector<std::int32_t>& active_nodes() const { return active_nodes_; }

  static constexpr int state_width = 8, share_width = 3;

 private:
  std::int32_t place_of(std::int32_t node);
  void answer(std::int64_t* rows, int stride, int width);
  void take_active(const Peer& holder, std::span<const std::int64_t> rows);

  MPI_Comm comm_;
  int here_;
  bool alone_;  // on one rank
  std::vector<Peer> owners_, holders_;  // nodes of the view by owner; this rank's nodes by rank that looks at them
  std::vector<std::pair<std::int32_t, std::int32_t>> own_;  // nodes of the view that this rank owns: there, and here
  // The same for active nodes; nodes that this rank owns by their place in active_nodes_.
  std::vector<Peer> active_owners_, active_holders_;
  std::vector<std::pair<std::int32_t, std::int32_t>> active_own_;
  std::vector<std::int32_t> active_nodes_, place_;  // place_: per local node, its place in active_nodes_ or -1
  std::vector<char> is_active_;  // per node of the view
  std::vector<std::int64_t> sums_;  // four per active node of this rank
  PeerMessages<double> reals_;
  PeerMessages<std::int64_t> integers_;
};

}  // namespace kerf
