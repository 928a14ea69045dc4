// Johnson-Cook strength: J2 flow with strain hardening, rate hardening and thermal softening.
//
// Source: G.R. Johnson & W.H. Cook, "A constitutive model and data for metals subjected to large strains, high
// strain rates and high temperatures", Proc. 7th Int. Symp. on Ballistics (1983) 541-547, eq. 1; the power
// of the rate: G.T. Camacho & M. Ortiz, "Adaptive Lagrangian modelling of ballistic penetration of metallic targets",
// Comput. Methods Appl. Mech. Engng 142 (1997) 269-301.
#include <kerf/material.hpp>

namespace {

using namespace kerf;

/// Flow stress (A + B ep^n)(1 + C ln rate*)(1 - T*^m), or with (1 + rate*)^C, radial return with the rate of the step
/// itself.
///
/// A material for blocks rather than points, so that Newton's method stops when all points of a block have
/// converged, and does not start where none yields.
struct JohnsonCook final : Material {
  double G = 0.0, A = 0.0, B = 0.0, n = 1.0, C = 0.0, m = 1.0;
  double reference_rate = 1.0;  // [1/s]
  std::string rate_form = "logarithm";
  double reference_temperature = 0.0, melting_temperature = 0.0;  // [K]
  double initial_temperature = 0.0;  // [K]; 0: reference_temperature
  double specific_heat = 0.0, taylor_quinney = 0.9;  // [J/(kg K)], [-]

  struct State {
    double effective_plastic_strain, temperature, plastic_strain_rate;
  };

  static void describe(Schema<JohnsonCook>& s) {
    s.real(&JohnsonCook::G, "shear_modulus", "Pa", positive, "elastic shear modulus");
    s.real(&JohnsonCook::A, "A", "Pa", positive, "yield stress at the reference rate and temperature");
    s.real(&JohnsonCook::B, "B", "Pa", non_negative, "strain hardening coefficient");
    s.real(&JohnsonCook::n, "n", "-", Range{0.0, 5.0, true, false}, "strain hardening exponent");
    s.real(&JohnsonCook::C, "C", "-", between(0.0, 1.0), "rate hardening coefficient");
    s.real(&JohnsonCook::m, "m", "-", Range{0.0, 10.0, true, false}, "thermal softening exponent");
    s.real(&JohnsonCook::reference_rate, "reference_rate", "1/s", positive,
           "plastic strain rate at or below which there is no rate hardening; in the power form, that of A times 2^C")
        .by_default("1");
    s.choice(&JohnsonCook::rate_form, "rate_form", {"logarithm", "power"},
             "factor of the rate: 1 + C ln max(rate*, 1), or (1 + rate*)^C")
        .by_default("logarithm");
    s.real(&JohnsonCook::reference_temperature, "reference_temperature", "K", positive,
           "temperature at or below which there is no thermal softening")
        .by_default("293.15")
        .usual(between(100.0, 3000.0));
    s.real(&JohnsonCook::melting_temperature, "melting_temperature", "K", positive,
           "temperature at which the strength vanishes");
    s.real(&JohnsonCook::initial_temperature, "initial_temperature", "K", positive,
           "temperature at the start; by default the reference temperature")
        .optional()
        .usual(between(100.0, 3000.0));
    s.real(&JohnsonCook::specific_heat, "specific_heat", "J/(kg K)", positive, "specific heat capacity");
    s.real(&JohnsonCook::taylor_quinney, "taylor_quinney", "-", fraction, "share of the plastic work that heats")
        .by_default("0.9");
    s.rule("melting_temperature", "melting_temperature must be above reference_temperature",
           [](const JohnsonCook& j) { return j.melting_temperature > j.reference_temperature; });
    s.rule("initial_temperature", "initial_temperature must be below melting_temperature: molten, it has no strength",
           [](const JohnsonCook& j) { return j.melting_temperature > j.initial_temperature; });
    s.state(&State::effective_plastic_strain, "effective_plastic_strain", "-", 0.0,
            "equivalent plastic strain, the time integral of sqrt(2/3 Dp:Dp)")
        .within(non_negative);
    s.state(&State::temperature, "temperature", "K", 293.15, "temperature from adiabatic plastic heating")
        .within(positive);
    s.state(&State::plastic_strain_rate, "plastic_strain_rate", "1/s", 0.0, "equivalent plastic strain rate");
  }

