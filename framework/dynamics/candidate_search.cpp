// Pairs of slaves and facets whose boxes meet, and how they change as the surface does.
#include "dynamics/candidate_search.hpp"

#include <algorithm>
#include <array>
#include <span>
#include <unordered_map>

#include "dynamics/facet_tree.hpp"

namespace kerf {

namespace {

/// Dense numbers of nodes. Where the records come from one rank alone, their local numbers serve; otherwise an
/// open-addressing map numbers ids, which are not negative, in order of arrival.
class Numbering {
 public:
  Numbering(std::size_t expected, std::size_t n_local) : n_local_(static_cast<std::int32_t>(n_local)) {
    if (n_local == 0) resize(expected);
  }
  std::int32_t number(std::int64_t id, std::int32_t local) {
    if (n_local_ > 0) return local;
    if (2 * static_cast<std::size_t>(n_) >= keys_.size()) resize(2 * static_cast<std::size_t>(n_));
    const std::size_t at = slot(id);
    if (keys_[at] != id) {
      keys_[at] = id;
      values_[at] = n_++;
    }
    return values_[at];
  }
  std::size_t size() const { return static_cast<std::size_t>(n_local_ > 0 ? n_local_ : n_); }

 private:
  void resize(std::size_t expected) {
    std::size_t size = 16;
    while (size < 3 * expected) size *= 2;
    std::vector<std::int64_t> keys(size, -1);
    std::vector<std::int32_t> values(size, -1);
    keys.swap(keys_);
    values.swap(values_);
    for (std::size_t i = 0; i < keys.size(); ++i)
      if (keys[i] >= 0) {
        const std::size_t at = slot(keys[i]);
        keys_[at] = keys[i];
        values_[at] = values[i];
      }
  }
  std::size_t slot(std::int64_t id) const {
    const std::size_t mask = keys_.size() - 1;
    std::size_t at = static_cast<std::size_t>(static_cast<std::uint64_t>(id) * 0x9e3779b97f4a7c15ULL >> 20) & mask;
    while (keys_[at] != -1 && keys_[at] != id) at = (at + 1) & mask;
    return at;
  }
  std::int32_t n_local_ = 0, n_ = 0;
  std::vector<std::int64_t> keys_;
  std::vector<std::int32_t> values_;
};

/// Node numbers of a facet's corners, then of the other four nodes of its element.
using Corners = std::array<std::int32_t, 8>;

/// Facets around every node of the surface, as they come and go.
class Around {
 public:
  void build(const std::vector<Corners>& corners, std::size_t n_nodes) {
    first_.assign(n_nodes + 1, 0);
    for (const Corners& c : corners)
      for (int k = 0; k < 4; ++k) ++first_[c[k] + 1];
    for (std::size_t n = 0; n < n_nodes; ++n) first_[n + 1] += first_[n];
    facet_.resize(4 * corners.size());
    std::vector<std::int32_t> next(first_.begin(), first_.end() - 1);
    for (std::size_t f = 0; f < corners.size(); ++f)
      for (int k = 0; k < 4; ++k) facet_[next[corners[f][k]]++] = static_cast<std::int32_t>(f);
  }
  std::span<const std::int32_t> of(std::int32_t node) const {
    if (!changed_.empty()) {
      const auto it = changed_.find(node);
      if (it != changed_.end()) return it->second;
    }
    if (node + 1 >= static_cast<std::int32_t>(first_.size())) return {};
    return {facet_.data() + first_[node], static_cast<std::size_t>(first_[node + 1] - first_[node])};
  }
  void add(std::int32_t node, std::int32_t facet) { list(node).push_back(facet); }
  void remove(std::int32_t node, std::int32_t facet) { std::erase(list(node), facet); }

