// Runs the element kernels of all parts and gathers what they report; makes nodal sums equal on all copies.
#pragma once

#include <cstdint>
#include <limits>
#include <string>

#include "dynamics/erosion.hpp"
#include "dynamics/ledger.hpp"
#include "dynamics/step.hpp"
#include "state/model.hpp"

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

/// Adds the copies of every node and gives all of them the sum. `values` has `stride` entries per node, of which
/// the first min(stride, 3) travel. Collective.
void sum_over_copies(const Model& model, std::int64_t* values, int stride);
/// Gives every copy of a node on other ranks the values of its owner. Collective.
void copy_to_ghosts(const Model& model, std::int64_t* values, int stride);

/// "element 17 (part rod, rank 0)".
std::string element_name(const Model& model, int part, std::int64_t id);

}  // namespace kerf
