// Brings records to the ranks that want them, where nobody knows who has them.
#pragma once

#include <algorithm>
#include <cstdint>
#include <vector>

#include "parallel/communicator.hpp"

namespace kerf {

/// What fetch_by_id() brings to this rank.
template <class Record>
struct Fetched {
  std::vector<Record> at_home;  // all records whose home is this rank, by id
  std::vector<Record> wanted;  // home by home; ids that nobody has are left out
};

/// By way of the home rank of each id, which is the id modulo the number of ranks. `share` are the records of this
/// rank; `Record` has a member `id`, which no two records have in common. Collective.
template <class Record>
Fetched<Record> fetch_by_id(MPI_Comm comm, const std::vector<Record>& share, const std::vector<std::int64_t>& wanted) {
  const auto n_ranks = static_cast<std::size_t>(size_of(comm));
  const auto home_of = [n_ranks](std::int64_t id) { return static_cast<std::size_t>(id) % n_ranks; };
  std::vector<std::vector<Record>> to_home(n_ranks), replies(n_ranks);
  for (const Record& r : share) to_home[home_of(r.id)].push_back(r);
  Fetched<Record> fetched;
  std::vector<Record>& mine = fetched.at_home;
  for (const auto& list : all_to_all(comm, to_home)) mine.insert(mine.end(), list.begin(), list.end());
  std::sort(mine.begin(), mine.end(), [](const Record& a, const Record& b) { return a.id < b.id; });
  std::vector<std::vector<std::int64_t>> requests(n_ranks);
  for (const std::int64_t id : wanted) requests[home_of(id)].push_back(id);
  const auto asked = all_to_all(comm, requests);
  for (std::size_t r = 0; r < n_ranks; ++r)
    for (const std::int64_t id : asked[r]) {
      const auto found = std::lower_bound(mine.begin(), mine.end(), id,
                                          [](const Record& a, std::int64_t value) { return a.id < value; });
      if (found != mine.end() && found->id == id) replies[r].push_back(*found);
    }
  for (const auto& list : all_to_all(comm, replies))
    fetched.wanted.insert(fetched.wanted.end(), list.begin(), list.end());
  return fetched;
}

}  // namespace kerf
