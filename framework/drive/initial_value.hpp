// Values of state variables before the first step, as a drive file and a sample of a law give them.
#pragma once

#include <string>
#include <vector>

#include "kerf/law.hpp"

namespace kerf {

/// The value that `text` says, with its unit, of the variable `name` of one of the laws. `owner` is whose laws they
/// are, for messages; `others` are further names that may be given. Throws std::runtime_error where no law keeps the
/// variable, or the law does not take the value.
double initial_value(const std::vector<const Law*>& laws, const std::string& owner, const std::string& name,
                     const std::string& text, std::vector<std::string> others = {});

}  // namespace kerf
