// One sentence when the program crashes: which library, which function, and what was being done.
#pragma once

namespace kerf {

/// Installs handlers of the signals of a crash and of exceptions that nobody catches. They write a sentence and leave
/// the rest to the system: the program ends as it would have, by the signal. To be called once, from the thread that
/// computes, before MPI starts: MPI leaves handlers alone that it finds.
void report_crashes();

}  // namespace kerf
