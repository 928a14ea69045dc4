// What hex8.cpp asks of the kernel. The kernel is compiled once per precision, in double.cpp and single.cpp: each takes
// longer than all the rest of the plugin.
#pragma once

#include <kerf/solid_element.hpp>

namespace kerf::hex8 {

using State = SolidState<12>;

/// What the user chooses; see hex8.cpp. Hourglass control by stiffness is what asks for the elastic share.
struct Control {
  SolidControl solid;
  double hourglass_coefficient = 0.0;
};

/// As Element::initialise and Element::add_internal_forces.
void initialise(const Control& control, ElementWork& work);
void initialise(const Control& control, SingleElementWork& work);
void add_internal_forces(const Control& control, ElementWork& work);
void add_internal_forces(const Control& control, SingleElementWork& work);

}  // namespace kerf::hex8
