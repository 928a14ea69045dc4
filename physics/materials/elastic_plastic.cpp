// Elastic-plastic strength: J2 flow with linear isotropic hardening.
//
// Sources: M.L. Wilkins, "Calculation of elastic-plastic flow", Methods in Computational Physics 3 (1964) 211-263;
// J.C. Simo & T.J.R. Hughes, Computational Inelasticity (1998), box 3.1 (radial return).
#include <kerf/material.hpp>

namespace {

using namespace kerf;

/// Flow stress Y(ep) = Y0 + Ep ep of the equivalent plastic strain ep; radial return to it.
struct ElasticPlastic final : PointwiseMaterial<ElasticPlastic> {
  double G = 0.0, Y0 = 0.0;  // [Pa]
  // Negative: not given [Pa]
  double hardening_modulus = -1.0, tangent_modulus = -1.0, bulk_modulus = -1.0, youngs_modulus = -1.0;

  struct State {
    double effective_plastic_strain;
  };
  static constexpr bool computes_in_single = true;

  static void describe(Schema<ElasticPlastic>& s) {
    s.real(&ElasticPlastic::G, "shear_modulus", "Pa", positive, "elastic shear modulus");
    s.real(&ElasticPlastic::Y0, "yield_stress", "Pa", positive, "initial yield stress in uniaxial tension");
    s.real(&ElasticPlastic::hardening_modulus, "hardening_modulus", "Pa", non_negative,
           "slope of yield stress over plastic strain, 0 where neither this nor tangent_modulus is given")
        .optional();
    s.real(&ElasticPlastic::tangent_modulus, "tangent_modulus", "Pa", non_negative,
           "slope of stress over total strain in uniaxial tension beyond yield; needs bulk_modulus or youngs_modulus")
        .optional();
    s.real(&ElasticPlastic::bulk_modulus, "bulk_modulus", "Pa", positive,
           "only turns tangent_modulus into the hardening modulus; the pressure is the business of eos")
        .optional();
    s.real(&ElasticPlastic::youngs_modulus, "youngs_modulus", "Pa", positive,
           "only turns tangent_modulus into the hardening modulus, in place of bulk_modulus")
        .optional();
    s.rule("hardening_modulus", "give either hardening_modulus or tangent_modulus, not both",
           [](const ElasticPlastic& m) { return !(given(m.hardening_modulus) && given(m.tangent_modulus)); });
    s.rule("tangent_modulus",
           "tangent_modulus needs either bulk_modulus or youngs_modulus beside it, and not both: the hardening modulus "
           "is E Et / (E - Et)",
           [](const ElasticPlastic& m) {
             return !given(m.tangent_modulus) || given(m.bulk_modulus) != given(m.youngs_modulus);
           });
    s.rule("bulk_modulus", "bulk_modulus is used only together with tangent_modulus; remove it here",
           [](const ElasticPlastic& m) { return !given(m.bulk_modulus) || given(m.tangent_modulus); });
    s.rule("youngs_modulus", "youngs_modulus is used only together with tangent_modulus; remove it here",
           [](const ElasticPlastic& m) { return !given(m.youngs_modulus) || given(m.tangent_modulus); });
    s.rule("youngs_modulus", "youngs_modulus must be less than three times shear_modulus (Poisson's ratio below 0.5)",
           [](const ElasticPlastic& m) { return m.youngs_modulus < 3.0 * m.G; });
    s.rule("tangent_modulus", "tangent_modulus must be less than Young's modulus", [](const ElasticPlastic& m) {
      const bool has_young = given(m.bulk_modulus) || given(m.youngs_modulus);
      return !given(m.tangent_modulus) || !has_young || m.tangent_modulus < m.young();
    });
    s.state(&State::effective_plastic_strain, "effective_plastic_strain", "-", 0.0,
            "equivalent plastic strain, the time integral of sqrt(2/3 Dp:Dp)")
        .within(non_negative);
  }

  template <class Real>
  void update_point(const PointInputOf<Real>& in, SymTensorOf<Real>& stress, State& state, Real& shear_modulus) const {
    const double Ep = plastic_modulus();
    const auto slope = static_cast<Real>(3.0 * G), hardening = static_cast<Real>(Ep),
               per_slope = static_cast<Real>(1.0 / (3.0 * G + Ep));
    // (i) elastic predictor
    const SymTensorOf<Real> trial = stress + static_cast<Real>(2.0 * G) * deviator(in.strain_increment);
    const Real q = von_mises(trial);
    // (ii) admissibility: a point within the yield surface keeps d = 0
    const auto old_strain = static_cast<Real>(state.effective_plastic_strain);
    const auto yield_stress = static_cast<Real>(Y0), tolerance = static_cast<Real>(round_off<Real> * Y0);
    const auto flow_stress = [&](Real plastic_strain) { return yield_stress + hardening * plastic_strain; };
    const bool yields = q > flow_stress(old_strain);
    // (iii) plastic increment d with q - 3 G d = Y(ep + d). Newton's method solves a linear flow stress in one
    // iteration; the second is for laws with curvature and removes the round-off of the first.
    Real d = 0;
    for (int i = 0; i < 2; ++i) {
      const Real residual = q - slope * d - flow_stress(old_strain + d);
      const bool moves = yields & (std::fabs(residual) > tolerance);
      d += select(moves, residual * per_slope, Real(0));
    }
    // (iv) radial return
    stress = (1 - slope * d / (q + tiny<Real>)) * trial;
    state.effective_plastic_strain += d;
    shear_modulus = static_cast<Real>(G);
  }

 private:
  static bool given(double value) { return value >= 0.0; }
  /// Of stresses, as a share.
  template <class Real>
  static constexpr double round_off = std::is_same_v<Real, float> ? 1e-6 : 1e-14;
  double young() const {
    const double from_bulk = 9.0 * bulk_modulus * G / (3.0 * bulk_modulus + G);
    return select(given(youngs_modulus), youngs_modulus, from_bulk);
  }
  double plastic_modulus() const {
    const double E = young(), Et = max_of(tangent_modulus, 0.0);
    const double from_tangent = E * Et / (E - Et);
    return select(given(hardening_modulus), hardening_modulus, from_tangent);
  }
};

}  // namespace

KERF_MATERIAL(ElasticPlastic, "elastic_plastic", "J2 plasticity with linear isotropic hardening")
