// Pairs of slaves and facets whose boxes meet, and how they change as the surface does.
#include "contact/candidate_search.hpp"

#include <algorithm>
#include <array>
#include <utility>

#include "contact/candidate_rows.hpp"
#include "contact/search_trees.hpp"
#include "contact/surface_tables.hpp"
#include "core/assert.hpp"
#include "kerf/shape.hpp"

namespace kerf {

namespace {

/// Facets and clusters of slaves whose boxes have changed since the last search.
struct Changed {
  std::vector<std::int32_t> boxes, own_boxes;
  std::vector<char> clusters, own_clusters;  // per cluster, whether

  explicit Changed(std::size_t n_clusters) : clusters(n_clusters, 0), own_clusters(n_clusters, 0) {}
};

}  // namespace

struct CandidateSearch::Tables : SearchRecords {
  bool same_part;
  Numbering facet_numbers{0, 0};  // as far as somebody asked
  std::vector<std::int32_t> slave_of;  // per node number: the slave, or -1
  std::vector<std::uint32_t> role;  // per facet; 0 of those that are gone
  std::vector<PartFacets> parts;
  std::vector<std::int32_t> place_in_tree;  // per facet: in its part's trees, or -1
  std::vector<std::int32_t> late;  // facets that the trees have not, or not in their present size
  NearbyFacets nearby;  // facets that a cluster meets; kept for its memory
  std::vector<SlaveCluster> clusters;
  std::vector<PartSlaves> part_slaves;
  std::vector<std::int32_t> cluster_of, place;  // per slave: its cluster, and where it is in the trees of its part
  std::vector<std::int32_t> ring;  // per node number: the last mark set on it
  std::int32_t mark = 0;
  CandidateRows rows;

  Tables(std::vector<ContactNodeRecord> s, std::vector<ContactFacetRecord> f, bool same, std::size_t n_local)
      : SearchRecords(std::move(s), std::move(f), n_local), same_part(same), rows(*this, n_local > 0) {
    corners.reserve(facets.size());
    for (const ContactFacetRecord& facet : facets) {
      ids.push_back(facet.id);
      role.push_back(facet.role);
      corners.push_back(corners_of(facet));
    }
    number.reserve(slaves.size());
    for (std::size_t i = 0; i < slaves.size(); ++i) {
      join(static_cast<std::int32_t>(i));
      set_slave_boxes(static_cast<std::int32_t>(i));
    }
    for (PartSlaves& p : part_slaves) p.trees.finish();
    around.build(corners, ids, numbering.size());
    plant_trees();
    for (const SlaveCluster& cluster : clusters) find_all(cluster);
  }

