// What an earlier, coarser run of a model tells about the work of its elements.
#pragma once

#include <string>
#include <vector>

#include "model/model.hpp"

namespace kerf {

/// The share of the run, from 0 to 1, that each live element of this rank is expected to live, in the order of the
/// stores: that of the element of the coarse run, in `folder`, whose undeformed centre is nearest, in the same part.
/// `origin` is the place that names the folder. Pre: the model is undeformed. Throws InputError, on all ranks, where
/// the folder holds no run of this model. Collective.
std::vector<double> expected_lives(const Model& model, const std::string& folder, const std::string& origin);

}  // namespace kerf
