// Energy that laws hold back: the chemical energy of explosives that have not burnt.
#pragma once

#include "model/model.hpp"

namespace kerf {

/// Whether any law of a part holds back energy.
bool holds_energy(const PartModel& part);
/// What the laws of an element hold back of its initial energy [J]. Pre: the slot holds an element.
double held_energy(const PartModel& part, int slot);
/// Whether a law of the part will set its material in motion by itself.
bool acts_by_itself(const PartModel& part);

}  // namespace kerf
