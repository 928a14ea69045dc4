// Agrees on an owner for every item that several ranks hold, and matches items that two ranks hold one side of.
#pragma once

#include <mpi.h>

#include <array>
#include <cstdint>
#include <vector>

namespace kerf {

struct Ownership {
  std::vector<int> owner;  // rank, per id
};

/// Collective. One of the holders becomes the owner of each id; ids are unique per rank.
Ownership agree_on_owners(MPI_Comm comm, const std::vector<std::int64_t>& ids);

/// A face of a local element whose neighbour may live on another rank, keyed by its sorted node ids.
struct OpenFace {
  std::array<std::int64_t, 4> nodes{};
  std::int64_t element = -1;  // global id
};
struct Neighbour {
  std::int64_t element = -1;  // -1 where nobody has the other side
  int rank = -1;
};
/// Collective. Returns, per face, the element on its other side.
std::vector<Neighbour> match_faces(MPI_Comm comm, const std::vector<OpenFace>& faces);

}  // namespace kerf
