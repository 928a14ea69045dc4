// Where a node of the undeformed model is.
#pragma once

#include <cstdint>

#include "model/model.hpp"

namespace kerf {

/// The undeformed, placed position of a node of the model [m].
Vec3 reference_position(const Model& model, std::int64_t node);

}  // namespace kerf
