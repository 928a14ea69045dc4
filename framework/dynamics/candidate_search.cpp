// A hashed uniform grid of facet boxes that every slave looks into.
#include "dynamics/candidate_search.hpp"

#include <algorithm>
#include <cmath>
#include <span>
#include <unordered_map>

namespace kerf {

namespace {

/// Open-addressing map from id to a dense number, in order of arrival; ids are not negative.
class Numbering {
 public:
  explicit Numbering(std::size_t expected) { resize(expected); }
  std::int32_t number(std::int64_t id) {
    if (2 * static_cast<std::size_t>(n_) >= keys_.size()) resize(2 * static_cast<std::size_t>(n_));
    const std::size_t at = slot(id);
    if (keys_[at] != id) {
      keys_[at] = id;
      values_[at] = n_++;
    }
    return values_[at];
  }
  std::int32_t find(std::int64_t id) const {
    const std::size_t at = slot(id);
    return keys_[at] == id ? values_[at] : -1;
  }
  std::size_t size() const { return static_cast<std::size_t>(n_); }

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
  std::int32_t n_ = 0;
  std::vector<std::int64_t> keys_;
  std::vector<std::int32_t> values_;
};

/// Boxes of the slaves of every part, with their allowances: facets far from all other parts' slaves are left out.
class PartBoxes {
 public:
  explicit PartBoxes(const std::vector<ContactNodeRecord>& slaves) {
    for (const ContactNodeRecord& s : slaves) {
      if (static_cast<std::size_t>(s.part) >= boxes_.size()) boxes_.resize(static_cast<std::size_t>(s.part) + 1);
      Box& b = boxes_[s.part];
      for (int d = 0; d < 3; ++d) {
        b.low[d] = std::min(b.low[d], s.position[d] - s.allowance);
        b.high[d] = std::max(b.high[d], s.position[d] + s.allowance);
      }
    }
  }
  bool meets_other_part(const ContactFacetRecord& f) const {
    for (std::size_t p = 0; p < boxes_.size(); ++p) {
      if (static_cast<std::int32_t>(p) == f.part) continue;
      bool meets = true;
      for (int d = 0; d < 3; ++d)
        meets = meets && f.low[d] - f.allowance <= boxes_[p].high[d] && f.high[d] + f.allowance >= boxes_[p].low[d];
      if (meets) return true;
    }
    return false;
  }

 private:
  struct Box {
    double low[3] = {1e300, 1e300, 1e300}, high[3] = {-1e300, -1e300, -1e300};
  };
  std::vector<Box> boxes_;
};

/// Facets by the cells that their boxes touch, each box inflated by the facet's and a typical slave's allowance, so
/// that most slaves need to look into one cell only. There is one grid for pairs within a part, whose allowances are
/// small, and one for pairs of different parts.
class FacetGrid {
 public:
  FacetGrid(const std::vector<ContactNodeRecord>& slaves, const std::vector<ContactFacetRecord>& facets, bool own)
      : own_(own) {
    if (facets.empty()) return;
    if (slaves.empty()) {
      for (std::size_t i = 0; i < facets.size(); ++i)
        skipped_.push_back(entry_of(facets[i], static_cast<std::int32_t>(i)));
      return;
    }
    double sum = 0.0;
    for (const auto& s : slaves) sum += own ? s.own_allowance : s.allowance;
    typical_ = 1.2 * sum / static_cast<double>(slaves.size());
    sum = 0.0;
    for (const auto& f : facets)
      for (int d = 0; d < 3; ++d) sum += high_of(f)[d] - low_of(f)[d] + 2.0 * (reach(f) + typical_);
    per_cell_ = sum > 0.0 ? 3.0 * static_cast<double>(facets.size()) / sum : 1.0;
    std::size_t size = 64;
    while (size < 4 * facets.size()) size *= 2;
    first_.assign(size + 1, 0);
    const PartBoxes others(own ? std::vector<ContactNodeRecord>{} : slaves);
    const auto inflated = [&](const ContactFacetRecord& f, auto&& visit) {
      if (!own && !others.meets_other_part(f)) return;
      double low[3], high[3];
      for (int d = 0; d < 3; ++d) {
        low[d] = low_of(f)[d] - reach(f) - typical_;
        high[d] = high_of(f)[d] + reach(f) + typical_;
      }
      each_cell(low, high, visit);
    };
    for (const auto& f : facets) inflated(f, [&](std::size_t b) { ++first_[b + 1]; });
    for (std::size_t b = 0; b < size; ++b) first_[b + 1] += first_[b];
    entries_.resize(static_cast<std::size_t>(first_[size]));
    std::vector<std::int32_t> next(first_.begin(), first_.end() - 1);
    for (std::size_t i = 0; i < facets.size(); ++i) {
      const Entry entry = entry_of(facets[i], static_cast<std::int32_t>(i));
      if (!own && !others.meets_other_part(facets[i])) skipped_.push_back(entry);
      inflated(facets[i], [&](std::size_t b) { entries_[next[b]++] = entry; });
    }
  }

