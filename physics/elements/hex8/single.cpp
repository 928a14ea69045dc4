// The kernel of hex8 in single precision.
#include "kernel.hpp"

namespace kerf::hex8 {

void initialise(const Control& control, SingleElementWork& work) { Kernel<float>(control).initialise(work); }

void add_internal_forces(const Control& control, SingleElementWork& work) { Kernel<float>(control).run(work); }

}  // namespace kerf::hex8
