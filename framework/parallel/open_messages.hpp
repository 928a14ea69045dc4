// Messages whose length the receiver does not know, between ranks that expect them of each other.
#pragma once

#include <mpi.h>

#include <cstdint>
#include <vector>

namespace kerf {

class OpenMessages {
 public:
  OpenMessages(MPI_Comm comm, int tag) : comm_(comm), tag_(tag) {}
  /// `words` must live until finish().
  void send(int rank, const std::vector<std::int64_t>& words);
  /// Waits for the message of a rank.
  std::vector<std::int64_t> receive(int rank);
  /// Waits until all that was sent has gone out.
  void finish();

 private:
  MPI_Comm comm_;
  int tag_;
  std::vector<MPI_Request> sends_;
};

}  // namespace kerf