  void initialise(const InitialPoint&, double* state) const override {
    state[temperature_row] = initial_temperature > 0.0 ? initial_temperature : reference_temperature;
  }
  double cost() const override { return 5.0; }

  void update(const MaterialBatch& b) const override { update_rows(b); }
  void update_single(const SingleMaterialBatch& b) const override { update_rows(b); }

 private:
  /// In double precision, whatever the rows hold: 2 to 4 % faster than by way of Material::update_single.
  template <class Real>
  void update_rows(const MaterialRows<Real>& b) const {
    Block k;
    detail::LaneVariables<State> state;
    state.read(b.state);
    k.dt = b.dt;
    for (int l = 0; l < lane_width; ++l) k.density[l] = b.density[l];
    for (int i = 0; i < 6; ++i)
      for (int l = 0; l < lane_width; ++l) {
        k.strain[i][l] = b.strain_increment[i][l];
        k.stress[i][l] = b.deviator[i][l];
      }
#pragma omp simd
    for (int l = 0; l < lane_width; ++l) predict(k, state.values, l);
    if (rate_form == "power")
      solve<true>(k, state.values[strain_row]);
    else
      solve<false>(k, state.values[strain_row]);
#pragma omp simd
    for (int l = 0; l < lane_width; ++l) flow(k, state.values, l);
    for (int i = 0; i < 6; ++i)
      for (int l = 0; l < lane_width; ++l) b.deviator[i][l] = static_cast<Real>(k.stress[i][l]);
    for (int l = 0; l < lane_width; ++l) b.shear_modulus[l] = static_cast<Real>(G);
    state.write(b.state);
  }

  enum : int { strain_row, temperature_row, rate_row, n_rows };  // as in State
  using StateRows = double[n_rows][lane_width];
  static_assert(n_doubles<State> == n_rows);

  // The arrays begin on boundaries of cache lines: see PointwiseMaterial.
  struct alignas(64) Block {
    double strain[6][lane_width], stress[6][lane_width], density[lane_width];
    double q[lane_width];  // trial equivalent stress [Pa]
    double softening[lane_width];  // thermal factor at the start of the step
    double bound[lane_width];  // plastic increment if neither rate nor strain hardened; not positive: elastic
    double d[lane_width];  // plastic increment
    double dt;  // [s]
  };

  /// x^exponent, 0 where x <= 1e-60. Pre: exponent > 0.
  static double power(double x, double exponent) {
    const bool some = x > 1e-60;
    return select(some, positive_power(select(some, x, 1.0), exponent), 0.0);
  }

  /// (i) Elastic predictor and (ii) admissibility, at the temperature of the start of the step and at the reference
  /// rate. The whole strain increment is the first guess of the plastic one.
  [[gnu::always_inline]] void predict(Block& k, const StateRows& state, int l) const {
    const SymTensor increment = deviator(detail::tensor_at(k.strain, l));
    const SymTensor trial = detail::tensor_at(k.stress, l) + (2.0 * G) * increment;
    const double t =
        (state[temperature_row][l] - reference_temperature) / (melting_temperature - reference_temperature);
    const double softening = max_of(1.0 - power(t, m), 0.0);
    const double q = von_mises(trial);
    const double bound = (q - (A + B * power(state[strain_row][l], n)) * softening) / (3.0 * G);
    detail::set_tensor(k.stress, l, trial);
    k.q[l] = q;
    k.softening[l] = softening;
    k.bound[l] = bound;
    k.d[l] = select(bound > 0.0, max_of(min_of(equivalent_strain(increment), bound), 1e-6 * bound), 0.0);
  }

