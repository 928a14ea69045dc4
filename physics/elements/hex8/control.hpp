// What hex8.cpp asks of the kernel. The kernel is compiled once per precision, in double.cpp and single.cpp: each takes
// longer than all the rest of the plugin.
#pragma once

#include <kerf/element.hpp>

namespace kerf::hex8 {

/// What the user chooses; see hex8.cpp.
struct Control {
  bool free_element = false, stiffness = false;  // stable step of a free element; hourglass control by stiffness
  bool limited_viscosity = false;  // linear viscosity at shocks only
  double hourglass_coefficient = 0.0, linear_viscosity = 0.0, quadratic_viscosity = 0.0;
};

/// As Element::initialise and Element::add_internal_forces.
void initialise(const Control& control, ElementWork& work);
void initialise(const Control& control, SingleElementWork& work);
void add_internal_forces(const Control& control, ElementWork& work);
void add_internal_forces(const Control& control, SingleElementWork& work);

}  // namespace kerf::hex8
