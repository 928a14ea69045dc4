// The candidate search against brute force over all slaves and facets: no pair missed, none that must not be there,
// and after changes of the surface the same as a search from scratch. Every rank runs it by itself.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <random>
#include <set>
#include <utility>

#include "contact/candidate_search.hpp"
#include "kerf/math.hpp"
#include "kerf/shape.hpp"
#include "model/surface.hpp"

namespace {

using namespace kerf;

using Pair = std::pair<std::int64_t, std::int64_t>;  // slave id, facet id

/// Blocks of hexahedra with displaced nodes, of which some elements are dead: a surface with all its neighbourhood.
class RandomSurface {
 public:
  /// `n`: cells along an edge of a block, up to 15.
  explicit RandomSurface(unsigned seed, int n = 4) : n_(n), random_(seed) {
    for (int part = 0; part < 3; ++part) add_block(part);
  }

  std::vector<ContactNodeRecord> slaves;
  std::vector<ContactFacetRecord> facets;

  double real(double low, double high) { return std::uniform_real_distribution<double>(low, high)(random_); }
  std::mt19937& random() { return random_; }

  /// Kills an element: its facets vanish, those that it covered appear, and nodes become slaves.
  void kill(std::int64_t element, std::vector<ContactFacetRecord>& opened, std::vector<ContactNodeRecord>& joined) {
    alive_.at(element) = false;
    std::erase_if(facets, [&](const ContactFacetRecord& f) { return f.id / 8 == element; });
    for (int face = 0; face < 6; ++face) {
      const auto other = neighbour(element, face);
      if (other.first < 0 || !alive_.at(other.first)) continue;
      facets.push_back(facet(other.first, other.second));
      opened.push_back(facets.back());
      for (int k = 0; k < 4; ++k)
        if (is_slave_.insert(facets.back().nodes[k]).second) {
          slaves.push_back(node(facets.back().nodes[k]));
          joined.push_back(slaves.back());
        }
    }
  }
  /// Moves one of the boxes of a slave, or both, and those of the facets round it, elsewhere.
  void displace(std::vector<ContactFacetRecord>& changed, std::vector<ContactNodeRecord>& strays) {
    ContactNodeRecord& slave = slaves[random_() % slaves.size()];
    const Vec3 to{real(0.0, 7.0), real(0.0, 7.0), real(0.0, 7.0)};
    const Box there = Box::spanned(to, to + way(), 0.1);
    const auto which = random_() % 3;
    if (which != 0) slave.box = there;
    if (which != 1) slave.own_box = there;
    nodes_[slave.id] = slave;
    strays.push_back(slave);
    for (ContactFacetRecord& f : facets) {
      if (std::find(f.nodes, f.nodes + 4, slave.id) == f.nodes + 4) continue;
      f.box.include(slave.box);
      f.own_box.include(slave.own_box);
      changed.push_back(f);
    }
  }
  std::size_t n_nodes() const { return nodes_.size(); }
  std::vector<std::int64_t> live_elements() const {
    std::vector<std::int64_t> ids;
    for (const auto& [id, live] : alive_)
      if (live) ids.push_back(id);
    return ids;
  }

 private:
  static constexpr int row = 16, layer = row * row, block = row * layer;  // in numbers of elements
  static std::int64_t node_id(int part, int i, int j, int k) { return element_id(part, i, j, k) * 1000003LL; }
  static std::int64_t element_id(int part, int i, int j, int k) {
    return std::int64_t{block} * part + layer * k + row * j + i;
  }

