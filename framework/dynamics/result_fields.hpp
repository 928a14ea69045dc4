// Turns the stores into the fields that results.vtkhdf holds.
#pragma once

#include <string>

#include "output/results.hpp"
#include "state/model.hpp"

namespace kerf {

/// Global connectivity of the undeformed mesh: this rank's even share of all elements. Collective.
void write_topology(const Model& model, ResultsWriter& results);

/// One frame with the fields that the input names. Collective.
void write_frame(const Model& model, const OutputInput& output, double time, ResultsWriter& results);

}  // namespace kerf
