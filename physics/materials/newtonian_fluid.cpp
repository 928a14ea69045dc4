// Newtonian fluid: shear stress in proportion to the rate of deformation.
//
// Source: L.D. Landau & E.M. Lifshitz, Fluid Mechanics (1987), section 15. The bound of the step is that of central
// differences with damping: T. Belytschko, W.K. Liu & B. Moran, Nonlinear Finite Elements (2000), section 6.2.
#include <kerf/material.hpp>

namespace {

using namespace kerf;

/// s = 2 mu D' with the deviator D' of the rate of deformation in the middle of the step; what the stress was before
/// does not matter.
struct NewtonianFluid final : PointwiseMaterial<NewtonianFluid> {
  double mu = 0.0;  // [Pa s]
  using State = NoVariables;
  static constexpr bool computes_in_single = true;

  static void describe(Schema<NewtonianFluid>& s) {
    s.real(&NewtonianFluid::mu, "viscosity", "Pa s", non_negative, "dynamic viscosity; without any, as hydrodynamic")
        .usual(between(0.0, 1e6));
  }
  /// For the stable step, which is bounded by rho h^2/(2 (4/3) mu) where viscosity dominates.
  double viscosity() const override { return mu; }

  template <class Real>
  void update_point(const PointInputOf<Real>& in, SymTensorOf<Real>& stress, State&, Real& shear_modulus) const {
    const bool moves = in.dt > Real(0);  // not before the first step
    const Real scale = select(moves, static_cast<Real>(2.0 * mu) / select(moves, in.dt, Real(1)), Real(0));
    stress = scale * deviator(in.strain_increment);
    shear_modulus = 0;
  }
};

}  // namespace

KERF_MATERIAL(NewtonianFluid, "newtonian_fluid", "viscous fluid: shear stress in proportion to the rate of deformation")
