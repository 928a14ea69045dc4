// Requests for nodes, and the sums of the active ones.
#include "contact/channel.hpp"

#include <algorithm>

#include "core/assert.hpp"
#include "parallel/communicator.hpp"
#include "parallel/open_messages.hpp"

namespace kerf {

namespace {

constexpr int request_tag = 7001, active_tag = 7002;
constexpr int active_width = 1 + ContactChannel::share_width;  // place in the list of the owner, and the shares

}  // namespace

ContactChannel::ContactChannel(MPI_Comm comm) : comm_(comm), here_(rank_of(comm)), alone_(size_of(comm) == 1) {}

void ContactChannel::clear() {
  owners_.clear();
  holders_.clear();
  own_.clear();
  active_owners_.clear();
  active_holders_.clear();
  active_own_.clear();
  active_nodes_.clear();
  place_.clear();
  is_active_.clear();
}

void ContactChannel::meet_owner(int owner) {
  if (owner != here_) peer_of(owners_, owner);
}

void ContactChannel::meet_holder(int holder) {
  if (holder != here_) peer_of(holders_, holder);
}

void ContactChannel::request(const Candidates& view, std::size_t first,
                             const std::function<std::int32_t(std::int64_t)>& local_node) {
  std::vector<std::vector<std::int64_t>> wanted(owners_.size());
  for (std::size_t i = first; i < view.node_id.size(); ++i) {
    if (view.node_owner[i] == here_) {
      const std::int32_t local = view.node_local[i];
      own_.emplace_back(static_cast<std::int32_t>(i), local >= 0 ? local : local_node(view.node_id[i]));
      continue;
    }
    Peer& owner = peer_of(owners_, view.node_owner[i]);
    KERF_ASSERT(owners_.size() == wanted.size(), "the owners of all nodes of records are met with the records");
    owner.items.push_back(static_cast<std::int32_t>(i));
    wanted[static_cast<std::size_t>(&owner - owners_.data())].push_back(view.node_id[i]);
  }
  OpenMessages messages(comm_, request_tag);
  for (std::size_t k = 0; k < owners_.size(); ++k) messages.send(owners_[k].rank, wanted[k]);
  for (Peer& holder : holders_)
    for (const std::int64_t id : messages.receive(holder.rank)) holder.items.push_back(local_node(id));
  messages.finish();
}

void ContactChannel::add_to_owners(std::span<const std::int64_t> of_view, std::span<std::int64_t> of_nodes) {
  for (const auto& [view_node, node] : own_) of_nodes[node] += of_view[view_node];
  integers_.exchange(
      comm_, owners_, holders_, 1, [&](std::int32_t i, std::int64_t* row) { *row = of_view[i]; },
      [&](std::int32_t node, const std::int64_t* row) { of_nodes[node] += *row; });
}

/// The place of a node that this rank owns among the active ones, which it joins.
std::int32_t ContactChannel::place_of(std::int32_t node) {
  if (static_cast<std::size_t>(node) >= place_.size()) place_.resize(static_cast<std::size_t>(node) + 1, -1);
  if (place_[node] < 0) {
    place_[node] = static_cast<std::int32_t>(active_nodes_.size());
    active_nodes_.push_back(node);
    sums_.insert(sums_.end(), 4, 0);
  }
  return place_[node];
}

void ContactChannel::take_active(const Peer& holder, std::span<const std::int64_t> rows) {
  if (rows.empty()) return;
  Peer& active = active_holders_.emplace_back();
  active.rank = holder.rank;
  for (std::size_t at = 0; at < rows.size(); at += active_width) {
    const std::int32_t place = place_of(holder.items[static_cast<std::size_t>(rows[at])]);
    active.items.push_back(place);
    for (int c = 0; c < share_width; ++c) sums_[4 * static_cast<std::size_t>(place) + c] += rows[at + 1 + c];
  }
}

void ContactChannel::activate(const std::vector<std::int32_t>& active, std::span<std::int64_t> shares) {
  for (const std::int32_t node : active_nodes_) place_[node] = -1;
  active_nodes_.clear();
  active_own_.clear();
  active_owners_.clear();
  active_holders_.clear();
  sums_.clear();
  is_active_.assign(shares.size() / share_width, 0);
  for (const std::int32_t i : active) is_active_[i] = 1;
  const auto shares_of = [&](std::int32_t i) { return &shares[share_width * static_cast<std::size_t>(i)]; };

  OpenMessages messages(comm_, active_tag);
  std::vector<std::vector<std::int64_t>> told(owners_.size());
  for (std::size_t k = 0; k < owners_.size(); ++k) {
    if (owners_[k].items.empty()) continue;
    Peer mine{owners_[k].rank, {}};
    for (std::size_t at = 0; at < owners_[k].items.size(); ++at) {
      const std::int32_t i = owners_[k].items[at];
      if (is_active_[i] == 0) continue;
      mine.items.push_back(i);
      told[k].push_back(static_cast<std::int64_t>(at));
      told[k].insert(told[k].end(), shares_of(i), shares_of(i) + share_width);
    }
    messages.send(mine.rank, told[k]);
    if (!mine.items.empty()) active_owners_.push_back(std::move(mine));
  }
  for (const auto& [i, node] : own_) {
    if (is_active_[i] == 0) continue;
    const std::int32_t place = place_of(node);
    active_own_.emplace_back(i, place);
    for (int c = 0; c < share_width; ++c) sums_[4 * static_cast<std::size_t>(place) + c] += shares_of(i)[c];
  }
  for (const Peer& holder : holders_)
    if (!holder.items.empty()) take_active(holder, messages.receive(holder.rank));
  messages.finish();
  answer(shares.data(), share_width, share_width);
}

/// The owners' sums become the rows of all holders.
void ContactChannel::answer(std::int64_t* rows, int stride, int width) {
  const auto sums_at = [this](std::int32_t place) { return &sums_[4 * static_cast<std::size_t>(place)]; };
  const auto write = [&](std::int32_t i, const std::int64_t* row) {
    std::copy_n(row, width, rows + static_cast<std::size_t>(i) * stride);
  };
  for (const auto& [i, place] : active_own_) write(i, sums_at(place));
  integers_.exchange(
      comm_, active_holders_, active_owners_, width,
      [&](std::int32_t place, std::int64_t* row) { std::copy_n(sums_at(place), width, row); }, write);
}

const std::vector<std::int64_t>& ContactChannel::collect(const std::int64_t* rows, int stride, int width) {
  std::fill(sums_.begin(), sums_.end(), 0);
  const auto add = [&](std::int32_t place, const std::int64_t* row) {
    for (int c = 0; c < width; ++c) sums_[4 * static_cast<std::size_t>(place) + c] += row[c];
  };
  for (const auto& [i, place] : active_own_) add(place, rows + static_cast<std::size_t>(i) * stride);
  integers_.exchange(
      comm_, active_owners_, active_holders_, width,
      [&](std::int32_t i, std::int64_t* row) { std::copy_n(rows + static_cast<std::size_t>(i) * stride, width, row); },
      add);
  return sums_;
}

void ContactChannel::sum(const std::int64_t* rows, std::int64_t* totals, int stride, int width) {
  if (alone_) {
    if (rows == totals) return;
    for (const auto& [i, place] : active_own_)
      std::copy_n(rows + static_cast<std::size_t>(i) * stride, width, totals + static_cast<std::size_t>(i) * stride);
    return;
  }
  collect(rows, stride, width);
  answer(totals, stride, width);
}

}  // namespace kerf
