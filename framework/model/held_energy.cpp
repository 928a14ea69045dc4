// Asks the laws that are of the kind EnergyHolder.
#include "model/held_energy.hpp"

#include <algorithm>

#include "kerf/law_use.hpp"

namespace kerf {

namespace {

/// Calls `work(holder, field of its state)` for the laws of the stress.
template <class Work>
void each_holder(const PartModel& part, const Work& work) {
  const auto* of_stress = dynamic_cast<const EnergyHolder*>(&part.material->stress_law());
  if (of_stress != nullptr) work(*of_stress, PartStore::material_state);
  const auto* of_pressure = dynamic_cast<const EnergyHolder*>(part.material->eos.get());
  if (of_pressure != nullptr) work(*of_pressure, PartStore::eos_state);
}

}  // namespace

bool holds_energy(const PartModel& part) {
  bool any = false;
  each_holder(part, [&](const EnergyHolder&, PartStore::FieldIndex) { any = true; });
  return any;
}

double held_energy(const PartModel& part, int slot) {
  double sum = 0.0;
  std::vector<double> state;
  each_holder(part, [&](const EnergyHolder& law, PartStore::FieldIndex f) {
    const Field& field = part.store->field(f);
    state.resize(static_cast<std::size_t>(field.n_components));
    for (int c = 0; c < field.n_components; ++c) state[static_cast<std::size_t>(c)] = field.at(slot, c);
    sum += law.energy_held(state) * (part.store->field(PartStore::mass).at(slot, 0) / part.material->density);
  });
  return sum;
}

bool acts_by_itself(const PartModel& part) {
  bool any = false;
  each_holder(part, [&](const EnergyHolder& law, PartStore::FieldIndex) { any = any || law.acts_by_itself(); });
  return any;
}

}  // namespace kerf
