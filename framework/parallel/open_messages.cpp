// Sending, and receiving what has been looked at before.
#include "parallel/open_messages.hpp"

#include "core/waiting.hpp"
#include "parallel/sparse_exchange.hpp"

namespace kerf {

void OpenMessages::send(int rank, const std::vector<std::int64_t>& words) {
  const Waiting waiting;
  sends_.emplace_back();
  MPI_Isend(words.data(), count_of_items(words.size()), MPI_INT64_T, rank, tag_, comm_, &sends_.back());
}

std::vector<std::int64_t> OpenMessages::receive(int rank) {
  const Waiting waiting;
  MPI_Message message = MPI_MESSAGE_NULL;
  MPI_Status status;
  MPI_Mprobe(rank, tag_, comm_, &message, &status);
  int n = 0;
  MPI_Get_count(&status, MPI_INT64_T, &n);
  std::vector<std::int64_t> words(static_cast<std::size_t>(n));
  MPI_Mrecv(words.data(), n, MPI_INT64_T, &message, MPI_STATUS_IGNORE);
  return words;
}

void OpenMessages::finish() {
  const Waiting waiting;
  MPI_Waitall(static_cast<int>(sends_.size()), sends_.data(), MPI_STATUSES_IGNORE);
}

}  // namespace kerf