 private:
  std::vector<std::int32_t>& list(std::int32_t node) {
    const auto it = changed_.find(node);
    if (it != changed_.end()) return it->second;
    const auto now = of(node);
    return changed_[node] = std::vector<std::int32_t>(now.begin(), now.end());
  }
  std::vector<std::int32_t> first_, facet_;
  std::unordered_map<std::int32_t, std::vector<std::int32_t>> changed_;
};

/// Turns the found pairs into compact lists of only what they refer to.
class Compactor {
 public:
  Compactor(const std::vector<ContactFacetRecord>& facets, std::size_t n_numbers, std::size_t n_facets)
      : facets_(facets), node_(n_numbers, -1), facet_(n_facets, -1) {
    out.first_candidate.push_back(0);
    out.first_around.push_back(0);
  }
  std::int32_t node(std::int32_t number, std::int64_t id, std::int32_t owner, std::int32_t local, std::int32_t part) {
    if (node_[number] < 0) {
      node_[number] = static_cast<std::int32_t>(out.node_id.size());
      out.node_id.push_back(id);
      out.node_owner.push_back(owner);
      out.node_local.push_back(local);
      out.node_part.push_back(part);
    }
    return node_[number];
  }
  std::int32_t facet(std::int32_t f, const std::vector<Corners>& corners) {
    if (facet_[f] < 0) {
      facet_[f] = static_cast<std::int32_t>(out.facet_id.size());
      const ContactFacetRecord& r = facets_[f];
      out.facet_id.push_back(r.id);
      out.facet_part.push_back(r.part);
      out.facet_bulk_modulus.push_back(r.bulk_modulus);
      out.facet_volume.push_back(r.volume);
      for (int k = 0; k < 4; ++k)
        out.facet_nodes.push_back(node(corners[f][k], r.nodes[k], r.owners[k], r.locals[k], r.part));
    }
    return facet_[f];
  }
  Candidates out;

 private:
  const std::vector<ContactFacetRecord>& facets_;
  std::vector<std::int32_t> node_, facet_;
};

/// The facets of one part, for slaves of other parts and for its own.
struct PartFacets {
  std::vector<std::int32_t> facet;  // in the order of the trees
  FacetTree others, own;
};

/// Consecutive slaves of one part, which are neighbours as a rule: most facets are far from all of them.
struct SlaveCluster {
  static constexpr std::size_t size = 16;
  Box box, own_box;
  std::vector<std::int32_t> slaves;
};

}  // namespace

struct CandidateSearch::Tables {
  std::vector<ContactNodeRecord> slaves;
  std::vector<ContactFacetRecord> facets;
  bool same_part;
  Numbering numbering;
  std::vector<Corners> corners;
  std::vector<std::int32_t> number;  // node number of each slave
  std::vector<std::int32_t> slave_of;  // per node number: the slave, or -1
  std::vector<std::uint32_t> role;  // per facet; 0 of those that are gone
  Around around;
  std::vector<PartFacets> parts;
  std::vector<SlaveCluster> clusters;
  std::vector<std::int32_t> open_cluster;  // per part: the one that has room for another slave, or -1
  std::vector<std::vector<std::int32_t>> found;  // per slave: facets, sorted by id; dead ones are left in
  std::vector<std::int32_t> ring;  // per node number: the last mark set on it
  std::int32_t mark = 0;
  std::size_t n_first = 0;  // facets of the search; the others came later

  Tables(std::vector<ContactNodeRecord> s, std::vector<ContactFacetRecord> f, bool same, std::size_t n_local)
      : slaves(std::move(s)),
        facets(std::move(f)),
        same_part(same),
        numbering(slaves.size() + 2 * facets.size(), n_local) {
    corners.reserve(facets.size());
    for (const ContactFacetRecord& facet : facets) corners.push_back(corners_of(facet));
    number.reserve(slaves.size());
    for (std::size_t i = 0; i < slaves.size(); ++i) join(static_cast<std::int32_t>(i));
    for (const ContactFacetRecord& facet : facets) role.push_back(facet.role);
    around.build(corners, numbering.size());
    n_first = facets.size();
    plant_trees();
    std::vector<std::size_t> groups;
    for (const SlaveCluster& cluster : clusters) find_all(cluster, groups);
  }

