// The consensus by which ranks know that all messages have arrived.
#include "parallel/sparse_exchange.hpp"

#include <algorithm>
#include <limits>
#include <stdexcept>
#include <utility>

#include "core/waiting.hpp"
#include "parallel/communicator.hpp"
#include "parallel/open_messages.hpp"

namespace kerf {

namespace {

/// Tags of exchanges, in turn: a rank that has left one exchange may send in the next, while another rank still looks
/// for messages of the first. It cannot be two exchanges ahead, because every exchange ends with a barrier of all.
constexpr int first_tag = 7100;
constexpr int known_tag = 7003;  // of messages between ranks that expect them
constexpr std::size_t word = sizeof(std::int64_t);

int delete_count(MPI_Comm, int, void* value, void*) {
  delete static_cast<std::int64_t*>(value);
  return MPI_SUCCESS;
}

/// The tag of the next exchange on a communicator, which keeps the count.
int next_tag(MPI_Comm comm) {
  static const int key = [] {
    int k = MPI_KEYVAL_INVALID;
    MPI_Comm_create_keyval(MPI_COMM_NULL_COPY_FN, &delete_count, &k, nullptr);
    return k;
  }();
  void* value = nullptr;
  int found = 0;
  MPI_Comm_get_attr(comm, key, &value, &found);
  if (found == 0) {
    value = new std::int64_t{0};
    MPI_Comm_set_attr(comm, key, value);
  }
  return first_tag + static_cast<int>((*static_cast<std::int64_t*>(value))++ % 2);
}

/// Receives a message of a tag if one has arrived.
bool receive(MPI_Comm comm, int tag, MPI_Datatype item, const MessagePlace& place) {
  int arrived = 0;
  MPI_Message message = MPI_MESSAGE_NULL;
  MPI_Status status;
  MPI_Improbe(MPI_ANY_SOURCE, tag, comm, &arrived, &message, &status);
  if (arrived == 0) return false;
  int n = 0;
  MPI_Get_count(&status, item, &n);
  MPI_Mrecv(place(status.MPI_SOURCE, static_cast<std::size_t>(n)), n, item, &message, MPI_STATUS_IGNORE);
  return true;
}

}  // namespace

int count_of_items(std::size_t n_items) {
  if (n_items > static_cast<std::size_t>(std::numeric_limits<int>::max()))
    throw std::runtime_error("a message has more items than MPI can count; use more ranks");
  return static_cast<int>(n_items);
}

void exchange_sparsely(MPI_Comm comm, MPI_Datatype item, const std::vector<OutgoingMessage>& outgoing,
                       const MessagePlace& place) {
  const Waiting waiting;
  std::vector<MPI_Request> sends;
  const int tag = next_tag(comm);
  for (const OutgoingMessage& m : outgoing) {
    sends.emplace_back();
    // Synchronous: it is complete when its receiver has taken it.
    MPI_Issend(m.data, count_of_items(m.n_items), item, m.rank, tag, comm, &sends.back());
  }
  MPI_Request barrier = MPI_REQUEST_NULL;
  for (int done = 0, all_taken = 0; done == 0;) {
    while (receive(comm, tag, item, place)) {
    }
    if (all_taken != 0) {
      MPI_Test(&barrier, &done, MPI_STATUS_IGNORE);
      continue;
    }
    MPI_Testall(static_cast<int>(sends.size()), sends.data(), &all_taken, MPI_STATUSES_IGNORE);
    if (all_taken != 0) MPI_Ibarrier(comm, &barrier);
  }
}

std::vector<int> SparseExchange::receivers() const {
  std::vector<int> ranks;
  for (const auto& [rank, lists] : outgoing_) ranks.push_back(rank);
  return ranks;
}

std::vector<int> SparseExchange::senders() const {
  std::vector<int> ranks;
  for (const auto& [rank, lists] : incoming_) ranks.push_back(rank);
  return ranks;
}

/// Messages by other rank: the length of each list in bytes, and the lists, filled up to whole words. What is for this
/// rank goes to kept_ as it is.
std::map<int, std::vector<std::int64_t>> SparseExchange::pack() {
  kept_.clear();
  if (const auto own = outgoing_.find(rank_of(comm_)); own != outgoing_.end()) {
    kept_ = std::move(own->second);
    outgoing_.erase(own);
  }
  std::map<int, std::vector<std::int64_t>> packed;
  for (const auto& [rank, lists] : outgoing_) {
    std::size_t n_bytes = 0;
    for (const auto& list : lists) n_bytes += list.size();
    std::vector<std::int64_t>& words = packed[rank];
    words.assign(n_lists_ + (n_bytes + word - 1) / word, 0);
    char* at = reinterpret_cast<char*>(words.data() + n_lists_);
    for (std::size_t k = 0; k < n_lists_; ++k) {
      words[k] = static_cast<std::int64_t>(lists[k].size());
      at = std::copy(lists[k].begin(), lists[k].end(), at);
    }
  }
  outgoing_.clear();
  last_rank_ = -1;
  return packed;
}

/// Makes incoming_ point to what has come, in the order of the ranks.
void SparseExchange::unpack() {
  incoming_.clear();
  const int here = rank_of(comm_);
  const auto add_kept = [&] {
    if (!kept_.empty()) incoming_.emplace_back(here, std::vector<std::span<const char>>(kept_.begin(), kept_.end()));
  };
  bool passed_here = false;
  for (const auto& [rank, words] : messages_) {
    if (rank > here && !passed_here) {
      add_kept();
      passed_here = true;
    }
    auto& lists = incoming_.emplace_back(rank, std::vector<std::span<const char>>{}).second;
    const char* at = reinterpret_cast<const char*>(words.data() + n_lists_);
    for (std::size_t k = 0; k < n_lists_; ++k) {
      lists.emplace_back(at, static_cast<std::size_t>(words[k]));
      at += words[k];
    }
  }
  if (!passed_here) add_kept();
}

void SparseExchange::deliver() {
  const std::map<int, std::vector<std::int64_t>> packed = pack();
  messages_.clear();
  std::vector<OutgoingMessage> out;
  for (const auto& [rank, words] : packed) out.push_back({rank, words.data(), words.size()});
  exchange_sparsely(comm_, MPI_INT64_T, out, [this](int rank, std::size_t n) {
    messages_[rank].resize(n);
    return messages_[rank].data();
  });
  unpack();
}

void SparseExchange::deliver_among(const std::set<int>& to, const std::set<int>& from) {
  const int here = rank_of(comm_);
  for (const int rank : to)
    if (rank != here) lists_for(rank);
  std::map<int, std::vector<std::int64_t>> packed = pack();
  messages_.clear();
  OpenMessages messages(comm_, known_tag);
  for (auto& [rank, words] : packed) {
    if (!to.contains(rank)) throw std::logic_error("a message to a rank that does not expect any");
    messages.send(rank, words);
  }
  for (const int rank : from)
    if (rank != here) messages_[rank] = messages.receive(rank);
  messages.finish();
  unpack();
}

}  // namespace kerf
