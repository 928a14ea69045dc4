// What a user should look at before a run: models that can be computed but hardly mean what they say.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "model/model.hpp"
#include "review/initial_overlap.hpp"

namespace kerf {

/// Lines "origin: warning: what; what to do" about the model at time zero, the same on all ranks. `load_targets` tells
/// on how many nodes or facets each load of the input acts. Pre: the forces of time zero are on the nodes. Collective.
std::vector<std::string> model_warnings(Model& model, const ContactCover& cover,
                                        const std::vector<std::int64_t>& load_targets);

}  // namespace kerf
