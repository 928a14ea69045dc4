// Strength that grows with a power of the strain, as in power-law plasticity (LS-DYNA's *MAT_POWER_LAW_PLASTICITY),
// with the rate hardening of Cowper and Symonds where it is wanted.
//
// Sources: J.H. Hollomon, "Tensile deformation", Trans. AIME 162 (1945) 268-290, and H.W. Swift, "Plastic instability
// under plane stress", J. Mech. Phys. Solids 1 (1952) 1-18 (the power of the strain); G.R. Cowper & P.S. Symonds, Brown
// University, Applied Mathematics Report 28 (1957); J.C. Simo & T.J.R. Hughes, Computational Inelasticity (1998), box
// 3.1 (radial return).
#include <kerf/material.hpp>

#include <algorithm>
#include <bit>
#include <cstdint>

namespace {

using namespace kerf;

/// Flow where the equivalent stress reaches Y (1 + x), with Y = k (e_y + ep)^n and x = (rate/C)^(1/P) of the plastic
/// strain rate. The strain e_y at which flow begins follows from a yield stress, or is where the elastic line of
/// uniaxial tension meets the power law.
///
/// A material for blocks rather than points, so that Newton's method stops when all points of a block have converged,
/// and does not start where none yields.
struct PowerLaw final : Material {
  double G = 0.0, k = 0.0, n = 1.0;  // [Pa], [Pa], [-]
  double yield_stress = -1.0, youngs_modulus = -1.0;  // [Pa]; negative: not given
  double C = -1.0, P = -1.0;  // [1/s], [-]; negative: not given

  struct State {
    double effective_plastic_strain, plastic_strain_rate;
  };

  static void describe(Schema<PowerLaw>& s) {
    using M = PowerLaw;
    s.real(&M::G, "shear_modulus", "Pa", positive, "elastic shear modulus");
    s.real(&M::k, "k", "Pa", positive, "strength coefficient: the yield stress at a strain of 1");
    s.real(&M::n, "n", "-", Range{0.0, 5.0, true, false}, "hardening exponent").usual(between(0.01, 1.0));
    s.real(&M::yield_stress, "yield_stress", "Pa", positive,
           "initial yield stress in uniaxial tension; flow begins at the strain (yield_stress/k)^(1/n)")
        .optional();
    s.real(&M::youngs_modulus, "youngs_modulus", "Pa", positive,
           "in place of yield_stress: flow begins where the elastic line meets the power law, at the strain "
           "(E/k)^(1/(n-1))")
        .optional();
    s.real(&M::C, "C", "1/s", positive, "strain rate that doubles the yield stress (Cowper and Symonds)")
        .usual(between(1.0, 1e7))
        .optional();
    s.real(&M::P, "P", "-", between(0.1, 100.0), "the factor is 1 plus the plastic strain rate over C to the 1/P")
        .usual(between(1.0, 20.0))
        .optional();
    describe_rules(s);
    s.state(&State::effective_plastic_strain, "effective_plastic_strain", "-", 0.0,
            "equivalent plastic strain, the time integral of sqrt(2/3 Dp:Dp)")
        .within(non_negative);
    s.state(&State::plastic_strain_rate, "plastic_strain_rate", "1/s", 0.0, "equivalent plastic strain rate");
  }
  static void describe_rules(Schema<PowerLaw>& s) {
    using M = PowerLaw;
    s.rule("yield_stress", "give yield_stress or youngs_modulus, one of the two: it says where flow begins",
           [](const M& m) { return given(m.yield_stress) != given(m.youngs_modulus); });
    s.rule("youngs_modulus", "youngs_modulus must be less than three times shear_modulus (Poisson's ratio below 0.5)",
           [](const M& m) { return m.youngs_modulus < 3.0 * m.G; });
    s.rule("n", "the elastic line meets the power law where n is less than 1 only; give a yield_stress",
           [](const M& m) { return !given(m.youngs_modulus) || m.n < 1.0; });
    s.rule("youngs_modulus", "youngs_modulus must be more than k: flow would begin at a strain above 1",
           [](const M& m) { return !given(m.youngs_modulus) || m.youngs_modulus > m.k; });
    s.rule("yield_stress",
           "the strain at which flow begins, (yield_stress/k)^(1/n), must be from 1e-100 to 1e100: check k and n",
           [](const M& m) { return !given(m.yield_stress) || std::fabs(m.log_yield_strain()) < 230.0; });
    s.rule(
        "youngs_modulus", "the strain at which flow begins, (E/k)^(1/(n-1)), must not be below 1e-100: check k and n",
        [](const M& m) { return !given(m.youngs_modulus) || !(m.n < 1.0) || std::fabs(m.log_yield_strain()) < 230.0; });
    s.rule("C", "C and P belong together; give both or neither", [](const M& m) { return given(m.C) == given(m.P); });
  }
  double cost() const override { return 5.0; }

