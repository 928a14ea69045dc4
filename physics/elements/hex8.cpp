// Eight-node hexahedron with one integration point: mean-gradient strain, Jaumann rate through the
// Hughes-Winget rotation, viscous or stiffness hourglass control, bulk viscosity.
//
// Sources: D.P. Flanagan & T. Belytschko, "A uniform strain hexahedron and quadrilateral with orthogonal
// hourglass control", IJNME 17 (1981) 679-706; T.J.R. Hughes & J. Winget, "Finite rotation effects in
// numerical integration of rate constitutive equations", IJNME 15 (1980) 1862-1867; J. von Neumann &
// R.D. Richtmyer, J. Appl. Phys. 21 (1950) 232 and R. Landshoff, LA-1930 (1955) for the bulk viscosity;
// D.P. Flanagan & T. Belytschko, J. Appl. Mech. 51 (1984) 35-40 for the eigenvalue bound of the time step.
#include <algorithm>

#include "hex8/control.hpp"

namespace {

using namespace kerf;

struct Hex8 final : Element {
  const Shape& shape() const override { return hexahedron; }
  std::string hourglass, stable_step;
  double hourglass_coefficient = 0.0, linear_viscosity = 0.0, quadratic_viscosity = 0.0;
  bool linear_viscosity_limiter = true;

  struct State {
    double bulk_viscosity_pressure, resistance[12], free_share, dilatation_rate, shock_sensor;
  };

  static void describe(Schema<Hex8>& s) {
    s.choice(
         &Hex8::hourglass, "hourglass", {"viscous", "stiffness"},
         "resistance to hourglass modes: proportional to their velocity, or to their displacement (in fluids always "
         "to their velocity)")
        .by_default("stiffness");
    s.real(&Hex8::hourglass_coefficient, "hourglass_coefficient", "-", between(0.0, 0.5),
           "strength of the hourglass control")
        .by_default("0.05")
        .usual(between(0.01, 0.1));
    s.real(&Hex8::linear_viscosity, "linear_viscosity", "-", between(0.0, 2.0), "linear bulk viscosity coefficient")
        .by_default("0.06");
    s.boolean(&Hex8::linear_viscosity_limiter, "linear_viscosity_limiter",
              "linear bulk viscosity at shocks and behind them only, not in smooth flow")
        .by_default("true");
    s.real(&Hex8::quadratic_viscosity, "quadratic_viscosity", "-", between(0.0, 10.0),
           "quadratic bulk viscosity coefficient")
        .by_default("1.5");
    s.choice(&Hex8::stable_step, "stable_step", {"plane_wave", "free_element"},
             "bound of the time step: a plane wave's, less where cells lack neighbours, or that of a free element "
             "everywhere")
        .by_default("plane_wave");
    s.state(&State::bulk_viscosity_pressure, "bulk_viscosity_pressure", "Pa", 0.0, "bulk viscosity pressure");
    s.state(&State::free_share, "free_share", "-", 0.0,
            "freedom to breathe for want of neighbours: 1 for an element that stands alone");
    s.state(&State::dilatation_rate, "dilatation_rate", "1/s", 0.0, "rate of the volumetric strain in the last step");
    s.state(&State::shock_sensor, "shock_sensor", "-", 0.0,
            "how abruptly the dilatation rate has changed of late: 1 or more at shocks, where all of the linear "
            "viscosity acts");
  }

  std::vector<StateVariable> state_variables() const override {
    std::vector<StateVariable> all = description->state;
    for (int i = 0; i < 12; ++i)
      all.push_back({"hourglass_resistance_" + std::to_string(i + 1), "N", "generalised hourglass force", 0.0, 1 + i});
    // In the order of the members, since the place in the list is the place in memory.
    std::sort(all.begin(), all.end(), [](const auto& a, const auto& b) { return a.index < b.index; });
    return all;
  }

  void add_internal_forces(ElementWork& work) const override { hex8::add_internal_forces(control(), work); }
  void initialise(ElementWork& work) const override { hex8::initialise(control(), work); }

  bool computes_in_single() const override { return true; }
  void add_internal_forces_single(SingleElementWork& work) const override {
    hex8::add_internal_forces(control(), work);
  }
  void initialise_single(SingleElementWork& work) const override { hex8::initialise(control(), work); }

 private:
  hex8::Control control() const {
    return {.free_element = stable_step == "free_element",
            .stiffness = hourglass == "stiffness",
            .limited_viscosity = linear_viscosity_limiter,
            .hourglass_coefficient = hourglass_coefficient,
            .linear_viscosity = linear_viscosity,
            .quadratic_viscosity = quadratic_viscosity};
  }
};

}  // namespace

KERF_ELEMENT(Hex8, "hex8", "eight-node hexahedron, one integration point, hourglass control, bulk viscosity")
