// What laws have to say about the parts that they are used in.
#pragma once

#include <string>
#include <vector>

#include "model/model.hpp"

namespace kerf {

/// The warnings of all laws of the kind WarningLaw, as lines "origin: warning: sentence". Collective.
std::vector<std::string> law_warnings(const Model& model);

}  // namespace kerf