  /// Adds a facet after the fact; such facets are looked at one by one.
  void add(const ContactFacetRecord& f, std::int32_t number) { late_.push_back(entry_of(f, number)); }
  const auto& late() const { return late_; }

  /// Visits the facets that were far from all slaves of the search, for a slave that joined later.
  template <class Visit>
  void look_at_skipped(const ContactNodeRecord& slave, const Visit& visit) const {
    const Probe probe(slave, own_);
    for (const Entry& e : skipped_)
      if (probe.meets(e)) visit(e.facet);
  }

  /// Visits all facets whose box a slave may meet; a facet may be visited more than once.
  template <class Visit>
  void look(const ContactNodeRecord& slave, const Visit& visit) const {
    const Probe probe(slave, own_);
    for (const Entry& e : late_)
      if (probe.meets(e)) visit(e.facet);
    if (entries_.empty()) return;
    const double excess = std::max((own_ ? slave.own_allowance : slave.allowance) - typical_, 0.0);
    const auto& x = own_ ? slave.own_position : slave.position;
    double low[3], high[3];
    for (int d = 0; d < 3; ++d) {
      low[d] = x[d] - excess;
      high[d] = x[d] + excess;
    }
    each_cell(low, high, [&](std::size_t b) {
      for (std::int32_t i = first_[b]; i < first_[b + 1]; ++i)
        if (probe.meets(entries_[i])) visit(entries_[i].facet);
    });
  }

  /// What decides about most visits, side by side in memory: the box with the facet's allowance, rounded outwards.
  struct Entry {
    float low[3] = {}, high[3] = {};
    std::int32_t facet = 0, part = 0;
  };
  /// A slave as it looks at entries.
  struct Probe {
    Probe(const ContactNodeRecord& slave, bool own) : own(own), part(slave.part) {
      for (int d = 0; d < 3; ++d) x[d] = static_cast<float>((own ? slave.own_position : slave.position)[d]);
      near = static_cast<float>(own ? slave.own_allowance : slave.allowance) * 1.0001f;
    }
    bool meets(const Entry& e) const {
      // Bitwise "and": six comparisons cost less than six branches that nobody can predict.
      return ((e.part == part) == own) & (x[0] + near >= e.low[0]) & (x[0] - near <= e.high[0]) &
             (x[1] + near >= e.low[1]) & (x[1] - near <= e.high[1]) & (x[2] + near >= e.low[2]) &
             (x[2] - near <= e.high[2]);
    }
    bool own;
    std::int32_t part;
    float x[3], near;
  };

