// What a partitioner is asked about a model, and the check of what it answers.
#pragma once

#include <cstdint>
#include <optional>
#include <vector>

#include "kerf/partitioner.hpp"
#include "model/model.hpp"

namespace kerf {

/// The live elements of this rank, part by part and slot by slot, with what the partitioner needs. `work` is that of
/// each of them; without it, the work model says what they cost without contact. Collective.
PartitionProblem problem_of(Model& model, const Partitioner& partitioner, int n_parts,
                            std::optional<std::vector<double>> work = {});

/// Work of contact of each live element, in the order of problem_of(): each node of a contact surface counts
/// `node_work`, which has an entry for every local node and is the same on all copies, or 1 without it. A node's work
/// is split in equal shares for the exterior faces round it. Collective.
std::vector<double> contact_work(Model& model, const std::vector<double>& node_work = {});

/// Work of each live element in a cycle, by the work model, in the order of problem_of(), in element cycles. Where
/// contact goes with the elements, its work is contained; `n_candidates` are those of the local nodes that this rank
/// owns, or empty where they are not known. Collective.
std::vector<double> element_work(Model& model, const std::vector<std::int64_t>& n_candidates);

/// Asks a partitioner. Throws InputError, on all ranks, with its complaints, and PhysicsError where it does not answer
/// for each element with a part that is asked for. Collective.
std::vector<int> find_parts(Partitioner& partitioner, const PartitionProblem& problem);

}  // namespace kerf
