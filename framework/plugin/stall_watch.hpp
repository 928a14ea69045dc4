// Stops a program that stands still: a law that never returns would otherwise burn its hours on all ranks.
#pragma once

#include "core/activity.hpp"

namespace kerf {

/// Starts a thread that watches the beats of core/activity.hpp. Where none comes for the limit of the present task, the
/// thread that computes is interrupted, writes which library it is in, and ends the program with the task's exit code.
/// A rank that waits for others in MPI speaks after more than twice the limit only: the one it waits for comes first.
/// To be called once, from the thread that computes.
void watch_for_stalls();

/// How long one step of loading a plugin may take, or the making of one object: KERF_LOAD_LIMIT of the environment, or
/// 60 [s]; 0 for no limit. Throws InputError where the environment says something else than a number of seconds.
activity::Limit load_limit();

}  // namespace kerf