 private:
  Entry entry_of(const ContactFacetRecord& f, std::int32_t number) const {
    Entry e;
    e.facet = number;
    e.part = f.part;
    for (int d = 0; d < 3; ++d) {
      const double low = low_of(f)[d], high = high_of(f)[d], round_off = 1e-6 * (std::fabs(low) + std::fabs(high));
      e.low[d] = static_cast<float>(low - reach(f) - round_off);
      e.high[d] = static_cast<float>(high + reach(f) + round_off);
    }
    return e;
  }
  double reach(const ContactFacetRecord& f) const { return own_ ? f.own_allowance : f.allowance; }
  const double (&low_of(const ContactFacetRecord& f) const)[3] { return own_ ? f.own_low : f.low; }
  const double (&high_of(const ContactFacetRecord& f) const)[3] { return own_ ? f.own_high : f.high; }

  template <class Visit>
  void each_cell(const double (&low)[3], const double (&high)[3], const Visit& visit) const {
    std::int64_t a[3], b[3];
    for (int d = 0; d < 3; ++d) {
      a[d] = static_cast<std::int64_t>(std::floor(low[d] * per_cell_));
      b[d] = static_cast<std::int64_t>(std::floor(high[d] * per_cell_));
    }
    const std::size_t mask = first_.size() - 2;
    for (std::int64_t i = a[0]; i <= b[0]; ++i)
      for (std::int64_t j = a[1]; j <= b[1]; ++j)
        for (std::int64_t k = a[2]; k <= b[2]; ++k) {
          const auto h = static_cast<std::uint64_t>(i) * 73856093u ^ static_cast<std::uint64_t>(j) * 19349663u ^
                         static_cast<std::uint64_t>(k) * 83492791u;
          visit(static_cast<std::size_t>(h ^ h >> 17) & mask);
        }
  }

  bool own_ = false;
  double per_cell_ = 1.0, typical_ = 0.0;
  std::vector<std::int32_t> first_;
  std::vector<Entry> entries_, late_, skipped_;
};

/// Facets around every node of the surface, as they come and go.
class Around {
 public:
  void build(const std::vector<std::int32_t>& corner, std::size_t n_nodes) {
    first_.assign(n_nodes + 1, 0);
    for (const std::int32_t n : corner) ++first_[n + 1];
    for (std::size_t n = 0; n < n_nodes; ++n) first_[n + 1] += first_[n];
    facet_.resize(corner.size());
    std::vector<std::int32_t> next(first_.begin(), first_.end() - 1);
    for (std::size_t i = 0; i < corner.size(); ++i) facet_[next[corner[i]]++] = static_cast<std::int32_t>(i / 4);
  }
  std::span<const std::int32_t> of(std::int32_t node) const {
    const auto it = changed_.find(node);
    if (it != changed_.end()) return it->second;
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
  std::int32_t facet(std::int32_t f, const std::vector<std::int32_t>& corner) {
    if (facet_[f] < 0) {
      facet_[f] = static_cast<std::int32_t>(out.facet_id.size());
      const ContactFacetRecord& r = facets_[f];
      out.facet_id.push_back(r.id);
      out.facet_part.push_back(r.part);
      out.facet_bulk_modulus.push_back(r.bulk_modulus);
      out.facet_volume.push_back(r.volume);
      for (int k = 0; k < 4; ++k)
        out.facet_nodes.push_back(node(corner[4 * f + k], r.nodes[k], r.owners[k], r.locals[k], r.part));
    }
    return facet_[f];
  }
  Candidates out;

 private:
  const std::vector<ContactFacetRecord>& facets_;
  std::vector<std::int32_t> node_, facet_;
};

}  // namespace

struct CandidateSearch::Tables {
  std::vector<ContactNodeRecord> slaves;
  std::vector<ContactFacetRecord> facets;
  bool same_part;
  Numbering numbering;
  std::vector<std::int32_t> corner;  // node number of each facet's corners
  std::vector<std::int32_t> number;  // node number of each slave
  std::vector<char> alive;  // per facet
  Around around;
  FacetGrid others, own;
  std::vector<std::vector<std::int32_t>> found;  // per slave: facets, sorted by id; dead ones are left in
  std::vector<std::int32_t> ring;  // per node number: the last mark set on it
  std::int32_t mark = 0;
  std::size_t n_first = 0;  // slaves of the search; the others joined later

