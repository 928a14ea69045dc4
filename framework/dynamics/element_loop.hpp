// Runs the element kernels of all parts and gathers what they report; makes nodal sums equal on all copies.
#pragma once

#include <cstdint>
#include <limits>
#include <string>

#include "erosion/erosion.hpp"
#include "model/ledger.hpp"
#include "model/model.hpp"
#include "model/step.hpp"

namespace kerf {

/// What the elements of this rank report of a step.
struct ElementReport {
  double least_step = 0.0;  // stable step without safety factor [s]
  std::int64_t least_id = -1;  // an element that sets it; of several, which one may depend on who shares its block
  std::string trouble;  // sentence about an element that cannot go on; empty where all is well
  std::int64_t trouble_id =
      std::numeric_limits<std::int64_t>::max();  // that element; of several ranks, the lowest speaks
  bool failed = false;  // some element is to be eroded
};

/// Volumes, pressure and stable step at time zero. Local.
ElementReport initialise_elements(Model& model);

/// Strain, stress, forces and verdicts of all elements. Local.
ElementReport add_internal_forces(Model& model, const Step& step, Erosion& erosion, Ledger& ledger);
}  // namespace kerf
