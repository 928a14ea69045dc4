// The keys of the block `balance` that belong to a policy now.
#pragma once

#include "core/diagnostics.hpp"
#include "input/document.hpp"

namespace kerf {

/// Puts threshold, check_interval, cooldown and cost_factor, where an input gives them beside the policy, into a policy
/// of the type threshold, with a warning for each; they keep the places where they were written. Beside a policy they
/// are errors.
void move_balance_keys(Node& root, Diagnostics& diagnostics);

}  // namespace kerf
