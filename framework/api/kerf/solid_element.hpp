// What all elements that SolidKernel computes declare: bulk viscosity, bound of the stable step, and what they keep.
#pragma once

#include <cstddef>
#include <string>

#include "kerf/element.hpp"

namespace kerf {

/// What SolidKernel has to know of the user's choices and of the element.
struct SolidControl {
  bool free_element = false;  // stable step of a free element everywhere
  bool limited_viscosity = true;  // linear viscosity at shocks only
  bool finds_elastic_share = false;  // fills Piece::elastic_share and Piece::solid
  double linear_viscosity = 0.06, quadratic_viscosity = 1.5;  // [-]
};

/// Place of a member of an element's State among its doubles, for `offsetof`.
constexpr int place_in_state(std::size_t offset) { return static_cast<int>(offset / sizeof(double)); }

/// What an element keeps beside stress and energies. `n` counts the values of hourglass control.
template <int n>
struct SolidState {
  double bulk_viscosity_pressure, resistance[n], free_share, dilatation_rate, shock_sensor;
};
template <>
struct SolidState<0> {
  double bulk_viscosity_pressure, free_share, dilatation_rate, shock_sensor;
};

/// Base of an element that is computed by SolidKernel. Its State is a SolidState, or another struct with these members.
class SolidElement : public Element {
 protected:
  SolidControl solid_control() const {
    return {.free_element = stable_step_ == "free_element",
            .limited_viscosity = linear_viscosity_limiter_,
            .linear_viscosity = linear_viscosity_,
            .quadratic_viscosity = quadratic_viscosity_};
  }

  /// Declares parameters of bulk viscosity and stable step, and the members of SolidState in their order.
  template <class State, class S>
  static void describe_solid(S& s) {
    s.real(&SolidElement::linear_viscosity_, "linear_viscosity", "-", between(0.0, 2.0),
           "linear bulk viscosity coefficient")
        .by_default("0.06");
    s.boolean(&SolidElement::linear_viscosity_limiter_, "linear_viscosity_limiter",
              "linear bulk viscosity at shocks and behind them only, not in smooth flow")
        .by_default("true");
    s.real(&SolidElement::quadratic_viscosity_, "quadratic_viscosity", "-", between(0.0, 10.0),
           "quadratic bulk viscosity coefficient")
        .by_default("1.5");
    s.choice(&SolidElement::stable_step_, "stable_step", {"plane_wave", "free_element"},
             "bound of the time step: a plane wave's, less where cells lack neighbours, or that of a free element "
             "everywhere")
        .by_default("plane_wave");
    s.state(&State::bulk_viscosity_pressure, "bulk_viscosity_pressure", "Pa", 0.0, "bulk viscosity pressure");
    if constexpr (requires { &State::resistance; })
      s.state(&State::resistance, "hourglass_resistance", "N", 0.0, "generalised hourglass force");
    s.state(&State::free_share, "free_share", "-", 0.0,
            "freedom to breathe for want of neighbours: 1 for an element that stands alone");
    s.state(&State::dilatation_rate, "dilatation_rate", "1/s", 0.0, "rate of the volumetric strain in the last step");
    s.state(&State::shock_sensor, "shock_sensor", "-", 0.0,
            "how abruptly the dilatation rate has changed of late: 1 or more at shocks, where all of the linear "
            "viscosity acts");
  }

 private:
  std::string stable_step_;
  double linear_viscosity_ = 0.0, quadratic_viscosity_ = 0.0;
  bool linear_viscosity_limiter_ = true;
};

}  // namespace kerf
