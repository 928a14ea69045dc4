// What elements hold before the first step: what their laws say of the place, and what the input sets.
#pragma once

#include "model/model.hpp"

namespace kerf {

/// Bulk and shear modulus and pressure of the undeformed material, asked of its laws, and the stiffest that the initial
/// energies of the input make of it. Throws InputError where a law throws.
void ask_moduli(PartModel& part, const ModelInput& input);

/// Lets the laws of a part change the state in the record of a fresh element. Throws InputError where one throws.
void initialise_laws(const PartModel& part, const InitialPoint& point, double* record);

/// Sets the values of the input's block `initial_state`, in its order. Throws InputError where an entry reaches no
/// element. Collective.
void apply_initial_states(Model& model);

}  // namespace kerf
