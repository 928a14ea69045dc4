// A fingerprint of the state that does not depend on the decomposition.
#pragma once

#include <string>

#include "model/model.hpp"

namespace kerf {

/// Hexadecimal digest over global ids, positions, velocities, masses and all fields of live elements and nodes:
/// each entity's bits are mixed into one number, and the numbers are added up. Collective.
std::string state_hash(const Model& model);

}  // namespace kerf
