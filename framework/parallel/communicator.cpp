// Collective handling of texts.
#include "parallel/communicator.hpp"

#include <algorithm>

namespace kerf {

namespace {

std::string broadcast_from(MPI_Comm comm, std::string text, int root, std::size_t piece) {
  std::int64_t n = static_cast<std::int64_t>(text.size());
  MPI_Bcast(&n, 1, MPI_INT64_T, root, comm);
  text.resize(static_cast<std::size_t>(n));
  for (std::size_t done = 0; done < text.size(); done += piece)
    MPI_Bcast(text.data() + done, static_cast<int>(std::min(piece, text.size() - done)), MPI_CHAR, root, comm);
  return text;
}

}  // namespace

std::string broadcast(MPI_Comm comm, std::string text, std::size_t piece) {
  return broadcast_from(comm, std::move(text), 0, piece);
}

std::string first_text(MPI_Comm comm, const std::string& text) {
  const int n = size_of(comm);
  int root = text.empty() ? n : rank_of(comm);
  MPI_Allreduce(MPI_IN_PLACE, &root, 1, MPI_INT, MPI_MIN, comm);
  return root == n ? std::string{} : broadcast_from(comm, text, root, largest_piece);
}

}  // namespace kerf
