// Says in words what a parameter takes, for messages and for the reference manual alike.
#pragma once

#include <string>
#include <vector>

#include "kerf/schema.hpp"

namespace kerf {

/// "a velocity in m/s", "one of any, all, at_least", "a map with `type:`, see `kerf list eos`".
std::string expectation(const Parameter& parameter);

/// "greater than 0 Pa", "from 0 to 1"; empty where every value is allowed.
std::string range_text(const Range& range, const std::string& unit);

/// One word for the kind, for tables: "real", "list of blocks".
std::string kind_text(const Parameter& parameter);

/// "a, b and c"; empty for an empty list.
std::string listed(const std::vector<std::string>& names, const std::string& last = " and ");

/// "; did you mean `near`?", or the whole list where no name is near, with `what` naming it; empty where there are no
/// candidates.
std::string suggestion(const std::string& name, const std::vector<std::string>& candidates, const std::string& what);

}  // namespace kerf
