// Elastic-plastic strength whose yield stress grows with the strain rate by the power law of Cowper and Symonds.
//
// Sources: G.R. Cowper & P.S. Symonds, "Strain hardening and strain rate effects in the impact loading of cantilever
// beams", Brown University, Applied Mathematics Report 28 (1957); N. Jones, Structural Impact (1989), section 8.3;
// J.C. Simo & T.J.R. Hughes, Computational Inelasticity (1998), box 3.2 (radial return with mixed hardening).
#include <kerf/material.hpp>

#include <bit>

namespace {

using namespace kerf;

/// Flow where the equivalent of s - a reaches Y (1 + x), or Y + Y0 x, with Y = Y0 + beta Ep ep, x = (rate/C)^(1/P), and
/// the back stress a of mixed_hardening, which does not depend on the rate.
///
/// A material for blocks rather than points, so that Newton's method stops when all points of a block have converged,
/// and does not start where none yields.
struct CowperSymonds final : Material {
  double G = 0.0, Y0 = 0.0, Ep = 0.0, beta = 1.0;  // [Pa], [Pa], [Pa], [-]
  double C = 0.0, P = 1.0;  // [1/s], [-]
  std::string strain_rate = "plastic";

  struct State {
    double effective_plastic_strain, plastic_strain_rate;
    SymTensor back_stress;
  };

  static void describe(Schema<CowperSymonds>& s) {
    s.real(&CowperSymonds::G, "shear_modulus", "Pa", positive, "elastic shear modulus");
    s.real(&CowperSymonds::Y0, "yield_stress", "Pa", positive, "initial yield stress in uniaxial tension at no rate");
    s.real(&CowperSymonds::Ep, "hardening_modulus", "Pa", non_negative, "slope of stress over plastic strain")
        .by_default("0");
    s.real(&CowperSymonds::beta, "isotropic_share", "-", fraction,
           "share of the hardening that widens the yield surface: 1 isotropic, 0 kinematic")
        .by_default("1");
    s.real(&CowperSymonds::C, "C", "1/s", positive, "strain rate that doubles the yield stress")
        .usual(between(1.0, 1e7));
    s.real(&CowperSymonds::P, "P", "-", between(0.1, 100.0), "the yield stress grows with the rate to the power of 1/P")
        .usual(between(1.0, 20.0));
    s.choice(
         &CowperSymonds::strain_rate, "strain_rate", {"plastic", "total", "plastic_initial"},
         "plastic: the factor of the plastic strain rate multiplies the whole yield stress; total: so does that of "
         "the deviatoric strain rate; plastic_initial: the plastic rate adds a multiple of the initial yield stress")
        .by_default("plastic");
    s.state(&State::effective_plastic_strain, "effective_plastic_strain", "-", 0.0,
            "equivalent plastic strain, the time integral of sqrt(2/3 Dp:Dp)")
        .within(non_negative);
    s.state(&State::plastic_strain_rate, "plastic_strain_rate", "1/s", 0.0, "equivalent plastic strain rate");
    s.state(&State::back_stress, "back_stress", "Pa", "centre of the yield surface");
  }
  double cost() const override { return 5.0; }

  void update(const MaterialBatch& b) const override { update_rows(b); }
  void update_single(const SingleMaterialBatch& b) const override { update_rows(b); }

 private:
  enum : int { strain_row, rate_row, back_row, n_rows = back_row + 6 };  // as in State
  using StateRows = double[n_rows][lane_width];
  static_assert(n_doubles<State> == n_rows);

  struct alignas(64) Block {
    double strain[6][lane_width], stress[6][lane_width];
    double q[lane_width];  // equivalent of the trial stress less the back stress [Pa]
    double yield[lane_width];  // yield stress that the rate of the step does not change further [Pa]
    double y[lane_width];  // logarithm of the plastic increment
    double yields[lane_width];  // 1 or 0
  };
  /// What all points of a block share.
  struct Constants {
    double isotropic, kinematic, per_C_dt, log_C_dt, per_P, by_initial, dt;
  };

  template <class Real>
  void update_rows(const MaterialRows<Real>& b) const {
    Block k;
    detail::LaneVariables<State> state;
    state.read(b.state);
    for (int i = 0; i < 6; ++i)
      for (int l = 0; l < lane_width; ++l) {
        k.strain[i][l] = b.strain_increment[i][l];
        k.stress[i][l] = b.deviator[i][l];
      }
    const double C_dt = C * b.dt + 1e-300;
    const Constants c = {beta * Ep, (1.0 - beta) * Ep, 1.0 / C_dt, kerf::log(C_dt), 1.0 / P, initial_share(), b.dt};
    const bool by_total = strain_rate == "total";
#pragma omp simd
    for (int l = 0; l < lane_width; ++l) predict(k, state.values, c, by_total, l);
    if (!by_total) solve(k, state.values[strain_row], c);
#pragma omp simd
    for (int l = 0; l < lane_width; ++l) flow(k, state.values, c, l);
    for (int i = 0; i < 6; ++i)
      for (int l = 0; l < lane_width; ++l) b.deviator[i][l] = static_cast<Real>(k.stress[i][l]);
    for (int l = 0; l < lane_width; ++l) b.shear_modulus[l] = static_cast<Real>(G);
    state.write(b.state);
  }
  double initial_share() const { return strain_rate == "plastic_initial" ? 1.0 : 0.0; }

