// The combination of criteria, the deletion of elements, and the fate of their nodes.
#include "dynamics/erosion.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <bit>

#include "core/assert.hpp"
#include "dynamics/element_loop.hpp"

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
  alignas(64) double wide[8][lane_width];
  const double* reads[8];
  Field& states = store_->field(PartStore::erosion_state);
  for (std::size_t k = 0; k < criteria_.size(); ++k) {
    const Criterion& c = criteria_[k];
    looked[k] = cycle_ % c.law->check_interval == 0;
    if (!looked[k] && !c.keeps_state) continue;
    for (std::size_t r = 0; r < c.reads.size(); ++r) {
      const Field& f = store_->field(c.reads[r].first);
      const std::size_t first = f.index(block * lane_width, c.reads[r].second);
      reads[r] = f.is_single ? wide[r] : f.data.data() + first;
      for (int l = 0; f.is_single && l < lane_width; ++l) wide[r][l] = f.single_data[first + l];
    }
    rows.reads = reads;
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

Erosion::Erosion(const Model& model) {
  for (const PartModel& part : model.parts)
    judges_.push_back(part.material->erosion ? std::make_unique<PartJudge>(part) : nullptr);
}

ErosionJudge* Erosion::judge(Model& model, int part, std::int64_t cycle) {
  if (!judges_[part]) return nullptr;
  judges_[part]->begin(*model.parts[part].store, cycle);
  return judges_[part].get();
}

std::uint8_t* Erosion::flags(int part) { return judges_[part] ? judges_[part]->flags.data() : nullptr; }

bool Erosion::any_failed() const {
  return std::any_of(judges_.begin(), judges_.end(), [](const auto& j) { return j && !j->failures.empty(); });
}

std::vector<ErosionRecord> Erosion::erode(Model& model, const Step& step, Ledger& ledger) {
  std::vector<ErosionRecord> records;
  retired_.clear();
  for (std::size_t p = 0; p < judges_.size(); ++p) {
    if (!judges_[p]) continue;
    PartModel& part = model.parts[p];
    PartStore& store = *part.store;
    for (const PartJudge::Failure& f : judges_[p]->failures) {
      const double total = store.field(PartStore::internal_energy).at(f.slot, 0) +
                           part.initial_energy * store.field(PartStore::mass).at(f.slot, 0);
      const double viscous = store.field(PartStore::viscous_energy).at(f.slot, 0);
      ledger.accounts.eroded_viscous += ledger.energy_quanta(model, viscous);
      ledger.accounts.eroded_internal += ledger.energy_quanta(model, total - viscous);
      ++ledger.accounts.eroded_elements;
      ErosionRecord r;
      r.time = step.end();
      r.cycle = step.cycle;
      r.element = store.id(f.slot);
      r.part = part.input->name;
      r.criterion = part.material->erosion->criteria[f.criterion]->type;
      r.value = f.value;
      r.mass = store.field(PartStore::mass).at(f.slot, 0);
      r.energy = total;
      records.push_back(std::move(r));
      retired_.push_back({static_cast<std::int32_t>(p), f.slot, 0});
      for (int k = 0; k < 8; ++k) --model.live_elements[store.node(f.slot, k)];
      store.retire(f.slot, model.nodes.first_dummy());
    }
    judges_[p]->failures.clear();
  }
  return records;
}

void Erosion::update_free_nodes(Model& model) {
  NodeStore& nodes = model.nodes;
  std::vector<std::int64_t> live(static_cast<std::size_t>(nodes.n()) + NodeStore::n_dummies);
  for (int i = 0; i < nodes.n(); ++i) live[i] = model.live_elements[i];
  sum_over_copies(model, live.data(), 1);
  for (int i = 0; i < nodes.n(); ++i) {
    if (live[i] != 0 || nodes.free[i]) continue;
    nodes.free[i] = 1;
    may_have_free_nodes_ = true;
  }
  model.surface.update(model);
}

void Erosion::drop_free_nodes(Model& model, Ledger& ledger) {
  if (!may_have_free_nodes_ || model.input->checks.free_nodes != "drop") return;
  may_have_free_nodes_ = false;
  for (int i = 0; i < model.nodes.n(); ++i)
    if (model.nodes.free[i] && model.nodes.mass[i] > 0.0) drop(model, i, ledger);
}

/// Takes a node out of the model on all ranks that hold a copy; its owner books what leaves.
void Erosion::drop(Model& model, int i, Ledger& ledger) {
  NodeStore& nodes = model.nodes;
  if (nodes.owned[i]) {
    const Vec3 v = nodes.v(i);
    ledger.accounts.dropped_kinetic += ledger.energy_quanta(model, 0.5 * nodes.mass[i] * dot(v, v));
    ledger.accounts.dropped_mass += std::llrint(nodes.mass[i] / ledger.mass_quantum);
    for (int d = 0; d < 3; ++d) ledger.accounts.dropped_momentum[d] += ledger.momentum_quanta(nodes.mass[i] * v[d]);
  }
  nodes.set_mass(i, 0.0);
  nodes.set_v(i, {});
}

bool Erosion::drop_distant_nodes(Model& model, Ledger& ledger) {
  if (model.input->checks.free_nodes != "drop_beyond") return false;
  NodeStore& nodes = model.nodes;
  double box[6] = {-1e300, -1e300, -1e300, -1e300, -1e300, -1e300};  // minus the lower corner, then the upper one
  for (int i = 0; i < nodes.n(); ++i) {
    if (nodes.free[i]) continue;
    for (int d = 0; d < 3; ++d) {
      box[d] = std::max(box[d], -nodes.position[4 * i + d]);
      box[3 + d] = std::max(box[3 + d], nodes.position[4 * i + d]);
    }
  }
  MPI_Allreduce(MPI_IN_PLACE, box, 6, MPI_DOUBLE, MPI_MAX, model.comm);
  const double distance = model.input->checks.drop_distance;
  std::int64_t n = 0;
  for (int i = 0; i < nodes.n(); ++i) {
    if (!nodes.free[i] || !(nodes.mass[i] > 0.0)) continue;
    bool beyond = false;
    for (int d = 0; d < 3; ++d)
      beyond =
          beyond || nodes.position[4 * i + d] < -box[d] - distance || nodes.position[4 * i + d] > box[3 + d] + distance;
    if (!beyond) continue;
    drop(model, i, ledger);
    ++n;
  }
  MPI_Allreduce(MPI_IN_PLACE, &n, 1, MPI_INT64_T, MPI_MAX, model.comm);
  return n > 0;
}

void Erosion::compact(Model& model) {
  std::int64_t slots = 0;
  for (const PartModel& part : model.parts) slots += part.store->n_slots();
  if (model.n_live_local() * 50 > slots * 49) return;
  std::vector<std::vector<std::int32_t>> moved;
  for (PartModel& part : model.parts) moved.push_back(part.store->compact());
  model.surface.compact(model, moved);
}

}  // namespace kerf
