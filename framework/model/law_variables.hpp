// What the elements of a material keep for its laws, and for the combination of its criteria.
#pragma once

#include "input/model_input.hpp"
#include "model/part_store.hpp"

namespace kerf {

/// `first_criterion_state` is set to where the state of the first criterion begins in the erosion state.
PartStore::Variables variables_of(const MaterialInput& material, int& first_criterion_state);

}  // namespace kerf
