// Filling of the grid.
#include "dynamics/facet_grid.hpp"

namespace kerf {

namespace {

/// Boxes of the slaves of every part: facets far from all other parts' slaves are left out.
class PartBoxes {
 public:
  explicit PartBoxes(const std::vector<ContactNodeRecord>& slaves) {
    for (const ContactNodeRecord& s : slaves) {
      if (static_cast<std::size_t>(s.part) >= boxes_.size()) boxes_.resize(static_cast<std::size_t>(s.part) + 1);
      boxes_[s.part].include(s.box);
    }
  }
  bool meets_other_part(const ContactFacetRecord& f) const {
    for (std::size_t p = 0; p < boxes_.size(); ++p)
      if (static_cast<std::int32_t>(p) != f.part && boxes_[p].meets(f.box)) return true;
    return false;
  }

 private:
  std::vector<Box> boxes_;
};

}  // namespace

FacetGrid::FacetGrid(const std::vector<ContactNodeRecord>& slaves, const std::vector<ContactFacetRecord>& facets,
                     bool own)
    : own_(own) {
  const PartBoxes others(own ? std::vector<ContactNodeRecord>{} : slaves);
  std::vector<Entry> kept;
  kept.reserve(facets.size());
  for (std::size_t i = 0; i < facets.size(); ++i) {
    const bool reachable = !slaves.empty() && (own || others.meets_other_part(facets[i]));
    (reachable ? kept : skipped_).push_back(entry_of(facets[i], static_cast<std::int32_t>(i)));
  }
  if (kept.empty()) return;
  choose_cells(slaves, kept);
  fill(kept);
}

/// Cells as large as the mean box, where it is looked for.
void FacetGrid::choose_cells(const std::vector<ContactNodeRecord>& slaves, const std::vector<Entry>& kept) {
  for (int d = 0; d < 3; ++d) {
    double sum = 0.0;
    for (const ContactNodeRecord& s : slaves) sum += (own_ ? s.own_box : s.box).half(d);
    typical_[d] = 1.2 * sum / static_cast<double>(slaves.size());
  }
  double sum = 0.0;
  for (const Entry& e : kept)
    for (int d = 0; d < 3; ++d) sum += 2.0 * (e.box.half(d) + typical_[d]);
  per_cell_ = sum > 0.0 ? 3.0 * static_cast<double>(kept.size()) / sum : 1.0;
}

void FacetGrid::fill(const std::vector<Entry>& kept) {
  std::size_t size = 64;
  while (size < 4 * kept.size()) size *= 2;
  first_.assign(size + 1, 0);
  for (const Entry& e : kept) {
    all_.include(e.box);
    each_cell_of(e.box, [&](std::size_t b) { ++first_[b + 1]; });
  }
  for (std::size_t b = 0; b < size; ++b) first_[b + 1] += first_[b];
  entries_.resize(static_cast<std::size_t>(first_[size]));
  std::vector<std::int32_t> next(first_.begin(), first_.end() - 1);
  for (const Entry& e : kept) each_cell_of(e.box, [&](std::size_t b) { entries_[next[b]++] = e; });
}

}  // namespace kerf