  /// (i) Elastic predictor and (ii) admissibility, without rate or with the total one. The first guess of the increment
  /// is the smaller one of two that are not less than it: one as if there were no rate, one as if there were nothing
  /// else.
  [[gnu::always_inline]] void predict(Block& k, const StateRows& state, const Constants& c, bool by_total,
                                      int l) const {
    const SymTensor increment = deviator(detail::tensor_at(k.strain, l));
    const SymTensor trial = detail::tensor_at(k.stress, l) + (2.0 * G) * increment,
                    reduced = trial - deviator(back_stress(state, l));
    detail::set_tensor(k.stress, l, trial);
    const double q = von_mises(reduced);
    const double total_rate = max_of(equivalent_strain(increment) * c.per_C_dt, 1e-200);
    const double factor = select(by_total & (c.dt > 0.0), 1.0 + positive_power(total_rate, c.per_P), 1.0);
    const double yield = (Y0 + c.isotropic * state[strain_row][l]) * factor;
    const double over = q - yield;
    const bool yields = over > 0.0;
    const double some = select(yields, over, 1.0);
    const double hardened = c.isotropic * factor + c.kinematic;
    const double of_rate = select(c.by_initial > 0.0, Y0, yield);
    const double without_rate = positive_log(some / (3.0 * G + hardened)),
                 by_rate_alone = c.log_C_dt + P * positive_log(some / of_rate);
    k.q[l] = q;
    k.yield[l] = yield;
    k.y[l] = select(by_total, without_rate, max_of(min_of(without_rate, by_rate_alone), least_log));
    k.yields[l] = select(yields, 1.0, 0.0);
  }

  /// (iii) Roots d of r(d) = (3 G + H) d + Y(ep + d) (1 + x) - q, or with Y + Y0 x, x = (d/(C dt))^(1/P).
  ///
  /// In ln d, r increases and is convex, and the first guess is not left of the root: Newton's method descends to it. A
  /// point that has converged is not touched again, whatever the others of its block need.
  void solve(Block& k, const double (&strain)[lane_width], const Constants& c) const {
    alignas(64) double moving[lane_width];
    for (int l = 0; l < lane_width; ++l) moving[l] = k.yields[l];
    for (int i = 0; i < max_iterations && any_positive(moving); ++i) {
#pragma omp simd
      for (int l = 0; l < lane_width; ++l) {
        const double y = k.y[l], d = kerf::exp(y), x = kerf::exp((y - c.log_C_dt) * c.per_P);
        const double yield = Y0 + c.isotropic * (strain[l] + d);
        const double of_rate = select(c.by_initial > 0.0, Y0, yield),
                     growth = select(c.by_initial > 0.0, 1.0, 1.0 + x);  // of the share that hardening has
        const double stiff = (3.0 * G + c.kinematic) * d;
        const double residual = stiff + yield + of_rate * x - k.q[l];
        const double slope = stiff + c.isotropic * d * growth + of_rate * x * c.per_P;
        const double s = residual / (slope + 1e-300);
        const bool moves = moving[l] > 0.0;
        k.y[l] = select(moves, max_of(y - s, least_log), y);
        moving[l] = select(moves & (std::fabs(s) > tolerance) & (k.y[l] > least_log), 1.0, 0.0);
      }
    }
  }

  /// (iv) Radial return, along the trial stress less the back stress.
  [[gnu::always_inline]] void flow(Block& k, StateRows& state, const Constants& c, int l) const {
    const double d = select(k.yields[l] > 0.0, kerf::exp(k.y[l]), 0.0);
    const SymTensor trial = detail::tensor_at(k.stress, l), back = back_stress(state, l),
                    reduced = trial - deviator(back);
    const double per_q = d / (k.q[l] + 1e-300);
    detail::set_tensor(k.stress, l, trial - (3.0 * G * per_q) * reduced);
    const SymTensor moved = back + (c.kinematic * per_q) * reduced;
    const double components[6] = {moved.xx, moved.yy, moved.zz, moved.xy, moved.yz, moved.zx};
    for (int i = 0; i < 6; ++i) state[back_row + i][l] = components[i];
    state[strain_row][l] += d;
    state[rate_row][l] = d / (c.dt + 1e-300);
  }
  [[gnu::always_inline]] static SymTensor back_stress(const StateRows& state, int l) {
    return detail::tensor_at(state + back_row, l);
  }

  static bool any_positive(const double (&values)[lane_width]) {  // each of which is 0 or 1
    std::int64_t bits = 0;
    for (int l = 0; l < lane_width; ++l) bits |= std::bit_cast<std::int64_t>(values[l]);
    return bits != 0;
  }

  static constexpr double least_log = -600.0;  // of an increment that changes no stress: e^-600
  static constexpr double tolerance = 1e-7;  // change of ln d in the last iteration; what then remains is its square
  static constexpr int max_iterations = 60;  // three to six
};

}  // namespace

KERF_MATERIAL(CowperSymonds, "cowper_symonds", "J2 flow with mixed linear hardening and Cowper-Symonds rate hardening")
