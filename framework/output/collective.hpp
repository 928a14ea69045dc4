// Work that one rank does and all ranks have to agree on.
#pragma once

#include <mpi.h>

#include <exception>
#include <stdexcept>
#include <string>

namespace kerf {

/// Replaces `text` on all ranks by that of rank 0. Collective.
inline void broadcast_text(MPI_Comm comm, std::string& text) {
  unsigned long long length = text.size();
  MPI_Bcast(&length, 1, MPI_UNSIGNED_LONG_LONG, 0, comm);
  text.resize(length);
  MPI_Bcast(text.data(), static_cast<int>(length), MPI_CHAR, 0, comm);
}

/// Runs `work` on rank 0. Post: if it threw there, every rank throws std::runtime_error with its message, so
/// that no rank is left waiting. Collective.
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
  if (!failure.empty()) throw std::runtime_error(failure);
}

}  // namespace kerf
