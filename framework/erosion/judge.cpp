// The criteria of a part and their combination.
#include "erosion/judge.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <bit>

#include "core/assert.hpp"
#include "kerf/solid_laws.hpp"

namespace kerf {

namespace {

// Components of the erosion state that stand before the criteria's; all but the first only where elements fade out.
enum : int { verdicts_component, fade_cycles, fade_criterion, fade_value, fade_strength, fade_tension };

}  // namespace

PartJudge::PartJudge(const ErosionInput& erosion, const PartStore& store, int first_state) {
  fade_out_ = static_cast<int>(erosion.fade_out);
  const auto [field, component] = store.find_variable("no_tension");
  no_tension_ = field == PartStore::erosion_state ? component : -1;
  softens_ = fade_out_ > 0 || no_tension_ >= 0;
  int next = first_state;
  for (const auto& law : erosion.criteria) {
    Criterion c;
    c.law = law.get();
    c.first_state = next;
    const auto n_state = static_cast<int>(law->state_variables().size());
    c.keeps_state = n_state > 0;
    c.softens = law->softens();
    c.keeps_element = law->then == "no_tension";
    c.reads = LawReads(*law, store);
    next += n_state;
    asked_ |= law->asked_inputs();
    softens_ = softens_ || c.softens;
    criteria_.push_back(std::move(c));
  }
  const auto n = static_cast<int>(criteria_.size());
  needed_ = erosion.rule == "any" ? 1 : erosion.rule == "all" ? n : static_cast<int>(erosion.count);
}

void PartJudge::begin(PartStore& store, std::int64_t cycle) {
  store_ = &store;
  cycle_ = cycle;
  failures.clear();
  flags.assign(static_cast<std::size_t>(store.n_blocks()), 0);
  for (Criterion& c : criteria_) c.access = c.reads.access(store);
}

unsigned PartJudge::judge(ErosionBatch& rows, int block) {
  Verdicts v;
  if (softens_) {
    std::fill_n(v.strength, lane_width, 1.0);
    std::fill_n(v.tension, lane_width, 1.0);
    std::fill_n(v.compression, lane_width, 1.0);
  }
  for (std::size_t k = 0; k < criteria_.size(); ++k) ask(k, rows, block, v);
  unsigned dead = combine(v, block);
  if (fade_out_ > 0) dead = fade_out(dead, rows, v, block);
  if (softens_) soften(v, block);
  if (dead == 0) return 0;
  for (int l = 0; l < lane_width; ++l) {
    const int slot = block * lane_width + l;
    if (slot >= store_->n_slots() || !store_->live(slot)) dead &= ~(1u << l);
  }
  record(dead, v, block);
  return dead;
}

/// Calls `complain(lane)` for live elements of a block where `is_bad(lane)`. Nothing is asked of single lanes where
/// none is bad.
template <class Test, class Complain>
void PartJudge::for_bad_lanes(int block, const Test& is_bad, const Complain& complain) const {
  unsigned bad = 0;
  for (int l = 0; l < lane_width; ++l) bad |= is_bad(l) ? 1u : 0u;
  if (bad == 0) return;
  for (int l = 0; l < lane_width; ++l) {
    const int slot = block * lane_width + l;
    if (is_bad(l) && slot < store_->n_slots() && store_->live(slot)) complain(l);
  }
}

/// Throws where a verdict on a live element is neither yes nor no.
void PartJudge::refuse_unknown(const ErosionCriterion& law, const Verdicts& v, std::size_t k, int block) const {
  const double *failed = v.failed, *value = v.value[k];
  for_bad_lanes(
      block, [&](int l) { return !(failed[l] == 0.0 || failed[l] == 1.0) || value[l] != value[l]; },
      [&](int l) {
        if (failed[l] == failed[l] && value[l] == value[l])
          throw LawError(
              law, block, l,
              fmt::format("it says that the element has failed by the number {}; expected 0 or 1, the second "
                          "member of a Verdict",
                          failed[l]));
        throw LawError(law, block, l,
                       "whether the element has failed is not known: a number in the criterion is none (NaN), as after "
                       "0/0 or the root of a negative number; expected a condition that guards against it, such as "
                       "`von_mises > 0 and ...`");
      });
}

/// Throws where the share that is left of a stress of a live element is none.
void PartJudge::refuse_shares(const ErosionCriterion& law, const double* shares, const char* of, int block) const {
  for_bad_lanes(
      block, [&](int l) { return !(shares[l] >= 0.0 && shares[l] <= 1.0); },
      [&](int l) {
        throw LawError(law, block, l,
                       fmt::format("it leaves {} of the {}; expected a share from 0 to 1", shares[l], of));
      });
}

/// A criterion that keeps state or softens is asked every cycle, and heard in the cycles of its interval.
void PartJudge::ask(std::size_t k, ErosionBatch& rows, int block, Verdicts& v) {
  const Criterion& c = criteria_[k];
  v.looked[k] = cycle_ % c.law->check_interval == 0;
  if (!v.looked[k] && !c.keeps_state && !c.softens) return;
  Field& states = store_->field(PartStore::erosion_state);
  alignas(64) double strength[lane_width], tension[lane_width], compression[lane_width];
  if (c.softens) {
    std::fill_n(strength, lane_width, 1.0);
    std::fill_n(tension, lane_width, 1.0);
    std::fill_n(compression, lane_width, 1.0);
  }
  rows.reads = read_rows(c.access, block);
  rows.state = states.data.data() + states.index(block * lane_width, c.first_state);
  rows.value = v.value[k];
  rows.failed = v.failed;
  rows.strength = strength;
  rows.tension = tension;
  rows.compression = compression;
  if (!c.access.tensors.empty())
    detail::rotate_tensors(c.access.tensors, *reinterpret_cast<const double(*)[9][lane_width]>(rows.rotation),
                           rows.state);
  detail::in_block(*c.law, block, [&] { c.law->judge(rows); });
  if (v.looked[k]) refuse_unknown(*c.law, v, k, block);
  if (c.softens) {
    refuse_shares(*c.law, strength, "deviator", block);
    refuse_shares(*c.law, tension, "tensile pressures", block);
    refuse_shares(*c.law, compression, "pressures in compression", block);
  }
  for (int l = 0; c.softens && l < lane_width; ++l) {
    v.strength[l] *= strength[l];
    v.tension[l] *= tension[l];
    v.compression[l] *= compression[l];
  }
  for (int l = 0; v.looked[k] && l < lane_width; ++l) v.masks[k] |= (v.failed[l] != 0.0 ? 1u : 0u) << l;
}

/// Lanes to delete. Those that fail and stay are taken care of.
unsigned PartJudge::combine(Verdicts& v, int block) const {
  unsigned dead = 0, kept = 0;
  if (needed_ == 1) {
    for (std::size_t k = 0; k < criteria_.size(); ++k) {
      (criteria_[k].keeps_element ? kept : dead) |= v.masks[k];
      if (criteria_[k].keeps_element) v.masks[k] = 0;  // it is no cause of death
    }
  } else {
    // The criteria that have to fail together agree on what becomes of the element.
    (criteria_[0].keeps_element ? kept : dead) = failed_together(v, block);
  }
  if (no_tension_ >= 0) hold_without_tension(kept, v, block);
  return dead;
}

/// An element that has once failed and stayed has no deviator and no tension for ever.
void PartJudge::hold_without_tension(unsigned failed, Verdicts& v, int block) const {
  Field& states = store_->field(PartStore::erosion_state);
  double* flags = states.data.data() + states.index(block * lane_width, no_tension_);
  for (int l = 0; l < lane_width; ++l) {
    const int slot = block * lane_width + l;
    if ((failed >> l & 1u) != 0 && slot < store_->n_slots() && store_->live(slot)) flags[l] = 1.0;
    v.strength[l] *= 1.0 - flags[l];
    v.tension[l] *= 1.0 - flags[l];
  }
}

/// Lanes in which as many criteria have failed as are needed. A criterion's last verdict stands until its next look.
unsigned PartJudge::failed_together(const Verdicts& v, int block) const {
  unsigned dead = 0;
  Field& states = store_->field(PartStore::erosion_state);
  for (int l = 0; l < lane_width; ++l) {
    const int slot = block * lane_width + l;
    auto verdicts = static_cast<unsigned>(states.at(slot, verdicts_component));
    for (std::size_t k = 0; k < criteria_.size(); ++k)
      if (v.looked[k]) verdicts = (verdicts & ~(1u << k)) | (v.masks[k] >> l & 1u) << k;
    states.set(slot, verdicts_component, verdicts);
    if (std::popcount(verdicts) >= needed_) dead |= 1u << l;
  }
  return dead;
}

int PartJudge::first_failing(const Verdicts& v, int lane) const {
  int first = 0;
  while (first + 1 < static_cast<int>(criteria_.size()) && (v.masks[first] >> lane & 1u) == 0) ++first;
  return first;
}

/// Lanes that cannot wait once they have failed: without volume, or failed by a criterion that says so.
unsigned PartJudge::at_once(const Verdicts& v, const double* volume_ratio) const {
  unsigned lanes = 0;
  for (int l = 0; l < lane_width; ++l) lanes |= (volume_ratio[l] > 0.0 ? 0u : 1u) << l;
  for (std::size_t k = 0; k < criteria_.size(); ++k)
    if (!criteria_[k].law->can_fade()) lanes |= v.masks[k];
  return lanes;
}

/// The deviator and the tension of elements that have failed fall in equal steps from what they were at failure: what
/// the laws would build up beyond that does not count. An element that has lost them is dead; the criterion and the
/// value that it failed with are remembered.
unsigned PartJudge::fade_out(unsigned dead, const ErosionBatch& rows, Verdicts& v, int block) {
  Field& states = store_->field(PartStore::erosion_state);
  const Field& factors = store_->field(PartStore::softening);
  const unsigned cannot_wait = at_once(v, rows.volume_ratio);
  unsigned gone = 0;
  for (int l = 0; l < lane_width; ++l) {
    const int slot = block * lane_width + l;
    const double strength = von_mises(deviator(detail::tensor_at(rows.stress, l)));
    const double tension = std::max(-rows.pressure[l], 0.0);
    double cycles = states.at(slot, fade_cycles);
    if (cycles == 0.0) {
      if ((dead >> l & 1u) == 0) continue;
      const int first = first_failing(v, l);
      states.set(slot, fade_criterion, first);
      states.set(slot, fade_value, v.value[first][l]);
      states.set(slot, fade_strength, strength);
      states.set(slot, fade_tension, tension);
    }
    cycles += 1.0;
    states.set(slot, fade_cycles, cycles);
    if (cycles > fade_out_ || (cannot_wait >> l & 1u) != 0) gone |= 1u << l;
    const double left = std::max(1.0 - cycles / fade_out_, 0.0);
    // The factor that would bring the stress of the laws, which has the last factor in it, to what is left.
    const auto bounded = [&](double at_failure, double now, double applied) {
      return now > 0.0 ? std::min(left, left * at_failure * applied / now) : left;
    };
    v.strength[l] *= bounded(states.at(slot, fade_strength), strength, factors.at(slot, detail::strength_applied));
    v.tension[l] *= bounded(states.at(slot, fade_tension), tension, factors.at(slot, detail::tension_applied));
  }
  return gone;
}

/// What the next step will see.
void PartJudge::soften(const Verdicts& v, int block) const {
  Field& field = store_->field(PartStore::softening);
  double* next = field.data.data() + field.index(block * lane_width, 0);
  std::copy_n(v.strength, lane_width, next + detail::next_strength * lane_width);
  std::copy_n(v.tension, lane_width, next + detail::next_tension * lane_width);
  std::copy_n(v.compression, lane_width, next + detail::next_compression * lane_width);
}

void PartJudge::record(unsigned dead, const Verdicts& v, int block) {
  const Field& states = store_->field(PartStore::erosion_state);
  for (int l = 0; l < lane_width; ++l) {
    if ((dead >> l & 1u) == 0) continue;
    const int slot = block * lane_width + l;
    if (fade_out_ > 0) {
      failures.push_back({slot, static_cast<int>(states.at(slot, fade_criterion)), states.at(slot, fade_value)});
      continue;
    }
    const int first = first_failing(v, l);
    failures.push_back({slot, first, v.value[first][l]});
  }
}

}  // namespace kerf
