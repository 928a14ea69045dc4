// What is wrong with a condition of variables that an erosion criterion takes from the user.
#pragma once

#include <map>
#include <string>
#include <vector>

#include "kerf/law.hpp"
#include "kerf/law_use.hpp"

namespace kerf {

/// Unknown and ambiguous names, dimensions that do not fit, and conditions that name no variable. `units` has the unit
/// of every variable that laws of the material or elements keep, by name.
std::vector<ReadComplaint> complaints_about(const VariableCondition& condition,
                                            const std::map<std::string, std::string>& units);

}  // namespace kerf
