// The criteria of a part and their combination.
#include "erosion/judge.hpp"

#include <algorithm>
#include <bit>

#include "core/assert.hpp"

namespace kerf {

PartJudge::PartJudge(const PartModel& part) {
  const ErosionInput& erosion = *part.material->erosion;
  int next = 1;  // the first variable holds the verdicts
  for (const auto& law : erosion.criteria) {
    Criterion c;
    c.law = law.get();
    c.first_state = next;
    const auto n_state = static_cast<int>(law->state_variables().size());
    c.keeps_state = n_state > 0;
    next += n_state;
    for (const ReadVariable& r : law->description->reads) {
      const auto where = part.store->find_variable(r.name);
      KERF_ASSERT(where.first != PartStore::n_fields, "variables that criteria read are checked with the input");
      c.reads.push_back(where);
    }
    criteria_.push_back(std::move(c));
  }
  for (const Criterion& c : criteria_) reads_.resize(std::max(reads_.size(), c.reads.size()));
  wide_.resize(reads_.size() * lane_width);
  const auto n = static_cast<int>(criteria_.size());
  needed_ = erosion.rule == "any" ? 1 : erosion.rule == "all" ? n : static_cast<int>(erosion.count);
}

void PartJudge::begin(PartStore& store, std::int64_t cycle) {
  store_ = &store;
  cycle_ = cycle;
  failures.clear();
  flags.assign(static_cast<std::size_t>(store.n_blocks()), 0);
}

unsigned PartJudge::judge(ErosionBatch& rows, int block) {
  alignas(64) double value[8][lane_width], failed[lane_width];
  unsigned masks[8] = {};
  bool looked[8] = {};
  Field& states = store_->field(PartStore::erosion_state);
  for (std::size_t k = 0; k < criteria_.size(); ++k) {
    const Criterion& c = criteria_[k];
    looked[k] = cycle_ % c.law->check_interval == 0;
    if (!looked[k] && !c.keeps_state) continue;
    for (std::size_t r = 0; r < c.reads.size(); ++r) {
      const Field& f = store_->field(c.reads[r].first);
      const std::size_t first = f.index(block * lane_width, c.reads[r].second);
      reads_[r] = f.is_single ? &wide_[r * lane_width] : f.data.data() + first;
      for (int l = 0; f.is_single && l < lane_width; ++l) wide_[r * lane_width + l] = f.single_data[first + l];
    }
    rows.reads = reads_.data();
    rows.state = states.data.data() + states.index(block * lane_width, c.first_state);
    rows.value = value[k];
    rows.failed = failed;
    c.law->judge(rows);
    if (!looked[k]) continue;
    for (int l = 0; l < lane_width; ++l) masks[k] |= (failed[l] != 0.0 ? 1u : 0u) << l;
  }
  unsigned dead = combine(*store_, masks, looked, block);
  if (dead == 0) return 0;
  for (int l = 0; l < lane_width; ++l) {
    const int slot = block * lane_width + l;
    if ((dead >> l & 1u) == 0) continue;
    if (slot >= store_->n_slots() || !store_->live(slot)) {
      dead &= ~(1u << l);
      continue;
    }
    int first = 0;
    while (first + 1 < static_cast<int>(criteria_.size()) && (masks[first] >> l & 1u) == 0) ++first;
    failures.push_back({slot, first, value[first][l]});
  }
  return dead;
}

/// With rule "any", failing now is enough. Otherwise a criterion's last verdict stands until its next look.
unsigned PartJudge::combine(PartStore& store, const unsigned* masks, const bool* looked, int block) const {
  unsigned dead = 0;
  if (needed_ == 1) {
    for (std::size_t k = 0; k < criteria_.size(); ++k) dead |= masks[k];
    return dead;
  }
  Field& states = store.field(PartStore::erosion_state);
  for (int l = 0; l < lane_width; ++l) {
    const int slot = block * lane_width + l;
    auto verdicts = static_cast<unsigned>(states.at(slot, 0));
    for (std::size_t k = 0; k < criteria_.size(); ++k)
      if (looked[k]) verdicts = (verdicts & ~(1u << k)) | (masks[k] >> l & 1u) << k;
    states.set(slot, 0, verdicts);
    if (std::popcount(verdicts) >= needed_) dead |= 1u << l;
  }
  return dead;
}

}  // namespace kerf