  void update(const MaterialBatch& b) const override { update_rows(b); }
  void update_single(const SingleMaterialBatch& b) const override { update_rows(b); }

 private:
  enum : int { strain_row, rate_row, n_rows };  // as in State
  using StateRows = double[n_rows][lane_width];
  static_assert(n_doubles<State> == n_rows);
  using Lane = double[lane_width];

  struct alignas(64) Block {
    double strain[6][lane_width], stress[6][lane_width];
    double hardened[lane_width];  // strain in the power law at the start of the step
    double q[lane_width];  // trial equivalent stress [Pa]
    double y[lane_width], top[lane_width];  // logarithm of the plastic increment, and what it is not above
    double yields[lane_width];  // 1 or 0
  };
  /// What all points of a block share.
  struct Constants {
    double yield_strain, log_C_dt, per_P;
  };

  static bool given(double value) { return value > 0.0; }
  double log_yield_strain() const {
    if (given(yield_stress)) return kerf::log(yield_stress / k) / n;
    return kerf::log(youngs_modulus / k) / (n - 1.0);
  }

  template <class Real>
  void update_rows(const MaterialRows<Real>& b) const {
    Block block;
    detail::LaneVariables<State> state;
    state.read(b.state);
    for (int i = 0; i < 6; ++i)
      for (int l = 0; l < lane_width; ++l) {
        block.strain[i][l] = b.strain_increment[i][l];
        block.stress[i][l] = b.deviator[i][l];
      }
    const double C_dt = given(C) ? C * b.dt + 1e-300 : 1.0;
    const Constants c = {kerf::exp(log_yield_strain()), kerf::log(C_dt), 1.0 / P};
    if (given(C))
      find_increments<true>(block, state.values, c);
    else
      find_increments<false>(block, state.values, c);
    const double per_dt = 1.0 / (b.dt + 1e-300);
#pragma omp simd
    for (int l = 0; l < lane_width; ++l) flow(block, state.values, per_dt, l);
    for (int i = 0; i < 6; ++i)
      for (int l = 0; l < lane_width; ++l) b.deviator[i][l] = static_cast<Real>(block.stress[i][l]);
    for (int l = 0; l < lane_width; ++l) b.shear_modulus[l] = static_cast<Real>(G);
    state.write(b.state);
  }
  template <bool has_rate>
  void find_increments(Block& b, const StateRows& state, const Constants& c) const {
#pragma omp simd
    for (int l = 0; l < lane_width; ++l) predict<has_rate>(b, state, c, l);
    solve<has_rate>(b, c);
  }