  void plant_trees() {
    for (std::size_t f = 0; f < facets.size(); ++f) {
      const auto part = static_cast<std::size_t>(facets[f].part);
      if (part >= parts.size()) parts.resize(part + 1);
      parts[part].facet.push_back(static_cast<std::int32_t>(f));
      parts[part].others.add(facets[f].box);
      if (same_part) parts[part].own.add(facets[f].own_box);
    }
    for (PartFacets& p : parts) {
      p.others.finish();
      p.own.finish();
    }
  }
  Corners corners_of(const ContactFacetRecord& facet) {
    Corners c;
    for (int k = 0; k < 8; ++k) c[k] = numbering.number(facet.nodes[k], facet.locals[k]);
    return c;
  }
  void join(std::int32_t s) {
    const ContactNodeRecord& slave = slaves[s];
    number.push_back(numbering.number(slave.id, slave.local));
    resize();
    slave_of[number[s]] = s;
    const auto part = static_cast<std::size_t>(slave.part);
    if (part >= open_cluster.size()) open_cluster.resize(part + 1, -1);
    if (open_cluster[part] < 0 || clusters[open_cluster[part]].slaves.size() == SlaveCluster::size) {
      open_cluster[part] = static_cast<std::int32_t>(clusters.size());
      clusters.emplace_back().slaves.reserve(SlaveCluster::size);
    }
    SlaveCluster& cluster = clusters[open_cluster[part]];
    cluster.slaves.push_back(s);
    cluster.box.include(slave.box);
    cluster.own_box.include(slave.own_box);
  }
  void resize() {
    ring.resize(numbering.size(), 0);
    slave_of.resize(numbering.size(), -1);
    found.resize(slaves.size());
  }
  /// Marks the nodes of the facets around a slave.
  void mark_ring(std::size_t s) {
    ++mark;
    ring[number[s]] = mark;
    for (const std::int32_t f : around.of(number[s]))
      for (int k = 0; k < 4; ++k) ring[corners[f][k]] = mark;
  }
  /// Whether a facet's element has a node of the marked ring.
  bool touches_ring(std::int32_t f) const {
    const Corners& c = corners[f];
    return std::any_of(c.begin(), c.end(), [&](std::int32_t n) { return ring[n] == mark; });
  }
  void sort_by_id(std::vector<std::int32_t>& list) const {
    std::sort(list.begin(), list.end(), [&](std::int32_t a, std::int32_t b) { return facets[a].id < facets[b].id; });
    list.erase(std::unique(list.begin(), list.end()), list.end());
  }
  /// Takes a facet whose box a slave meets, if they make a pair.
  void meet(std::size_t s, std::int32_t f, bool own, bool& marked) {
    if ((role[f] & slaves[s].role) == 0) return;
    if (own) {
      if (!marked) mark_ring(s);
      marked = true;
      if (touches_ring(f)) return;
    }
    found[s].push_back(f);
  }
  /// Pairs of a cluster of slaves with the facets of the search.
  void find_all(const SlaveCluster& cluster, std::vector<std::size_t>& groups) {
    const std::int32_t part = slaves[cluster.slaves.front()].part;
    for (std::size_t p = 0; p < parts.size(); ++p) {
      const bool own = static_cast<std::int32_t>(p) == part;
      const FacetTree& tree = own ? parts[p].own : parts[p].others;
      groups.clear();
      tree.each_group(own ? cluster.own_box : cluster.box, [&](std::size_t g) { groups.push_back(g); });
      if (groups.empty()) continue;
      for (const std::int32_t s : cluster.slaves) {
        bool marked = false;
        for (const std::size_t g : groups)
          tree.each_in(g, own ? slaves[s].own_box : slaves[s].box,
                       [&](std::size_t k) { meet(static_cast<std::size_t>(s), parts[p].facet[k], own, marked); });
      }
    }
    for (const std::int32_t s : cluster.slaves)
      if (found[s].size() > 1) sort_by_id(found[s]);
  }
  /// Pairs of a slave with all facets that there are now.
  void find(std::size_t s) {
    found[s].clear();
    bool marked = false;
    for (std::size_t p = 0; p < parts.size(); ++p) {
      const bool own = static_cast<std::int32_t>(p) == slaves[s].part;
      const FacetTree& tree = own ? parts[p].own : parts[p].others;
      tree.each(own ? slaves[s].own_box : slaves[s].box,
                [&](std::size_t k) { meet(s, parts[p].facet[k], own, marked); });
    }
    find_late(s, n_first, marked);
    sort_by_id(found[s]);
  }
  /// Pairs of a slave with the facets from number `first` on, which came after the search.
  void find_late(std::size_t s, std::size_t first, bool& marked) {
    for (std::size_t f = first; f < facets.size(); ++f) {
      const bool own = facets[f].part == slaves[s].part;
      if (own ? same_part && facets[f].own_box.meets(slaves[s].own_box) : facets[f].box.meets(slaves[s].box))
        meet(s, static_cast<std::int32_t>(f), own, marked);
    }
  }
  /// Pairs of all slaves with the facets from number `first` on.
  void find_new(std::size_t first) {
    for (const SlaveCluster& cluster : clusters) {
      const bool far = std::none_of(
          facets.begin() + static_cast<std::ptrdiff_t>(first), facets.end(),
          [&](const ContactFacetRecord& f) { return cluster.box.meets(f.box) || cluster.own_box.meets(f.own_box); });
      if (far) continue;
      for (const std::int32_t s : cluster.slaves) {
        const std::size_t before = found[s].size();
        bool marked = false;
        find_late(static_cast<std::size_t>(s), first, marked);
        if (found[s].size() != before) sort_by_id(found[s]);
      }
    }
  }
  /// Takes out the facets of some elements; their corners are added to `affected`.
  void kill(const std::vector<std::int64_t>& elements, std::vector<std::int32_t>& affected) {
    std::vector<std::int64_t> dead = elements;
    std::sort(dead.begin(), dead.end());
    // Most facets are none of theirs, which a few bits of their ids tell.
    constexpr std::int64_t few = 4096;
    std::vector<char> maybe(few, 0);
    for (const std::int64_t id : dead) maybe[static_cast<std::size_t>(id % few)] = 1;
    for (std::size_t f = 0; f < facets.size(); ++f) {
      const std::int64_t element = facets[f].id / 8;
      if (maybe[static_cast<std::size_t>(element % few)] == 0 || role[f] == 0) continue;
      if (!std::binary_search(dead.begin(), dead.end(), element)) continue;
      role[f] = 0;
      for (int k = 0; k < 4; ++k) {
        around.remove(corners[f][k], static_cast<std::int32_t>(f));
        affected.push_back(corners[f][k]);
      }
    }
  }
  void add(const ContactFacetRecord& facet, std::vector<std::int32_t>& affected) {
    const auto f = static_cast<std::int32_t>(facets.size());
    facets.push_back(facet);
    role.push_back(facet.role);
    corners.push_back(corners_of(facet));
    for (int k = 0; k < 4; ++k) {
      around.add(corners[f][k], f);
      affected.push_back(corners[f][k]);
    }
  }
};

CandidateSearch::CandidateSearch(std::vector<ContactNodeRecord> slaves, std::vector<ContactFacetRecord> facets,
                                 bool same_part, std::size_t n_local)
    : tables_(std::make_unique<Tables>(std::move(slaves), std::move(facets), same_part, n_local)) {}

CandidateSearch::~CandidateSearch() = default;

void CandidateSearch::change(const std::vector<std::int64_t>& dead_elements,
                             const std::vector<ContactFacetRecord>& new_facets,
                             const std::vector<ContactNodeRecord>& new_slaves) {
  Tables& t = *tables_;
  std::vector<std::int32_t> affected;  // nodes whose surroundings changed
  t.kill(dead_elements, affected);
  const std::size_t first_new = t.facets.size();
  const auto n_old = static_cast<std::int32_t>(t.slaves.size());
  for (const ContactFacetRecord& facet : new_facets) t.add(facet, affected);
  t.resize();
  t.find_new(first_new);
  t.slaves.insert(t.slaves.end(), new_slaves.begin(), new_slaves.end());
  for (auto s = n_old; s < static_cast<std::int32_t>(t.slaves.size()); ++s) {
    t.join(s);
    t.find(static_cast<std::size_t>(s));
  }
  std::sort(affected.begin(), affected.end());
  affected.erase(std::unique(affected.begin(), affected.end()), affected.end());
  for (const std::int32_t n : affected)
    if (t.slave_of[n] >= 0 && t.slave_of[n] < n_old) t.find(static_cast<std::size_t>(t.slave_of[n]));
}

Candidates CandidateSearch::candidates() const {
  const Tables& t = *tables_;
  Compactor compact(t.facets, t.numbering.size(), t.facets.size());
  std::vector<std::int32_t> around;
  for (std::size_t s = 0; s < t.slaves.size(); ++s) {
    if (t.found[s].empty()) continue;
    Candidates& out = compact.out;
    const std::size_t before = out.candidate.size();
    for (const std::int32_t f : t.found[s])
      if (t.role[f] != 0) out.candidate.push_back(compact.facet(f, t.corners));
    if (out.candidate.size() == before) continue;
    const ContactNodeRecord& slave = t.slaves[s];
    out.slave.push_back(compact.node(t.number[s], slave.id, slave.owner, slave.local, slave.part));
    const auto now = t.around.of(t.number[s]);
    around.assign(now.begin(), now.end());
    t.sort_by_id(around);
    for (const std::int32_t f : around) out.around.push_back(compact.facet(f, t.corners));
    out.first_candidate.push_back(static_cast<std::int32_t>(out.candidate.size()));
    out.first_around.push_back(static_cast<std::int32_t>(out.around.size()));
  }
  return std::move(compact.out);
}

}  // namespace kerf
