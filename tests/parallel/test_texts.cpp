// Requirement: all ranks get the whole text of rank 0, in however many messages it goes.
#include <gtest/gtest.h>

#include <limits>

#include "parallel/communicator.hpp"

namespace {

using namespace kerf;

TEST(Broadcast, is_whole_in_pieces_of_any_size) {
  const int here = rank_of(MPI_COMM_WORLD);
  for (const std::size_t length : {0u, 1u, 6u, 7u, 8u, 14u, 1000u}) {
    std::string text;
    for (std::size_t i = 0; i < length; ++i) text += static_cast<char>(i * 37 % 251);
    for (const std::size_t piece : {std::size_t{1}, std::size_t{7}, std::size_t{1000}, largest_piece})
      EXPECT_EQ(broadcast(MPI_COMM_WORLD, here == 0 ? text : "another", piece), text) << length << " " << piece;
  }
}

TEST(Broadcast, sends_no_message_longer_than_mpi_can_count) {
  EXPECT_LE(largest_piece, static_cast<std::size_t>(std::numeric_limits<int>::max()));
}

}  // namespace
