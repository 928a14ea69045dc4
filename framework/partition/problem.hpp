// What a partitioner is asked about a model, and the check of what it answers.
#pragma once

#include <cstdint>
#include <vector>

#include "kerf/partitioner.hpp"
#include "model/model.hpp"

namespace kerf {

/// The live elements of this rank, part by part and slot by slot, with what the partitioner needs. Collective.
PartitionProblem problem_of(Model& model, const Partitioner& partitioner, int n_parts);

/// Work of contact of each live element, in the order of problem_of(): each node of a contact surface counts 1, in
/// equal shares for the exterior faces round it. Collective.
std::vector<double> contact_work(Model& model);

/// Asks a partitioner. Throws InputError, on all ranks, with its complaints, and PhysicsError where it does not answer
/// for each element with a part that is asked for. Collective.
std::vector<int> find_parts(Partitioner& partitioner, const PartitionProblem& problem);

}  // namespace kerf
