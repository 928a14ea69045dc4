// Work that one rank does and all ranks have to agree on.
#pragma once

#include <mpi.h>

#include <exception>
#include <stdexcept>
#include <string>

namespace kerf {

/// A file or a stream that could not be written or read. Thrown on all ranks together, with the same sentence.
class OutputError : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};

/// Replaces `text` on all ranks by that of rank `root`. Collective.
inline void broadcast_text(MPI_Comm comm, std::string& text, int root = 0) {
  unsigned long long length = text.size();
  MPI_Bcast(&length, 1, MPI_UNSIGNED_LONG_LONG, root, comm);
  text.resize(length);
  MPI_Bcast(text.data(), static_cast<int>(length), MPI_CHAR, root, comm);
}

/// Throws OutputError on every rank where any rank passes a text; the text of the lowest of them. Collective.
inline void agree(MPI_Comm comm, std::string failure) {
  int rank = 0, n_ranks = 1;
  MPI_Comm_rank(comm, &rank);
  MPI_Comm_size(comm, &n_ranks);
  int failed = failure.empty() ? n_ranks : rank;
  MPI_Allreduce(MPI_IN_PLACE, &failed, 1, MPI_INT, MPI_MIN, comm);
  if (failed == n_ranks) return;
  broadcast_text(comm, failure, failed);
  throw OutputError(failure);
}

/// Runs `work` on rank 0. Post: if it threw there, every rank throws OutputError with its message, so that no rank
/// is left waiting. Collective.
template <class Work>
void on_root(MPI_Comm comm, Work&& work) {
  int rank = 0;
  MPI_Comm_rank(comm, &rank);
  std::string failure;
  if (rank == 0) {
    try {
      work();
    } catch (const std::exception& e) {
      failure = e.what();
      if (failure.empty()) failure = "unknown error";
    }
  }
  broadcast_text(comm, failure);
  if (!failure.empty()) throw OutputError(failure);
}

}  // namespace kerf
