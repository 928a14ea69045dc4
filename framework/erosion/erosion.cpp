// The combination of criteria, the deletion of elements, and the fate of their nodes.
#include "erosion/erosion.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <bit>

#include "core/assert.hpp"
#include "model/copies.hpp"
#include "model/held_energy.hpp"
#include "model/names.hpp"

namespace kerf {

Erosion::Erosion(const Model& model) : nonlocal_(model) {
  for (const PartModel& part : model.parts)
    judges_.push_back(part.material->erosion ? std::make_unique<PartJudge>(*part.material->erosion, *part.store,
                                                                           part.first_criterion_state)
                                             : nullptr);
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

std::vector<ExteriorFacet> Erosion::failing() const {
  std::vector<ExteriorFacet> elements;
  for (std::size_t p = 0; p < judges_.size(); ++p)
    if (judges_[p])
      for (const PartJudge::Failure& f : judges_[p]->failures)
        elements.push_back({static_cast<std::int32_t>(p), f.slot, 0, {}});
  return elements;
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
      if (holds_energy(part)) ledger.accounts.eroded_chemical += ledger.energy_quanta(model, held_energy(part, f.slot));
      ++ledger.accounts.eroded_elements;
      ErosionRecord r;
      r.time = step.end();
      r.cycle = step.cycle;
      r.element = store.id(f.slot);
      r.label = element_label(model, r.element);
      r.part = part.input->name;
      r.criterion = part.material->erosion->criteria[f.criterion]->type;
      r.value = f.value;
      r.mass = store.field(PartStore::mass).at(f.slot, 0);
      r.energy = total;
      records.push_back(std::move(r));
      retired_.push_back({static_cast<std::int32_t>(p), f.slot, 0});
      for (int k = 0; k < store.n_nodes(); ++k) --model.live_elements[store.node(f.slot, k)];
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
  model.surface.update(model.surface_mesh());
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
  model.surface.compact(model.surface_mesh(), moved);
}

}  // namespace kerf
