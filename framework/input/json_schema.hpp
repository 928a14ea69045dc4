// Writes a JSON schema of the input, for editors that complete and check while a user types.
#pragma once

#include <string>

#include "plugin/registry.hpp"

namespace kerf {

/// Draft 2020-12, of the whole input file with every registered type.
std::string json_schema(const Registry& registry);

}  // namespace kerf
