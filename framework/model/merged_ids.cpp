// The grid that finds nodes at one place, and the spread of the lowest id over all that are merged.
#include "model/merged_ids.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <tuple>

#include "core/assert.hpp"
#include "parallel/communicator.hpp"

namespace kerf {

namespace {

using Cube = std::array<std::int64_t, 3>;

/// A node as it is seen by one of the cubes that it is in or close to.
struct Placed {
  Cube cube{};
  JointNode node;
};

Cube cube_of(Vec3 x, double edge) {
  Cube c{};
  for (int d = 0; d < 3; ++d) c[static_cast<std::size_t>(d)] = static_cast<std::int64_t>(std::floor(x[d] / edge));
  return c;
}

int rank_of_cube(const Cube& c, int n_ranks) {
  std::uint64_t hash = 0;
  for (const std::int64_t k : c) hash = (hash ^ static_cast<std::uint64_t>(k)) * 0x9e3779b97f4a7c15ULL;
  return static_cast<int>((hash >> 33) % static_cast<std::uint64_t>(n_ranks));
}

/// Calls `visit` with all cubes that the box of half the edge `tolerance` round a point reaches: eight at most.
template <class Visit>
void each_cube_near(Vec3 x, double tolerance, double edge, const Visit& visit) {
  const Vec3 margin{tolerance, tolerance, tolerance};
  const Cube low = cube_of(x - margin, edge), high = cube_of(x + margin, edge);
  Cube c{};
  for (c[0] = low[0]; c[0] <= high[0]; ++c[0])
    for (c[1] = low[1]; c[1] <= high[1]; ++c[1])
      for (c[2] = low[2]; c[2] <= high[2]; ++c[2]) visit(c);
}

bool operator<(const Placed& a, const Placed& b) { return std::tie(a.cube, a.node.id) < std::tie(b.cube, b.node.id); }
bool is_same(const Placed& a, const Placed& b) { return a.cube == b.cube && a.node.id == b.node.id; }

/// Appends the pairs among the nodes of one cube.
void find_pairs(const Placed* first, const Placed* last, double tolerance, std::vector<IdPair>& pairs) {
  for (const Placed* a = first; a != last; ++a)
    for (const Placed* b = a + 1; b != last; ++b) {
      const Vec3 d = a->node.position - b->node.position;
      if (a->node.part != b->node.part && dot(d, d) <= tolerance * tolerance)
        pairs.push_back({a->node.id, b->node.id, a->node.part, b->node.part});
    }
}

}  // namespace

std::vector<IdPair> coincident_nodes(MPI_Comm comm, const std::vector<JointNode>& nodes, double tolerance,
                                     double cube) {
  KERF_ASSERT(cube > 2.0 * tolerance, "a node is close to eight cubes at most");
  const int n_ranks = size_of(comm);
  std::vector<std::vector<Placed>> outgoing(static_cast<std::size_t>(n_ranks));
  for (const JointNode& node : nodes)
    each_cube_near(node.position, tolerance, cube, [&](const Cube& c) {
      outgoing[static_cast<std::size_t>(rank_of_cube(c, n_ranks))].push_back({c, node});
    });
  std::vector<Placed> placed;
  for (const auto& list : all_to_all(comm, outgoing)) placed.insert(placed.end(), list.begin(), list.end());
  std::sort(placed.begin(), placed.end());
  placed.erase(std::unique(placed.begin(), placed.end(), is_same), placed.end());
  std::vector<IdPair> pairs;
  for (std::size_t i = 0; i < placed.size();) {
    std::size_t end = i;
    while (end < placed.size() && placed[end].cube == placed[i].cube) ++end;
    find_pairs(placed.data() + i, placed.data() + end, tolerance, pairs);
    i = end;
  }
  return pairs;
}

MergedIds::MergedIds(MPI_Comm comm, std::int64_t n_ids, const std::vector<IdPair>& pairs) {
  const int n_ranks = size_of(comm);
  block_ = std::max((n_ids + n_ranks - 1) / n_ranks, std::int64_t{1});
  /// One side of a pair, at the home of `id`.
  struct Link {
    std::int64_t id, other;
    auto operator<=>(const Link&) const = default;
  };
  std::vector<std::vector<Link>> outgoing(static_cast<std::size_t>(n_ranks));
  for (const IdPair& p : pairs) {
    outgoing[static_cast<std::size_t>(home_of(p.low))].push_back({p.low, p.high});
    outgoing[static_cast<std::size_t>(home_of(p.high))].push_back({p.high, p.low});
  }
  std::vector<Link> links;
  for (const auto& list : all_to_all(comm, outgoing)) links.insert(links.end(), list.begin(), list.end());
  std::sort(links.begin(), links.end());
  links.erase(std::unique(links.begin(), links.end()), links.end());
  // Each id learns the lowest one of its neighbours until nobody learns anything new.
  for (const Link& l : links)
    if (merged_.empty() || merged_.back().id != l.id) merged_.push_back({l.id, l.id});
  const auto entry = [&](std::int64_t id) {
    return std::lower_bound(merged_.begin(), merged_.end(), id,
                            [](const Merged& m, std::int64_t wanted) { return m.id < wanted; });
  };
  for (bool changed = true; changed;) {
    std::vector<std::vector<Link>> told(static_cast<std::size_t>(n_ranks));
    for (const Link& l : links)
      told[static_cast<std::size_t>(home_of(l.other))].push_back({l.other, entry(l.id)->survivor});
    std::int64_t n_changes = 0;
    for (const auto& list : all_to_all(comm, told))
      for (const Link& l : list) {
        const auto at = entry(l.id);
        if (l.other >= at->survivor) continue;
        at->survivor = l.other;
        ++n_changes;
      }
    changed = sum_of(comm, n_changes) > 0;
  }
  std::erase_if(merged_, [](const Merged& m) { return m.id == m.survivor; });
  const auto n_here = static_cast<std::int64_t>(merged_.size());
  n_merged_ = sum_of(comm, n_here);
  std::int64_t up_to_here = 0;
  MPI_Scan(&n_here, &up_to_here, 1, MPI_INT64_T, MPI_SUM, comm);
  n_before_ = up_to_here - n_here;
  // The new ids of survivors, asked of their homes. Until then the new numbers of merged ids are not known.
  std::vector<std::int64_t> survivors, numbers;
  for (const Merged& m : merged_) survivors.push_back(m.survivor);
  numbers = resolve(comm, survivors);
  number_ = std::move(numbers);
}

/// The new id of an old one of this rank's block.
std::int64_t MergedIds::number_of(std::int64_t id) const {
  const auto at = std::lower_bound(merged_.begin(), merged_.end(), id,
                                   [](const Merged& m, std::int64_t wanted) { return m.id < wanted; });
  if (at != merged_.end() && at->id == id) return number_[static_cast<std::size_t>(at - merged_.begin())];
  return id - n_before_ - (at - merged_.begin());
}

std::vector<std::int64_t> MergedIds::resolve(MPI_Comm comm, const std::vector<std::int64_t>& ids) const {
  if (empty()) return ids;
  const auto n_ranks = static_cast<std::size_t>(size_of(comm));
  std::vector<std::vector<std::int64_t>> questions(n_ranks), answers(n_ranks);
  for (const std::int64_t id : ids) questions[static_cast<std::size_t>(home_of(id))].push_back(id);
  const auto asked = all_to_all(comm, questions);
  for (std::size_t r = 0; r < n_ranks; ++r)
    for (const std::int64_t id : asked[r]) answers[r].push_back(number_of(id));
  const auto replies = all_to_all(comm, answers);
  std::vector<std::size_t> next(n_ranks, 0);
  std::vector<std::int64_t> numbers;
  numbers.reserve(ids.size());
  for (const std::int64_t id : ids) {
    const auto home = static_cast<std::size_t>(home_of(id));
    numbers.push_back(replies[home][next[home]++]);
  }
  return numbers;
}

std::vector<std::int64_t> MergedIds::all_merged(MPI_Comm comm) const {
  std::vector<std::int64_t> here, all;
  for (const Merged& m : merged_) here.push_back(m.id);
  // Blocks of ids follow one another in the order of the ranks.
  for (const auto& list : all_to_all(comm, std::vector(static_cast<std::size_t>(size_of(comm)), here)))
    all.insert(all.end(), list.begin(), list.end());
  return all;
}

std::vector<std::int64_t> MergedIds::n_survivors_below(MPI_Comm comm, const std::vector<std::int64_t>& ids) const {
  std::vector<std::int64_t> n_merged_below;
  for (const std::int64_t id : ids) {
    const auto at = std::lower_bound(merged_.begin(), merged_.end(), id,
                                     [](const Merged& m, std::int64_t wanted) { return m.id < wanted; });
    n_merged_below.push_back(at - merged_.begin());
  }
  MPI_Allreduce(MPI_IN_PLACE, n_merged_below.data(), static_cast<int>(n_merged_below.size()), MPI_INT64_T, MPI_SUM,
                comm);
  std::vector<std::int64_t> below;
  for (std::size_t k = 0; k < ids.size(); ++k) below.push_back(ids[k] - n_merged_below[k]);
  return below;
}

}  // namespace kerf