  /// (i) Elastic predictor and (ii) admissibility, at no rate. The increment is neither above the one that nothing
  /// hardens, nor above the one whose rate alone carries the stress; the smaller of the two is the first guess.
  template <bool has_rate>
  [[gnu::always_inline]] void predict(Block& b, const StateRows& state, const Constants& c, int l) const {
    const SymTensor trial = detail::tensor_at(b.stress, l) + (2.0 * G) * deviator(detail::tensor_at(b.strain, l));
    const double q = von_mises(trial), hardened = c.yield_strain + state[strain_row][l];
    const double yield = k * positive_power(hardened, n), over = q - yield;
    const bool yields = over > 0.0;
    const double some = select(yields, over, 1.0);
    const double top = max_of(positive_log(some / (3.0 * G)), least_log);
    detail::set_tensor(b.stress, l, trial);
    b.q[l] = q;
    b.hardened[l] = hardened;
    b.top[l] = top;
    if constexpr (has_rate)
      b.y[l] = max_of(min_of(top, c.log_C_dt + P * positive_log(some / yield)), least_log);
    else
      b.y[l] = top;
    b.yields[l] = select(yields, 1.0, 0.0);
  }

  /// (iii) Roots d of r(d) = 3 G d + k (e_y + ep + d)^n (1 + (d/(C dt))^(1/P)) - q.
  ///
  /// In ln d, r increases and is convex: its terms are exponentials of convex functions. Newton's method descends to
  /// the root from any place right of it, as the first guess is, and lands right of it from any other; `top` bounds how
  /// far. A point that has converged is not touched again, whatever the others of its block need.
  template <bool has_rate>
  void solve(Block& b, const Constants& c) const {
    alignas(64) Lane moving;
    for (int l = 0; l < lane_width; ++l) moving[l] = b.yields[l];
    for (int i = 0; any_positive(moving); ++i) {
      if (i == max_iterations) throw not_converged(moving);
#pragma omp simd
      for (int l = 0; l < lane_width; ++l) {
        const double y = b.y[l], d = kerf::exp(y), total = b.hardened[l] + d;
        const double x = has_rate ? kerf::exp(min_of((y - c.log_C_dt) * c.per_P, 600.0)) : 0.0;
        const double yield = k * positive_power(total, n), stiff = 3.0 * G * d;
        const double residual = stiff + yield * (1.0 + x) - b.q[l];
        const double slope = stiff + yield * (n * d / total * (1.0 + x) + x * c.per_P);
        const double s = residual / (slope + 1e-300);
        const bool moves = moving[l] > 0.0;
        b.y[l] = select(moves, clamp_to(y - s, least_log, b.top[l]), y);
        const bool close = (std::fabs(s) <= tolerance) | (std::fabs(residual) <= round_off * b.q[l]);
        moving[l] = select(moves & !close & (b.y[l] > least_log), 1.0, 0.0);
      }
    }
  }

  /// (iv) Radial return.
  [[gnu::always_inline]] void flow(Block& b, StateRows& state, double per_dt, int l) const {
    const double d = select(b.yields[l] > 0.0, kerf::exp(b.y[l]), 0.0);
    const double share = select(d > 0.0, 1.0 - 3.0 * G * d / (b.q[l] + 1e-300), 1.0);
    detail::set_tensor(b.stress, l, share * detail::tensor_at(b.stress, l));
    state[strain_row][l] += d;
    state[rate_row][l] = d * per_dt;
  }

  static detail::LaneError not_converged(const Lane& moving) {
    const int lane =
        static_cast<int>(std::find_if(moving, moving + lane_width, [](double m) { return m > 0.0; }) - moving);
    return {lane, "the return to the power law has not converged"};
  }
  static bool any_positive(const Lane& values) {  // each of which is 0 or 1
    std::int64_t bits = 0;
    for (int l = 0; l < lane_width; ++l) bits |= std::bit_cast<std::int64_t>(values[l]);
    return bits != 0;
  }

  static constexpr double least_log = -600.0;  // of an increment that changes no stress: e^-600
  static constexpr double tolerance = 1e-7;  // change of ln d in the last iteration; what then remains is its square
  static constexpr double round_off = 1e-14;  // of the power, over the stress
  static constexpr int max_iterations = 200;  // three to ten
};

}  // namespace

KERF_MATERIAL(PowerLaw, "power_law", "J2 flow whose yield stress is a power of the strain, with rate hardening")
