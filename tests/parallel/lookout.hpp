// Compares the contact forces of a running simulation with those of brute force, bit for bit.
#pragma once

#include <cstdint>
#include <string>

#include "dynamics/simulation.hpp"

namespace kerf::test {

struct ForceComparison {
  std::int64_t n_looks = 0, n_loaded = 0;  // looks, and nodes with a force, added up over looks
  std::int64_t n_edges = 0;  // touches of edges with edges, added up over looks
  std::int64_t n_different = 0;  // looks with any difference
  std::string first_difference;  // sentence about it
};

/// Compares the forces of the first contact definition of this step with the law asked about all nodes and all
/// facets. To be called from StepObserver::after_forces; complete on rank 0. Collective.
void compare_contact_forces(const Simulation& simulation, const Step& step, ForceComparison& comparison);

}  // namespace kerf::test
