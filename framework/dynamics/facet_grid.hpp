// A hashed uniform grid of facet boxes that every slave looks into.
#pragma once

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <vector>

#include "dynamics/contact_records.hpp"

namespace kerf {

/// Facets by the cells that their boxes touch, each box inflated by that of a typical slave, so that most slaves need
/// to look into one cell only. There is one grid for pairs within a part, whose boxes are small, and one for pairs of
/// different parts.
class FacetGrid {
 public:
  /// What decides about most visits, side by side in memory.
  struct Entry {
    Box box;
    std::int32_t facet = 0, part = 0;
  };
  /// A slave as it looks at entries.
  struct Probe {
    Probe(const ContactNodeRecord& slave, bool own) : box(own ? slave.own_box : slave.box), part(slave.part), own(own) {}
    bool meets(const Entry& e) const { return ((e.part == part) == own) & box.meets(e.box); }
    Box box;
    std::int32_t part;
    bool own;
  };

  FacetGrid(const std::vector<ContactNodeRecord>& slaves, const std::vector<ContactFacetRecord>& facets, bool own);

  /// Adds a facet after the fact; such facets are looked at one by one.
  void add(const ContactFacetRecord& f, std::int32_t number) { late_.push_back(entry_of(f, number)); }
  const std::vector<Entry>& late() const { return late_; }

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
    if (!all_.meets(probe.box)) return;
    double low[3], high[3];
    for (int d = 0; d < 3; ++d) {
      const double excess = std::max(probe.box.half(d) - typical_[d], 0.0);
      low[d] = probe.box.centre(d) - excess;
      high[d] = probe.box.centre(d) + excess;
    }
    each_cell(low, high, [&](std::size_t b) {
      for (std::int32_t i = first_[b]; i < first_[b + 1]; ++i)
        if (probe.meets(entries_[i])) visit(entries_[i].facet);
    });
  }

 private:
  const Box& box_of(const ContactFacetRecord& f) const { return own_ ? f.own_box : f.box; }
  Entry entry_of(const ContactFacetRecord& f, std::int32_t number) const { return {box_of(f), number, f.part}; }
  void choose_cells(const std::vector<ContactNodeRecord>& slaves, const std::vector<Entry>& kept);
  void fill(const std::vector<Entry>& kept);

  template <class Visit>
  void each_cell_of(const Box& box, const Visit& visit) const {
    double low[3], high[3];
    for (int d = 0; d < 3; ++d) {
      low[d] = box.low[d] - typical_[d];
      high[d] = box.high[d] + typical_[d];
    }
    each_cell(low, high, visit);
  }

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
  double per_cell_ = 1.0, typical_[3] = {};
  Box all_;  // of all entries
  std::vector<std::int32_t> first_;
  std::vector<Entry> entries_, late_, skipped_;
};

}  // namespace kerf
