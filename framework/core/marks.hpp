// Marks that the program sets for libraries which watch its messages, through MPI_Pcontrol. Such a library may be
// loaded or not: MPI itself does nothing at a mark.
#pragma once

#include <mpi.h>

namespace kerf::marks {

/// Levels of MPI_Pcontrol. Tools use 0 to 2.
inline constexpr int cycle = 1000;  // with one more argument, the number of the cycle, as int
inline constexpr int phase = 2000;  // and more: 2001 is the first phase of timer_table, 2000 is none
inline constexpr int beside = 3000;  // the same for phases that are no part of a step: set-up, output, re-balancing

inline int present = phase;  // the last mark of a phase

inline void begin_cycle(long long number) { MPI_Pcontrol(cycle, static_cast<int>(number)); }
inline void enter(int mark) {
  present = mark;
  MPI_Pcontrol(mark);
}

}  // namespace kerf::marks
