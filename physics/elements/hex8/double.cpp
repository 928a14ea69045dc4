// The kernel of hex8 in double precision.
#include "kernel.hpp"

namespace kerf::hex8 {

void initialise(const Control& control, ElementWork& work) { Kernel<double>(control).initialise(work); }

void add_internal_forces(const Control& control, ElementWork& work) { Kernel<double>(control).run(work); }

}  // namespace kerf::hex8