  struct RateFactor {
    double value, slope;  // the latter by the logarithm of the rate
  };
  template <bool is_power>
  [[gnu::always_inline]] RateFactor rate_factor(double rate) const {
    if constexpr (is_power) {
      const double value = positive_power(1.0 + rate, C);
      return {value, C * value * rate / (1.0 + rate)};
    } else {
      const double log_rate = positive_log(rate);
      return {1.0 + C * max_of(log_rate, 0.0), select(log_rate > 0.0, C, 0.0)};
    }
  }

  /// (iii) Roots d of r(d) = 3 G d + (A + B (ep + d)^n)(1 + C ln(d / (rate0 dt))) softening - q, where there is flow.
  ///
  /// The rate is that of the step itself: with the rate of the step before, the stress oscillates with period two.
  /// r increases and is convex in ln d. So Newton's method for ln d lands right of the root from any d left of it,
  /// and descends to it from there; the root is not right of `bound`. The factors of d below stand for exp(-s) and
  /// are not less than it, which keeps that property. A point that has converged is not touched again, whatever the
  /// others of its block need. In the power form, with (1 + d/(rate0 dt))^C in place of 1 + C ln, r has these
  /// properties too.
  template <bool is_power>
  void solve(Block& k, const double (&strain)[lane_width]) const {
    const double per_reference = 1.0 / (reference_rate * k.dt + 1e-300);
    alignas(64) double moving[lane_width];
    for (int l = 0; l < lane_width; ++l) moving[l] = select(k.bound[l] > 0.0, 1.0, 0.0);
    for (int i = 0; i < max_iterations && any_positive(moving); ++i) {
#pragma omp simd
      for (int l = 0; l < lane_width; ++l) {
        const double d = max_of(k.d[l], 1e-60), total = strain[l] + d;
        const double hardening = B * positive_power(total, n);
        const auto [rate, rate_slope] = rate_factor<is_power>(d * per_reference);
        const double residual = 3.0 * G * d + (A + hardening) * rate * k.softening[l] - k.q[l];
        const double slope =
            3.0 * G * d + (hardening * n * d / total * rate + (A + hardening) * rate_slope) * k.softening[l];
        const double s = residual / slope, left = max_of(s, -1.0);
        const double factor = select(s > 0.0, 1.0 / (1.0 + s + 0.5 * s * s), 1.0 - left + left * left);
        const bool moves = moving[l] > 0.0;
        k.d[l] = select(moves, min_of(d * factor, k.bound[l]), k.d[l]);
        moving[l] = select(moves & (std::fabs(residual) > tolerance * slope), 1.0, 0.0);
      }
    }
  }

  /// (iv) Radial return and heating by the plastic work.
  [[gnu::always_inline]] void flow(Block& k, StateRows& state, int l) const {
    const double d = k.d[l], stress = k.q[l] - 3.0 * G * d;
    detail::set_tensor(k.stress, l, (stress / (k.q[l] + 1e-300)) * detail::tensor_at(k.stress, l));
    state[strain_row][l] += d;
    state[rate_row][l] = d / (k.dt + 1e-300);
    state[temperature_row][l] += taylor_quinney * stress * d / (k.density[l] * specific_heat);
  }

  static bool any_positive(const double (&values)[lane_width]) {  // each of which is 0 or 1
    std::int64_t bits = 0;
    for (int l = 0; l < lane_width; ++l) bits |= std::bit_cast<std::int64_t>(values[l]);
    return bits != 0;
  }

  // Relative change of d in the last iteration; what then remains is its square.
  static constexpr double tolerance = 1e-5;
  static constexpr int max_iterations = 60;  // two in steady flow, up to some twenty where flow begins
};

}  // namespace

KERF_MATERIAL(JohnsonCook, "johnson_cook", "rate- and temperature-dependent J2 plasticity")
