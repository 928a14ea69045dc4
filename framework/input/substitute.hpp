// Named values of the input: `parameters: {h: 0.8 mm}` at the top, `$h` wherever a value may stand.
#pragma once

#include "input/document.hpp"

namespace kerf {

/// Whether a node is written as `$name`. After the substitution only those are left that have been reported.
bool names_a_parameter(const Node& node);

/// Puts the values of the block `parameters` where they are named. A value keeps the place where it is used as its
/// origin. Unknown names are errors; that the block holds single values is left to the binder.
void substitute_parameters(Node& root, Diagnostics& diagnostics);

}  // namespace kerf