  /// What the trees for pairs within a part are to hold.
  const Box* within_part(const Box& own_box) const { return same_part ? &own_box : nullptr; }
  void plant_trees() {
    for (std::size_t f = 0; f < facets.size(); ++f) plant(static_cast<std::int32_t>(f));
    for (PartFacets& p : parts) p.trees.finish();
  }
  /// Whether a facet is there, and not just for the sake of the slaves of its corners.
  bool may_meet(std::int32_t f) const { return (role[f] & ~ContactFacetRecord::meets_none) != 0; }
  /// Puts the present boxes of a facet into its part's trees.
  void plant(std::int32_t f) {
    if (!may_meet(f)) return;
    const auto part = static_cast<std::size_t>(facets[f].body);
    if (part >= parts.size()) parts.resize(part + 1);
    place_in_tree.resize(facets.size(), -1);
    if (place_in_tree[f] < 0) {
      place_in_tree[f] = static_cast<std::int32_t>(parts[part].facet.size());
      parts[part].facet.push_back(f);
    }
    set_in_tree(f, facets[f].box, facets[f].own_box);
  }
  void replant(const Changed& changed) {
    for (const std::vector<std::int32_t>* list : {&std::as_const(late), &changed.boxes, &changed.own_boxes})
      for (const std::int32_t f : *list) plant(f);
    for (PartFacets& p : parts) p.trees.finish();
    late.clear();
  }
  void uproot(std::int32_t f) {
    if (f < static_cast<std::int32_t>(place_in_tree.size()) && place_in_tree[f] >= 0) set_in_tree(f, {}, {});
  }
  void set_in_tree(std::int32_t f, const Box& box, const Box& own_box) {
    PartFacets& p = parts[facets[f].body];
    p.trees.set(static_cast<std::size_t>(place_in_tree[f]), box, within_part(own_box));
  }
  /// Trees over what has changed, for every part; not for finding facets.
  std::vector<TreePair> trees_of(const Changed& changed) const {
    std::vector<TreePair> trees(parts.size());
    for (const std::int32_t f : changed.boxes) trees[facets[f].body].others.add(facets[f].box);
    for (const std::int32_t f : changed.own_boxes) trees[facets[f].body].own.add(facets[f].own_box);
    for (TreePair& p : trees) p.finish();
    return trees;
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
    if (static_cast<std::size_t>(slave.body) >= part_slaves.size())
      part_slaves.resize(static_cast<std::size_t>(slave.body) + 1);
    PartSlaves& part = part_slaves[slave.body];
    if (part.open_cluster < 0 ||
        static_cast<std::int32_t>(clusters[part.open_cluster].slaves.size()) == SlaveCluster::size) {
      part.open_cluster = static_cast<std::int32_t>(clusters.size());
      SlaveCluster& fresh = clusters.emplace_back();
      fresh.slaves.reserve(SlaveCluster::size);
      fresh.first_place = static_cast<std::int32_t>(part.places.size());
      part.places.resize(part.places.size() + SlaveCluster::size);
    }
    SlaveCluster& cluster = clusters[part.open_cluster];
    cluster_of.push_back(part.open_cluster);
    place.push_back(cluster.first_place + static_cast<std::int32_t>(cluster.slaves.size()));
    part.places[place[s]] = {s, number[s], slave.role};
    cluster.slaves.push_back(s);
    cluster.box.include(slave.box);
    cluster.own_box.include(slave.own_box);
  }
  /// Takes a slave out: it meets nothing any more.
  void leave(std::int32_t s) {
    KERF_ASSERT(s >= 0, "only a slave can leave");
    slaves[s].role = 0;
    part_slaves[slaves[s].body].places[place[s]].role = 0;
    put(s, {}, {});
    found[s].clear();
    settle(s);
  }
  void set_slave_boxes(std::int32_t s) {
    PartSlaves& part = part_slaves[slaves[s].body];
    part.trees.set(static_cast<std::size_t>(place[s]), slaves[s].box, within_part(slaves[s].own_box));
  }
  /// Gives a slave other boxes, for which its cluster's only grow.
  void put(std::int32_t s, const Box& box, const Box& own_box) {
    slaves[s].box = box;
    slaves[s].own_box = own_box;
    PartSlaves& part = part_slaves[slaves[s].body];
    part.trees.put(static_cast<std::size_t>(place[s]), box, within_part(own_box));
    clusters[cluster_of[s]].box.include(box);
    clusters[cluster_of[s]].own_box.include(own_box);
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
    constexpr std::size_t many = 64;
    if (list.size() <= many) {
      // One after another into their place, ids side by side.
      std::int64_t key[many];
      std::size_t n = 0;
      for (const std::int32_t f : list) {
        const std::int64_t id = ids[f];
        std::size_t at = n;
        while (at > 0 && key[at - 1] > id) --at;
        if (at > 0 && key[at - 1] == id) continue;
        for (std::size_t k = n; k > at; --k) {
          key[k] = key[k - 1];
          list[k] = list[k - 1];
        }
        key[at] = id;
        list[at] = f;
        ++n;
      }
      list.resize(n);
      return;
    }
    std::sort(list.begin(), list.end(), [&](std::int32_t a, std::int32_t b) { return ids[a] < ids[b]; });
    list.erase(std::unique(list.begin(), list.end()), list.end());
  }
  /// Takes a facet whose box a slave meets, if they make a pair.
  void meet(std::size_t s, std::int32_t f, bool own, bool& marked) {
    if ((role[f] & slaves[s].role) == 0) return;
    if (own) {
      // On a flat surface a slave meets none but the facets that hold it.
      for (const std::int32_t holder : around.of(number[s]))
        if (holder == f) return;
      if (!marked) mark_ring(s);
      marked = true;
      if (touches_ring(f)) return;
    }
    found[s].push_back(f);
  }
  /// Pairs of a cluster of slaves with the facets of the search.
  void find_all(const SlaveCluster& cluster, bool among_others = true, bool among_own = true) {
    const std::int32_t part = slaves[cluster.slaves.front()].body;
    for (std::size_t p = 0; p < parts.size(); ++p) {
      const bool own = static_cast<std::int32_t>(p) == part;
      if (!(own ? among_own : among_others)) continue;
      const PartFacets& part_facets = parts[p];
      nearby.clear();
      part_facets.trees.each(own, cluster,
                             [&](std::size_t k, const Box& box) { nearby.add(part_facets.facet[k], box); });
      if (nearby.empty()) continue;
      for (const std::int32_t s : cluster.slaves) {
        bool marked = false;
        const auto take = [&](std::int32_t f) { meet(static_cast<std::size_t>(s), f, own, marked); };
        if (nearby.too_many())
          part_facets.trees.each(own, slaves[s], [&](std::size_t k) { take(part_facets.facet[k]); });
        else
          nearby.each(own ? slaves[s].own_box : slaves[s].box, take);
      }
    }
    for (const std::int32_t s : cluster.slaves) settle(s);
  }
  /// Sorts what was found for a slave; its row is to be made anew.
  void settle(std::int32_t s) {
    if (found[s].size() > 1) sort_by_id(found[s]);
    if (!found[s].empty() || rows.has(s)) rows.outdate(s);
  }
  /// Pairs of a slave with all facets that there are now.
  void find(std::size_t s) {
    found[s].clear();
    bool marked = false;
    for (std::size_t p = 0; p < parts.size(); ++p) {
      const bool own = static_cast<std::int32_t>(p) == slaves[s].body;
      parts[p].trees.each(own, slaves[s], [&](std::size_t k) { meet(s, parts[p].facet[k], own, marked); });
    }
    find_late(s, marked);
    settle(static_cast<std::int32_t>(s));
  }
  /// Pairs of a slave with the late facets.
  void find_late(std::size_t s, bool& marked) {
    for (const std::int32_t number_of_late : late) {
      const ContactFacetRecord& f = facets[number_of_late];
      const bool own = f.body == slaves[s].body;
      if (own ? same_part && f.own_box.meets(slaves[s].own_box) : f.box.meets(slaves[s].box))
        meet(s, number_of_late, own, marked);
    }
  }
  /// Marks the nodes whose facets around them touch the element of a facet: slaves that are no pair with it.
  void mark_neighbours(std::int32_t f) {
    ++mark;
    for (const std::int32_t n : corners[f]) {
      ring[n] = mark;
      for (const std::int32_t g : around.of(n))
        for (int k = 0; k < 4; ++k) ring[corners[g][k]] = mark;
    }
  }
  /// Pairs of all slaves with the late facets from the given one on.
  void find_new(std::size_t first) {
    std::vector<std::int32_t> touched;
    for (std::size_t k = first; k < late.size(); ++k) {
      const std::int32_t f = late[k];
      const ContactFacetRecord& facet = facets[f];
      if (same_part) mark_neighbours(f);
      for (std::size_t p = 0; p < part_slaves.size(); ++p) {
        const bool own = static_cast<std::int32_t>(p) == facet.body;
        const PartSlaves& part = part_slaves[p];
        part.trees.each(own, facet, [&](std::size_t at) {
          const PartSlaves::Place& slave = part.places[at];
          if ((role[f] & slave.role) == 0 || (own && ring[slave.node] == mark)) return;
          found[slave.slave].push_back(f);
          touched.push_back(slave.slave);
        });
      }
    }
    std::sort(touched.begin(), touched.end());
    touched.erase(std::unique(touched.begin(), touched.end()), touched.end());
    for (const std::int32_t s : touched) settle(s);
  }
  /// Whether a cluster meets one of the facets in some trees, of its own part or of others.
  bool meets_any(const SlaveCluster& cluster, const std::vector<TreePair>& trees, bool own) const {
    const auto part = static_cast<std::size_t>(slaves[cluster.slaves.front()].body);
    if (own) return part < trees.size() && trees[part].own.meets(cluster.own_box);
    for (std::size_t p = 0; p < trees.size(); ++p)
      if (p != part && trees[p].others.meets(cluster.box)) return true;
    return false;
  }
  /// Finds anew what slaves with other boxes, and slaves near facets with other boxes, meet.
  void find_changed(const Changed& changed) {
    replant(changed);
    const std::vector<TreePair> trees = trees_of(changed);
    for (std::size_t c = 0; c < clusters.size(); ++c) {
      SlaveCluster& cluster = clusters[c];
      if (changed.clusters[c] || changed.own_clusters[c]) cluster.enclose(slaves);
      const bool others = changed.clusters[c] || meets_any(cluster, trees, false);
      const bool own = same_part && (changed.own_clusters[c] || meets_any(cluster, trees, true));
      if (!others && !own) continue;
      const std::int32_t part = slaves[cluster.slaves.front()].body;
      for (const std::int32_t s : cluster.slaves)
        std::erase_if(found[s], [&](std::int32_t f) { return facets[f].body == part ? own : others; });
      find_all(cluster, others, own);
    }
  }
  /// Finds anew all pairs of the slaves before `end` that are among some nodes.
  void find_round(std::vector<std::int32_t>& nodes, std::int32_t end) {
    std::sort(nodes.begin(), nodes.end());
    nodes.erase(std::unique(nodes.begin(), nodes.end()), nodes.end());
    for (const std::int32_t n : nodes)
      if (slave_of[n] >= 0 && slave_of[n] < end) find(static_cast<std::size_t>(slave_of[n]));
  }
  std::int32_t n_facets() const { return static_cast<std::int32_t>(facets.size()); }
  /// The number of a facet; the next free one where it is not here yet.
  std::int32_t number_of_facet(std::int64_t id) {
    while (facet_numbers.size() < ids.size()) {
      const std::size_t next = facet_numbers.size();
      const auto number = static_cast<std::size_t>(facet_numbers.number(ids[next], -1));
      KERF_ASSERT(number == next, "every facet is listed once");
    }
    return facet_numbers.find(id, n_facets());
  }
  /// Takes out the facets of some elements; their corners are added to `affected`.
  void kill(const std::vector<std::int64_t>& elements, std::vector<std::int32_t>& affected) {
    for (const std::int64_t element : elements)
      for (int face = 0; face < 6; ++face) {
        const std::int32_t f = number_of_facet(element * Shape::code_of_faces + face);
        if (f == n_facets() || role[f] == 0) continue;
        role[f] = 0;
        uproot(f);
        rows.drop_facet(f);
        for (int k = 0; k < 4; ++k) {
          around.remove(corners[f][k], f);
          affected.push_back(corners[f][k]);
        }
      }
  }
  void add(const ContactFacetRecord& facet, std::vector<std::int32_t>& affected) {
    const auto f = static_cast<std::int32_t>(facets.size());
    facets.push_back(facet);
    ids.push_back(facet.id);
    role.push_back(facet.role);
    if (may_meet(f)) late.push_back(f);
    corners.push_back(corners_of(facet));
    for (int k = 0; k < n_corners(corners[f]); ++k) {
      around.add(corners[f][k], f, ids);
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
                             const std::vector<ContactNodeRecord>& changed_slaves) {
  Tables& t = *tables_;
  std::vector<std::int32_t> affected;  // nodes whose surroundings changed
  t.kill(dead_elements, affected);
  const std::size_t first_new = t.late.size();
  const auto n_old = static_cast<std::int32_t>(t.slaves.size());
  for (const ContactFacetRecord& facet : new_facets) t.add(facet, affected);
  t.resize();
  t.find_new(first_new);
  for (const ContactNodeRecord& slave : changed_slaves) {
    if (slave.role != 0)
      t.slaves.push_back(slave);
    else
      t.leave(t.slave_of[t.numbering.number(slave.id, slave.local)]);
  }
  for (auto s = n_old; s < static_cast<std::int32_t>(t.slaves.size()); ++s) {
    t.join(s);
    t.put(s, t.slaves[s].box, t.slaves[s].own_box);
    t.find(static_cast<std::size_t>(s));
  }
  t.find_round(affected, n_old);
}

void CandidateSearch::refresh(const std::vector<ContactFacetRecord>& facets,
                              const std::vector<ContactNodeRecord>& slaves) {
  Tables& t = *tables_;
  std::vector<std::int32_t> affected;
  const std::size_t first_new = t.late.size();
  for (const ContactFacetRecord& facet : facets) {
    const std::int32_t f = t.number_of_facet(facet.id);
    if (f == t.n_facets()) {
      t.add(facet, affected);
      continue;
    }
    t.facets[f].box.include(facet.box);
    t.facets[f].own_box.include(facet.own_box);
    if (t.may_meet(f)) t.late.push_back(f);
  }
  t.resize();
  for (const ContactNodeRecord& slave : slaves) {
    const std::int32_t n = t.numbering.number(slave.id, slave.local), s = t.slave_of[n];
    KERF_ASSERT(s >= 0, "a slave stays on the rank that its home is in");
    t.put(s, slave.box, slave.own_box);
    affected.push_back(n);
  }
  t.find_new(first_new);
  t.find_round(affected, static_cast<std::int32_t>(t.slaves.size()));
}

void CandidateSearch::renew(const std::vector<ContactFacetRecord>& facets,
                            const std::vector<ContactNodeRecord>& slaves) {
  Tables& t = *tables_;
  Changed changed(t.clusters.size());
  std::vector<std::int32_t> affected;
  for (const ContactFacetRecord& facet : facets) {
    const std::int32_t f = t.number_of_facet(facet.id);
    const bool fresh = f == t.n_facets();
    if (fresh) t.add(facet, affected);
    if (!t.may_meet(f)) continue;
    ContactFacetRecord& known = t.facets[f];
    if (fresh || !(known.box == facet.box)) changed.boxes.push_back(f);
    if (fresh || !(known.own_box == facet.own_box)) changed.own_boxes.push_back(f);
    known.box = facet.box;
    known.own_box = facet.own_box;
  }
  t.resize();
  for (const ContactNodeRecord& slave : slaves) {
    const std::int32_t n = t.numbering.number(slave.id, slave.local), s = t.slave_of[n];
    KERF_ASSERT(s >= 0, "a slave stays on the rank that its home is in");
    ContactNodeRecord& known = t.slaves[s];
    if (!(known.box == slave.box)) changed.clusters[t.cluster_of[s]] = 1;
    if (!(known.own_box == slave.own_box)) changed.own_clusters[t.cluster_of[s]] = 1;
    known.box = slave.box;
    known.own_box = slave.own_box;
    t.set_slave_boxes(s);
  }
  for (PartSlaves& p : t.part_slaves) p.trees.finish();
  for (const std::int32_t n : affected) {  // the facets round them are others
    const std::int32_t s = t.slave_of[n];
    if (s < 0) continue;
    changed.own_clusters[t.cluster_of[s]] = 1;
    if (t.rows.has(s)) t.rows.outdate(s);
  }
  t.find_changed(changed);
}

bool CandidateSearch::stale() const {
  // Every slave that is looked up again compares itself with all late facets.
  constexpr std::size_t few = 128, share = 32;
  return tables_->late.size() > std::max(few, tables_->facets.size() / share);
}

const Candidates& CandidateSearch::candidates() { return tables_->rows.update(); }

}  // namespace kerf
