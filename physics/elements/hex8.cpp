// Eight-node hexahedron with one integration point: mean-gradient strain, Jaumann rate through the
// Hughes-Winget rotation, viscous or stiffness hourglass control, bulk viscosity.
//
// Sources: D.P. Flanagan & T. Belytschko, "A uniform strain hexahedron and quadrilateral with orthogonal
// hourglass control", IJNME 17 (1981) 679-706; T.J.R. Hughes & J. Winget, "Finite rotation effects in
// numerical integration of rate constitutive equations", IJNME 15 (1980) 1862-1867; J. von Neumann &
// R.D. Richtmyer, J. Appl. Phys. 21 (1950) 232 and R. Landshoff, LA-1930 (1955) for the bulk viscosity;
// D.P. Flanagan & T. Belytschko, J. Appl. Mech. 51 (1984) 35-40 for the eigenvalue bound of the time step.
#include "hex8/control.hpp"
#include "hex8/volume.hpp"

namespace {

using namespace kerf;

struct Hex8 final : SolidElement {
  const Shape& shape() const override { return hexahedron; }
  /// The volume of the mean gradient.
  double volume(const CellCorners& x) const override { return hex8::volume_of(x); }
  /// Volume, mean gradient and hourglass modes of a collapsed cell follow from those of its corners, one by one.
  bool takes_collapsed_cells() const override { return true; }

  using State = hex8::State;
  std::string hourglass;
  double hourglass_coefficient = 0.0;

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
    describe_solid<State>(s);
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
    hex8::Control all{.solid = solid_control(), .hourglass_coefficient = hourglass_coefficient};
    all.solid.finds_elastic_share = hourglass == "stiffness";
    return all;
  }
};

}  // namespace

KERF_ELEMENT(Hex8, "hex8", "eight-node hexahedron, one integration point, hourglass control, bulk viscosity")
