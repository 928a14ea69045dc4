// The bridge between the stores of the model and the view that an element plugin gets.
#include "dynamics/element_loop.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "core/flush_denormals.hpp"
#include "model/exposure.hpp"
#include "model/names.hpp"

namespace kerf {

namespace {

template <class Real>
ElementArrays<Real> view_of(Model& model, PartModel& part) {
  PartStore& store = *part.store;
  ElementArrays<Real> w;
  w.position = model.nodes.position.data();
  w.velocity = model.nodes.velocity.data();
  w.force = model.nodes.force.data();
  w.scale = model.quanta.force;
  w.material = part.material->strength.get();
  w.eos = part.material->eos.get();
  w.solid = part.material->solid.get();
  w.of_material = part.material_reads.access(store);
  if (w.eos) w.of_eos = part.eos_reads.access(store);
  w.reference_density = part.material->density;
  w.n_blocks = store.n_blocks();
  w.nodes = store.nodes();
  w.mass = store.field(PartStore::mass).entries<double>();
  w.volume = store.field(PartStore::volume).entries<double>();
  w.deviator = store.field(PartStore::deviator).entries<Real>();
  w.pressure = store.field(PartStore::pressure).entries<Real>();
  w.internal_energy = store.field(PartStore::internal_energy).entries<double>();
  w.viscous_energy = store.field(PartStore::viscous_energy).entries<double>();
  w.element_state = store.field(PartStore::element_state).entries<Real>();
  w.material_state = store.field(PartStore::material_state).entries<double>();
  w.eos_state = store.field(PartStore::eos_state).entries<double>();
  const auto optional = [&store](PartStore::FieldIndex f) {
    return store.field(f).n_components > 0 ? store.field(f).entries<double>() : nullptr;
  };
  w.place = optional(PartStore::place);
  w.softening = optional(PartStore::softening);
  w.n_element_state = store.field(PartStore::element_state).n_components;
  w.n_material_state = store.field(PartStore::material_state).n_components;
  w.n_eos_state = store.field(PartStore::eos_state).n_components;
  w.energy_per_quantum = model.quanta.per_energy;
  std::fill(w.least_step, w.least_step + lane_width, std::numeric_limits<Real>::max());
  std::fill(w.least_block, w.least_block + lane_width, 0);
  return w;
}

/// Lowest id of the live elements that `is_bad(slot)`, or -1. All of them are asked, not just those of the block that
/// reported first: which elements share a block, or a rank, must not decide who is named.
template <class Test>
std::int64_t lowest_id(const PartStore& store, const Test& is_bad) {
  std::int64_t id = -1;
  for (int slot = 0; slot < store.n_slots(); ++slot)
    if (store.live(slot) && (id < 0 || store.id(slot) < id) && is_bad(slot)) id = store.id(slot);
  return id;
}

std::int64_t lowest_inverted(const Model& model, const PartModel& part) {
  const PartStore& store = *part.store;
  return lowest_id(store, [&](int slot) {
    CellCorners x;
    for (int k = 0; k < store.n_nodes(); ++k) x[static_cast<std::size_t>(k)] = model.nodes.x(store.node(slot, k));
    return !(part.input->element->volume(x) > 0.0);
  });
}

bool is_finite(const PartStore& store, PartStore::FieldIndex field, int slot) {
  const auto& values = store.field(field);
  bool finite = true;
  for (int c = 0; c < values.n_components; ++c) finite &= std::isfinite(values.at(slot, c));
  return finite;
}

/// Size of an element's stress; infinite where it is no number, or where what the element keeps of itself is none.
double stress_size(const PartStore& store, int slot) {
  double sum = std::fabs(store.field(PartStore::pressure).at(slot, 0));
  for (int c = 0; c < 6; ++c) sum += std::fabs(store.field(PartStore::deviator).at(slot, c));
  const bool finite = std::isfinite(sum) && is_finite(store, PartStore::element_state, slot);
  return finite ? sum : std::numeric_limits<double>::infinity();
}

std::int64_t most_stressed(const PartStore& store) {
  double most = 0.0;
  for (int slot = 0; slot < store.n_slots(); ++slot)
    if (store.live(slot)) most = std::max(most, stress_size(store, slot));
  return lowest_id(store, [&](int slot) { return stress_size(store, slot) == most; });
}

std::string described(const Law& law) {
  return fmt::format("{} {} ({})", law.description->kind, law.type, law.description->origin);
}

/// Which law has given an element what is no finite number, as the end of a sentence; empty where nobody can tell. A
/// deviator that is none spoils the energy, and with it the pressure: the material is asked first. Moduli are not kept,
/// but the bulk viscosity, which the element keeps, is made of them.
std::string law_at_fault(const PartModel& part, std::int64_t id) {
  const PartStore& store = *part.store;
  int slot = 0;
  while (slot < store.n_slots() && !(store.live(slot) && store.id(slot) == id)) ++slot;
  if (slot == store.n_slots()) return {};
  const MaterialInput& laws = *part.material;
  const bool deviator = is_finite(store, PartStore::deviator, slot),
             pressure = is_finite(store, PartStore::pressure, slot);
  if (!is_finite(store, PartStore::softening, slot))
    return ": an erosion criterion of its material has given it a factor of stress that is no finite number";
  const bool stress = deviator && pressure;
  if (stress && is_finite(store, PartStore::element_state, slot)) return {};
  if (laws.solid)
    return fmt::format(": the {} has given it {} that is no finite number", described(*laws.solid),
                       stress ? "a modulus" : "a stress");
  if (!deviator)
    return fmt::format(": the {} has given it a stress that is no finite number", described(*laws.strength));
  if (!pressure) return fmt::format(": the {} has given it a pressure that is no finite number", described(*laws.eos));
  return fmt::format(": the {} or the {} has given it a modulus that is no finite number", described(*laws.strength),
                     described(*laws.eos));
}

template <class Real>
void collect(const Model& model, const PartModel& part, const ElementArrays<Real>& w, ElementReport& report) {
  const PartStore& store = *part.store;
  for (int l = 0; l < lane_width; ++l) {
    const auto slot = static_cast<int>(w.least_block[l]) * lane_width + l;
    if (slot >= store.n_slots() || !store.live(slot)) continue;
    const std::int64_t id = store.id(slot);
    if (w.least_step[l] == std::numeric_limits<Real>::max()) continue;  // nothing alive
    const double step = w.least_step[l];
    if (step < report.least_step || (step == report.least_step && id < report.least_id)) {
      report.least_step = step;
      report.least_id = id;
    }
  }
  if (!report.trouble.empty()) return;
  if (w.inverted_block >= 0) {
    report.trouble_id = lowest_inverted(model, part);
    // The element may compute the volume in another way, with another round-off.
    if (report.trouble_id < 0)
      report.trouble_id = lowest_id(store, [&](int slot) { return slot / lane_width == w.inverted_block; });
    report.trouble = fmt::format(
        "{} is inverted (its volume is not positive); give its material the erosion criterion "
        "inversion, refine the mesh, or use more hourglass control;",
        element_name(model, report.trouble_id));
  } else if (w.bad_block >= 0) {
    report.trouble_id = most_stressed(store);
    const std::string law = law_at_fault(part, report.trouble_id);
    report.trouble = fmt::format("the forces of {} are not finite or beyond all bounds{}{}",
                                 element_name(model, report.trouble_id), law, law.empty() ? "" : ";");
  }
}

/// What a law has thrown stops the run, with the name of the law and of the element.
void note(const Model& model, const PartModel& part, const LawError& e, ElementReport& report) {
  const PartStore& store = *part.store;
  std::int64_t id = -1;
  for (int l = 0; l < lane_width; ++l) {
    const int slot = e.block * lane_width + l;
    if (slot >= store.n_slots() || !store.live(slot) || (e.lane >= 0 && l != e.lane)) continue;
    if (id < 0 || store.id(slot) < id) id = store.id(slot);
  }
  report.trouble_id = id;
  report.trouble =
      fmt::format("{} has thrown an exception for {}: {};", described(*e.law), element_name(model, id), e.what());
}

/// Calls `work`, and takes note of what a law throws.
template <class Work>
void guarded(const Model& model, const PartModel& part, ElementReport& report, const Work& work) {
  try {
    work();
  } catch (const LawError& e) {
    if (report.trouble.empty()) note(model, part, e, report);
  }
}

void initialise(const Element& element, ElementWork& w) { element.initialise(w); }
void initialise(const Element& element, SingleElementWork& w) { element.initialise_single(w); }
void add_forces(const Element& element, ElementWork& w) { element.add_internal_forces(w); }
void add_forces(const Element& element, SingleElementWork& w) { element.add_internal_forces_single(w); }

/// Calls `work(view)` with the view that the part's precision asks for.
template <class Work>
void with_view(Model& model, PartModel& part, const Work& work) {
  if (part.store->precision() == Precision::single_precision) {
    auto view = view_of<float>(model, part);
    const FlushDenormals while_it_works;
    work(view);
  } else {
    auto view = view_of<double>(model, part);
    work(view);
  }
}

}  // namespace

ElementReport initialise_elements(Model& model) {
  ElementReport report;
  report.least_step = std::numeric_limits<double>::max();
  const auto exposed_faces = count_exposed_faces(model);
  for (PartModel& part : model.parts) {
    with_view(model, part, [&](auto& w) {
      w.exposed_faces = exposed_faces[static_cast<std::size_t>(part.store->index())].data();
      guarded(model, part, report, [&] { initialise(*part.input->element, w); });
      collect(model, part, w, report);
    });
  }
  return report;
}

ElementReport add_internal_forces(Model& model, const Step& step, Erosion& erosion, Ledger& ledger) {
  ElementReport report;
  report.least_step = std::numeric_limits<double>::max();
  for (PartModel& part : model.parts) {
    with_view(model, part, [&](auto& w) {
      w.dt = step.dt;
      w.time = step.end();
      w.judge = erosion.judge(model, part.store->index(), step.cycle);
      w.failed = erosion.flags(part.store->index());
      guarded(model, part, report, [&] { add_forces(*part.input->element, w); });
      ledger.accounts.hourglass += w.hourglass_energy;
      collect(model, part, w, report);
    });
  }
  report.failed = erosion.any_failed();
  return report;
}

}  // namespace kerf
