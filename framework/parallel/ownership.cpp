// Rendezvous: every id has a home rank, computed from the id, where its holders meet.
#include "parallel/ownership.hpp"

#include <algorithm>

#include "parallel/communicator.hpp"

namespace kerf {

namespace {

struct Claim {
  std::int64_t id;
  int rank, index;
};

}  // namespace

Ownership agree_on_owners(MPI_Comm comm, const std::vector<std::int64_t>& ids) {
  const int n_ranks = size_of(comm), here = rank_of(comm);
  Ownership result{std::vector<int>(ids.size(), here)};
  if (n_ranks == 1) return result;
  std::vector<std::vector<std::int64_t>> outgoing(n_ranks);
  std::vector<std::vector<std::size_t>> positions(n_ranks);
  for (std::size_t i = 0; i < ids.size(); ++i) {
    const int home = static_cast<int>(ids[i] % n_ranks);
    outgoing[home].push_back(ids[i]);
    positions[home].push_back(i);
  }
  const auto incoming = all_to_all(comm, outgoing);
  std::vector<Claim> claims;
  for (int r = 0; r < n_ranks; ++r)
    for (std::size_t i = 0; i < incoming[r].size(); ++i) claims.push_back({incoming[r][i], r, static_cast<int>(i)});
  std::sort(claims.begin(), claims.end(),
            [](const Claim& a, const Claim& b) { return a.id != b.id ? a.id < b.id : a.rank < b.rank; });
  std::vector<std::vector<int>> owners(n_ranks);
  for (int r = 0; r < n_ranks; ++r) owners[r].resize(incoming[r].size());
  for (std::size_t i = 0; i < claims.size();) {
    std::size_t end = i;
    while (end < claims.size() && claims[end].id == claims[i].id) ++end;
    // Spread ownership over the holders so that no rank owns all of an interface.
    const std::size_t pick = i + static_cast<std::size_t>(claims[i].id / n_ranks) % (end - i);
    for (std::size_t k = i; k < end; ++k) owners[claims[k].rank][claims[k].index] = claims[pick].rank;
    i = end;
  }
  const auto replies = all_to_all(comm, owners);
  for (int home = 0; home < n_ranks; ++home)
    for (std::size_t i = 0; i < replies[home].size(); ++i) result.owner[positions[home][i]] = replies[home][i];
  return result;
}

std::vector<Neighbour> match_faces(MPI_Comm comm, const std::vector<OpenFace>& faces) {
  const int n_ranks = size_of(comm);
  std::vector<Neighbour> result(faces.size());
  if (n_ranks == 1) return result;
  std::vector<std::vector<OpenFace>> outgoing(n_ranks);
  std::vector<std::vector<std::size_t>> positions(n_ranks);
  for (std::size_t i = 0; i < faces.size(); ++i) {
    const int home = static_cast<int>(faces[i].nodes[0] % n_ranks);
    outgoing[home].push_back(faces[i]);
    positions[home].push_back(i);
  }
  const auto incoming = all_to_all(comm, outgoing);
  struct Side {
    OpenFace face;
    int rank, index;
  };
  std::vector<Side> sides;
  for (int r = 0; r < n_ranks; ++r)
    for (std::size_t i = 0; i < incoming[r].size(); ++i) sides.push_back({incoming[r][i], r, static_cast<int>(i)});
  std::sort(sides.begin(), sides.end(), [](const Side& a, const Side& b) { return a.face.nodes < b.face.nodes; });
  std::vector<std::vector<Neighbour>> answers(n_ranks);
  for (int r = 0; r < n_ranks; ++r) answers[r].resize(incoming[r].size());
  for (std::size_t i = 0; i + 1 < sides.size(); ++i) {
    if (sides[i].face.nodes != sides[i + 1].face.nodes) continue;
    answers[sides[i].rank][sides[i].index] = {sides[i + 1].face.element, sides[i + 1].rank};
    answers[sides[i + 1].rank][sides[i + 1].index] = {sides[i].face.element, sides[i].rank};
    ++i;
  }
  const auto replies = all_to_all(comm, answers);
  for (int home = 0; home < n_ranks; ++home)
    for (std::size_t i = 0; i < replies[home].size(); ++i) result[positions[home][i]] = replies[home][i];
  return result;
}

}  // namespace kerf