  Tables(std::vector<ContactNodeRecord> s, std::vector<ContactFacetRecord> f, bool same)
      : slaves(std::move(s)),
        facets(std::move(f)),
        same_part(same),
        numbering(slaves.size() + facets.size()),
        others(slaves, facets, false),
        own(slaves, same ? facets : std::vector<ContactFacetRecord>{}, true) {
    for (const ContactFacetRecord& facet : facets)
      for (const std::int64_t id : facet.nodes) corner.push_back(numbering.number(id));
    for (const ContactNodeRecord& slave : slaves) number.push_back(numbering.number(slave.id));
    alive.assign(facets.size(), 1);
    around.build(corner, numbering.size());
    ring.assign(numbering.size(), 0);
    found.resize(slaves.size());
    n_first = slaves.size();
    for (std::size_t i = 0; i < slaves.size(); ++i) find(i);
  }

  /// Marks the nodes of the facets around a slave.
  void mark_ring(std::size_t s) {
    ++mark;
    ring[number[s]] = mark;
    for (const std::int32_t f : around.of(number[s]))
      for (int k = 0; k < 4; ++k) ring[corner[4 * f + k]] = mark;
  }
  /// Whether a facet's element has a node of the marked ring.
  bool touches_ring(std::int32_t f) const {
    for (int k = 0; k < 4; ++k) {
      if (ring[corner[4 * f + k]] == mark) return true;
      const std::int32_t far_side = numbering.find(facets[f].opposite[k]);
      if (far_side >= 0 && ring[far_side] == mark) return true;
    }
    return false;
  }
  void sort_by_id(std::vector<std::int32_t>& list) const {
    std::sort(list.begin(), list.end(), [&](std::int32_t a, std::int32_t b) { return facets[a].id < facets[b].id; });
    list.erase(std::unique(list.begin(), list.end()), list.end());
  }
  void find(std::size_t s) {
    std::vector<std::int32_t>& list = found[s];
    list.clear();
    const auto takes = [&](std::int32_t f) { return alive[f] != 0 && (facets[f].role & slaves[s].role) != 0; };
    const auto take_other = [&](std::int32_t f) {
      if (takes(f)) list.push_back(f);
    };
    others.look(slaves[s], take_other);
    if (s >= n_first) others.look_at_skipped(slaves[s], take_other);
    bool marked = false;
    const auto take_own = [&](std::int32_t f) {
      if (!takes(f)) return;
      if (!marked) mark_ring(s);
      marked = true;
      if (!touches_ring(f)) list.push_back(f);
    };
    own.look(slaves[s], take_own);
    if (s >= n_first) own.look_at_skipped(slaves[s], take_own);
    if (!list.empty()) sort_by_id(list);
  }
  /// Pairs of a slave with facets that have just come.
  void find_new(std::size_t s, std::size_t first_new) {
    const FacetGrid::Probe other(slaves[s], false), self(slaves[s], true);
    bool marked = false;
    const std::size_t before = found[s].size();
    for (std::size_t k = others.late().size() - (facets.size() - first_new); k < others.late().size(); ++k) {
      const std::int32_t f = others.late()[k].facet;
      if ((facets[f].role & slaves[s].role) == 0) continue;
      if (other.meets(others.late()[k])) {
        found[s].push_back(f);
      } else if (same_part && self.meets(own.late()[k])) {
        if (!marked) mark_ring(s);
        marked = true;
        if (!touches_ring(f)) found[s].push_back(f);
      }
    }
    if (found[s].size() != before) sort_by_id(found[s]);
  }
};

CandidateSearch::CandidateSearch(std::vector<ContactNodeRecord> slaves, std::vector<ContactFacetRecord> facets,
                                 bool same_part)
    : tables_(std::make_unique<Tables>(std::move(slaves), std::move(facets), same_part)) {}

CandidateSearch::~CandidateSearch() = default;

void CandidateSearch::change(const std::vector<std::int64_t>& dead_elements,
                             const std::vector<ContactFacetRecord>& new_facets,
                             const std::vector<ContactNodeRecord>& new_slaves) {
  Tables& t = *tables_;
  std::vector<std::int64_t> dead = dead_elements;
  std::sort(dead.begin(), dead.end());
  std::vector<std::int32_t> affected;  // nodes whose surroundings changed
  for (std::size_t f = 0; f < t.facets.size(); ++f) {
    if (t.alive[f] == 0 || !std::binary_search(dead.begin(), dead.end(), t.facets[f].id / 8)) continue;
    t.alive[f] = 0;
    for (int k = 0; k < 4; ++k) {
      t.around.remove(t.corner[4 * f + k], static_cast<std::int32_t>(f));
      affected.push_back(t.corner[4 * f + k]);
    }
  }
  const std::size_t first_new = t.facets.size(), n_old = t.slaves.size();
  for (const ContactFacetRecord& facet : new_facets) {
    const auto f = static_cast<std::int32_t>(t.facets.size());
    t.facets.push_back(facet);
    t.alive.push_back(1);
    for (const std::int64_t id : facet.nodes) {
      t.corner.push_back(t.numbering.number(id));
      t.around.add(t.corner.back(), f);
      affected.push_back(t.corner.back());
    }
    t.others.add(facet, f);
    if (t.same_part) t.own.add(facet, f);
  }
  for (const ContactNodeRecord& slave : new_slaves) {
    t.slaves.push_back(slave);
    t.number.push_back(t.numbering.number(slave.id));
  }
  t.ring.resize(t.numbering.size(), 0);
  t.found.resize(t.slaves.size());
  std::vector<char> is_affected(t.numbering.size(), 0);
  for (const std::int32_t n : affected) is_affected[n] = 1;
  for (std::size_t s = 0; s < t.slaves.size(); ++s) {
    if (s >= n_old || is_affected[t.number[s]] != 0)
      t.find(s);
    else if (first_new < t.facets.size())
      t.find_new(s, first_new);
  }
}

Candidates CandidateSearch::candidates() const {
  const Tables& t = *tables_;
  Compactor compact(t.facets, t.numbering.size(), t.facets.size());
  std::vector<std::int32_t> around;
  for (std::size_t s = 0; s < t.slaves.size(); ++s) {
    Candidates& out = compact.out;
    const std::size_t before = out.candidate.size();
    for (const std::int32_t f : t.found[s])
      if (t.alive[f] != 0) out.candidate.push_back(compact.facet(f, t.corner));
    if (out.candidate.size() == before) continue;
    const ContactNodeRecord& slave = t.slaves[s];
    out.slave.push_back(compact.node(t.number[s], slave.id, slave.owner, slave.local, slave.part));
    const auto now = t.around.of(t.number[s]);
    around.assign(now.begin(), now.end());
    t.sort_by_id(around);
    for (const std::int32_t f : around) out.around.push_back(compact.facet(f, t.corner));
    out.first_candidate.push_back(static_cast<std::int32_t>(out.candidate.size()));
    out.first_around.push_back(static_cast<std::int32_t>(out.around.size()));
  }
  return std::move(compact.out);
}

Candidates find_candidates(std::vector<ContactNodeRecord> slaves, std::vector<ContactFacetRecord> facets,
                           bool same_part) {
  for (ContactNodeRecord& s : slaves) std::copy_n(s.position, 3, s.own_position);
  for (ContactFacetRecord& f : facets) {
    std::copy_n(f.low, 3, f.own_low);
    std::copy_n(f.high, 3, f.own_high);
  }
  return CandidateSearch(std::move(slaves), std::move(facets), same_part).candidates();
}

}  // namespace kerf