  void add_block(int part) {
    const Vec3 corner{real(0.0, 3.0), real(0.0, 3.0), real(0.0, 3.0)};
    for (int k = 0; k <= n_; ++k)
      for (int j = 0; j <= n_; ++j)
        for (int i = 0; i <= n_; ++i) {
          ContactNodeRecord r;
          r.id = node_id(part, i, j, k);
          r.body = part;
          const Vec3 x = corner + Vec3{i + real(-0.4, 0.4), j + real(-0.4, 0.4), k + real(-0.4, 0.4)};
          const Vec3 own = x + Vec3{0.3, 0.3, 0.3} * static_cast<double>(part);  // each part drifts in its own way
          r.box = Box::spanned(x, x + way(), std::pow(10.0, real(-3.0, -0.3)));
          r.own_box = Box::spanned(own, own + way(), std::pow(10.0, real(-3.0, -0.3)));
          r.local = static_cast<std::int32_t>(nodes_.size());
          r.role = static_cast<std::uint32_t>(1 + random_() % 3);
          nodes_[r.id] = r;
        }
    for (int k = 0; k < n_; ++k)
      for (int j = 0; j < n_; ++j)
        for (int i = 0; i < n_; ++i) {
          alive_[element_id(part, i, j, k)] = true;
          roles_[element_id(part, i, j, k)] = static_cast<std::uint32_t>(1 + random_() % 3);
        }
    for (int k = 0; k < n_; ++k)
      for (int j = 0; j < n_; ++j)
        for (int i = 0; i < n_; ++i)
          for (int face = 0; face < 6; ++face) {
            if (neighbour(element_id(part, i, j, k), face).first >= 0) continue;
            facets.push_back(facet(element_id(part, i, j, k), face));
            for (int k = 0; k < 4; ++k)
              if (is_slave_.insert(facets.back().nodes[k]).second) slaves.push_back(node(facets.back().nodes[k]));
          }
  }

  std::array<std::int64_t, 8> corners(std::int64_t e) const {
    const int i = e % row, j = e / row % row, k = e / layer % row, p = static_cast<int>(e / block);
    return {node_id(p, i, j, k),
            node_id(p, i + 1, j, k),
            node_id(p, i + 1, j + 1, k),
            node_id(p, i, j + 1, k),
            node_id(p, i, j, k + 1),
            node_id(p, i + 1, j, k + 1),
            node_id(p, i + 1, j + 1, k + 1),
            node_id(p, i, j + 1, k + 1)};
  }
  /// The element on the other side of a face and its number of that face; -1 where the block ends.
  std::pair<std::int64_t, int> neighbour(std::int64_t e, int face) const {
    static constexpr int step[6][3] = {{0, 0, -1}, {0, 0, 1}, {0, -1, 0}, {1, 0, 0}, {0, 1, 0}, {-1, 0, 0}};
    const int at[3] = {static_cast<int>(e % row), static_cast<int>(e / row % row), static_cast<int>(e / layer % row)};
    int to[3];
    for (int d = 0; d < 3; ++d) {
      to[d] = at[d] + step[face][d];
      if (to[d] < 0 || to[d] >= n_) return {-1, 0};
    }
    return {element_id(static_cast<int>(e / block), to[0], to[1], to[2]), hexahedron.opposite_face[face]};
  }
  const ContactNodeRecord& node(std::int64_t id) const { return nodes_.at(id); }
  /// How far a node sweeps: not at all, or up to half a cell.
  Vec3 way() { return random_() % 2 == 0 ? Vec3{} : Vec3{real(-0.5, 0.5), real(-0.5, 0.5), real(-0.5, 0.5)}; }

  ContactFacetRecord facet(std::int64_t element, int face) {
    ContactFacetRecord f;
    f.id = element * 8 + face;
    f.body = static_cast<std::int32_t>(element / block);
    f.role = roles_.at(element);
    const auto c = corners(element);
    const auto& far_side = hexahedron.face[hexahedron.opposite_face[face]];
    for (int k = 0; k < 8; ++k) {
      f.nodes[k] = c[k < 4 ? hexahedron.face[face][k] : far_side[k - 4]];
      f.locals[k] = node(f.nodes[k]).local;
    }
    for (int k = 0; k < 4; ++k) {
      f.box.include(node(f.nodes[k]).box);
      f.own_box.include(node(f.nodes[k]).own_box);
    }
    f.box.inflate(0.3 * scatter_of(f.id));
    f.own_box.inflate(0.3 * scatter_of(f.id));
    return f;
  }
  static double scatter_of(std::int64_t id) { return static_cast<double>(id * 2654435761LL % 1000) * 1e-3; }

  int n_;
  std::mt19937 random_;
  std::map<std::int64_t, ContactNodeRecord> nodes_;
  std::map<std::int64_t, bool> alive_;
  std::map<std::int64_t, std::uint32_t> roles_;
  std::set<std::int64_t> is_slave_;
};

bool meet(const ContactNodeRecord& s, const ContactFacetRecord& f) {
  const bool own = s.body == f.body;
  const Box &a = own ? s.own_box : s.box, &b = own ? f.own_box : f.box;
  for (int d = 0; d < 3; ++d)
    if (a.high[d] < b.low[d] || a.low[d] > b.high[d]) return false;
  return true;
}

/// All pairs by brute force, as CandidateSearch documents them.
std::set<Pair> all_pairs(const RandomSurface& surface, bool same_part) {
  std::map<std::int64_t, std::set<std::int64_t>> ring;
  for (const ContactNodeRecord& s : surface.slaves) ring[s.id] = {s.id};
  for (const ContactFacetRecord& f : surface.facets)
    for (int k = 0; k < 4; ++k) ring[f.nodes[k]].insert(f.nodes, f.nodes + 4);
  std::set<Pair> pairs;
  for (const ContactNodeRecord& s : surface.slaves)
    for (const ContactFacetRecord& f : surface.facets) {
      if ((s.role & f.role) == 0 || !meet(s, f)) continue;
      if (s.body == f.body) {
        if (!same_part) continue;
        const auto& near = ring[s.id];
        const auto touches = [&](std::int64_t id) { return near.count(id) != 0; };
        if (std::any_of(f.nodes, f.nodes + 8, touches)) continue;
      }
      pairs.insert({s.id, f.id});
    }
  return pairs;
}

std::set<Pair> pairs_of(const Candidates& c) {
  std::set<Pair> pairs;
  for (std::size_t s = 0; s < c.slave.size(); ++s)
    for (std::int32_t i = c.candidates[s].begin; i < c.candidates[s].end; ++i)
      pairs.insert({c.node_id[c.slave[s]], c.facet_id[c.candidate[i]]});
  return pairs;
}

void expect_complete(const RandomSurface& surface, const Candidates& found, bool same_part, const std::string& what) {
  const std::set<Pair> pairs = all_pairs(surface, same_part);
  EXPECT_TRUE(pairs_of(found) == pairs) << what;
  EXPECT_GT(pairs.size(), 100u);
}

/// Rows are sorted by facet id; what they refer to is what the records said.
void expect_well_formed(const RandomSurface& surface, const Candidates& c) {
  ASSERT_EQ(c.candidates.size(), c.slave.size());
  ASSERT_EQ(c.around_rows.size(), c.slave.size());
  EXPECT_EQ(std::set<std::int32_t>(c.slave.begin(), c.slave.end()).size(), c.slave.size());
  std::set<std::int32_t> referred;
  std::map<std::int64_t, const ContactFacetRecord*> facet;
  std::map<std::int64_t, std::set<std::int64_t>> around;
  for (const ContactFacetRecord& f : surface.facets) {
    facet[f.id] = &f;
    for (int k = 0; k < 4; ++k) around[f.nodes[k]].insert(f.id);
  }
  for (std::size_t s = 0; s < c.slave.size(); ++s) {
    const auto [begin, end] = c.candidates[s];
    ASSERT_LT(begin, end) << "a slave without candidates is listed";
    referred.insert(c.candidate.begin() + begin, c.candidate.begin() + end);
    const auto by_id = [&](std::int32_t a, std::int32_t b) { return c.facet_id[a] < c.facet_id[b]; };
    EXPECT_TRUE(std::is_sorted(c.candidate.begin() + begin, c.candidate.begin() + end, by_id));
    std::vector<std::int64_t> listed;
    for (std::int32_t i = c.around_rows[s].begin; i < c.around_rows[s].end; ++i) {
      listed.push_back(c.facet_id[c.around[i]]);
      referred.insert(c.around[i]);
    }
    EXPECT_TRUE(std::is_sorted(listed.begin(), listed.end()));
    const auto& expected = around[c.node_id[c.slave[s]]];
    EXPECT_TRUE(std::set<std::int64_t>(listed.begin(), listed.end()) == expected) << "node " << c.node_id[c.slave[s]];
  }
  for (const std::int32_t f : referred) {
    const auto it = facet.find(c.facet_id[f]);
    ASSERT_NE(it, facet.end()) << "facet " << c.facet_id[f] << " is gone";
    EXPECT_EQ(c.facet_body[f], it->second->body);
    for (int k = 0; k < 4; ++k) EXPECT_EQ(c.node_id[c.facet_nodes[4 * f + k]], it->second->nodes[k]);
  }
}

TEST(CandidateSearch, misses_no_pair) {
  for (unsigned seed = 0; seed < 12; ++seed)
    for (const bool same_part : {true, false}) {
      RandomSurface surface(seed);
      std::shuffle(surface.facets.begin(), surface.facets.end(), surface.random());
      for (const std::size_t n_local : {std::size_t{0}, surface.n_nodes()}) {
        const Candidates found = CandidateSearch(surface.slaves, surface.facets, same_part, n_local).candidates();
        expect_complete(surface, found, same_part, "seed " + std::to_string(seed));
        expect_well_formed(surface, found);
      }
    }
}

TEST(CandidateSearch, misses_no_pair_while_the_surface_changes) {
  for (unsigned seed = 20; seed < 26; ++seed)
    for (const bool same_part : {true, false}) {
      RandomSurface surface(seed);
      const std::size_t n_local = seed % 2 == 0 ? 0 : surface.n_nodes();
      CandidateSearch search(surface.slaves, surface.facets, same_part, n_local);
      for (int round = 0; round < 8; ++round) {
        std::vector<std::int64_t> live = surface.live_elements(), dead;
        std::vector<ContactFacetRecord> opened;
        std::vector<ContactNodeRecord> joined;
        std::shuffle(live.begin(), live.end(), surface.random());
        for (int k = 0; k < 1 + round; ++k) {
          dead.push_back(live[static_cast<std::size_t>(k)]);
          surface.kill(dead.back(), opened, joined);
        }
        // A face opened by one death may belong to the next one to die.
        std::erase_if(opened, [&](const ContactFacetRecord& f) {
          return std::find(dead.begin(), dead.end(), f.id / 8) != dead.end();
        });
        search.change(dead, opened, joined);
        const std::string what = "seed " + std::to_string(seed) + ", round " + std::to_string(round);
        expect_complete(surface, search.candidates(), same_part, what);
        expect_well_formed(surface, search.candidates());
        // Not only enough: the very pairs of a search from scratch.
        const Candidates fresh = CandidateSearch(surface.slaves, surface.facets, same_part, n_local).candidates();
        EXPECT_TRUE(pairs_of(search.candidates()) == pairs_of(fresh)) << what;
      }
    }
}

TEST(CandidateSearch, misses_no_pair_when_nodes_stray) {
  for (unsigned seed = 40; seed < 46; ++seed)
    for (const bool same_part : {true, false}) {
      RandomSurface surface(seed);
      const std::size_t n_local = seed % 2 == 0 ? 0 : surface.n_nodes();
      // Some facets are not known at first, as if they had been too far from this rank's slaves.
      std::vector<ContactFacetRecord> known;
      for (std::size_t f = 0; f < surface.facets.size(); ++f)
        if (f % 5 != 0) known.push_back(surface.facets[f]);
      CandidateSearch search(surface.slaves, known, same_part, n_local);
      std::vector<ContactFacetRecord> changed;
      std::vector<ContactNodeRecord> strays;
      for (std::size_t f = 0; f < surface.facets.size(); f += 5) changed.push_back(surface.facets[f]);
      for (int round = 0; round < 4; ++round) {
        for (int k = 0; k < 6; ++k) surface.displace(changed, strays);
        if (round % 2 == 0)
          search.refresh(changed, strays);
        else
          search.renew(changed, strays);
        const std::string what = "seed " + std::to_string(seed) + ", round " + std::to_string(round);
        const std::set<Pair> found = pairs_of(search.candidates()), needed = all_pairs(surface, same_part);
        EXPECT_TRUE(std::includes(found.begin(), found.end(), needed.begin(), needed.end())) << what;
        EXPECT_LT(found.size(), 3 * needed.size() + 1000) << what;
        expect_well_formed(surface, search.candidates());
        changed.clear();
        strays.clear();
      }
    }
}

TEST(CandidateSearch, misses_no_pair_when_nodes_stray_and_the_surface_changes) {
  for (unsigned seed = 100; seed < 112; ++seed)
    for (const bool same_part : {true, false}) {
      RandomSurface surface(seed);
      CandidateSearch search(surface.slaves, surface.facets, same_part, seed % 2 == 0 ? 0 : surface.n_nodes());
      for (int round = 0; round < 10; ++round) {
        const auto event = surface.random()() % 4;
        if (event < 2) {
          std::vector<ContactFacetRecord> changed;
          std::vector<ContactNodeRecord> strays;
          for (int k = 0; k < 5; ++k) surface.displace(changed, strays);
          if (event == 0)
            search.refresh(changed, strays);
          else
            search.renew(changed, strays);
        } else {
          std::vector<std::int64_t> live = surface.live_elements(), dead;
          std::vector<ContactFacetRecord> opened;
          std::vector<ContactNodeRecord> joined;
          std::shuffle(live.begin(), live.end(), surface.random());
          for (int k = 0; k < 3; ++k) {
            dead.push_back(live[static_cast<std::size_t>(k)]);
            surface.kill(dead.back(), opened, joined);
          }
          std::erase_if(opened, [&](const ContactFacetRecord& f) {
            return std::find(dead.begin(), dead.end(), f.id / 8) != dead.end();
          });
          search.change(dead, opened, joined);
        }
        const std::set<Pair> found = pairs_of(search.candidates()), needed = all_pairs(surface, same_part);
        ASSERT_TRUE(std::includes(found.begin(), found.end(), needed.begin(), needed.end()))
            << "seed " << seed << ", round " << round;
        expect_well_formed(surface, search.candidates());
      }
    }
}

TEST(CandidateSearch, a_facet_with_an_infinite_box_meets_every_slave_and_nothing_else) {
  for (const bool same_part : {true, false}) {
    RandomSurface surface(3);
    // A law's reach may have no bound; clusters of slaves have places that are empty.
    CandidateSearch search(surface.slaves, surface.facets, same_part, 0);
    search.candidates();
    std::vector<ContactFacetRecord> opened;
    std::vector<ContactNodeRecord> joined;
    const std::int64_t dead = surface.live_elements().front();
    surface.kill(dead, opened, joined);
    ASSERT_FALSE(opened.empty());
    for (ContactFacetRecord& f : surface.facets) {
      if (f.id != opened.front().id) continue;
      f.box.inflate(std::numeric_limits<double>::infinity());
      f.own_box.inflate(std::numeric_limits<double>::infinity());
      opened.front() = f;
    }
    search.change({dead}, opened, joined);
    EXPECT_TRUE(pairs_of(search.candidates()) == all_pairs(surface, same_part));
    expect_well_formed(surface, search.candidates());
  }
}

TEST(CandidateSearch, clusters_that_meet_very_many_facets_miss_none) {
  // All slaves reach everywhere: every cluster meets the facets of a whole part, which are more than it lists.
  RandomSurface surface(5, 10);
  for (ContactNodeRecord& s : surface.slaves)
    for (int d = 0; d < 3; ++d) {
      s.box.low[d] = s.own_box.low[d] = -100.0f;
      s.box.high[d] = s.own_box.high[d] = 100.0f;
    }
  EXPECT_GT(surface.facets.size(), 3u * 512u);
  CandidateSearch search(surface.slaves, surface.facets, true, 0);
  EXPECT_TRUE(pairs_of(search.candidates()) == all_pairs(surface, true));
}

TEST(CandidateSearch, finds_nothing_where_there_is_nothing) {
  const RandomSurface surface(1);
  EXPECT_TRUE(CandidateSearch({}, surface.facets, true, 0).candidates().slave.empty());
  EXPECT_TRUE(CandidateSearch(surface.slaves, {}, true, 0).candidates().slave.empty());
  EXPECT_TRUE(CandidateSearch({}, {}, true, 0).candidates().slave.empty());
}

}  // namespace
