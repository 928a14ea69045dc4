// Strength by tables: the yield stress over the plastic strain, for one or several plastic strain rates, with a factor
// by temperature and the rate hardening of Cowper and Symonds.
//
// Sources: J.C. Simo & T.J.R. Hughes, Computational Inelasticity (1998), box 3.1 (radial return); G.R. Cowper & P.S.
// Symonds, Brown University, Applied Mathematics Report 28 (1957); G.I. Taylor & H. Quinney, Proc. R. Soc. A 143 (1934)
// 307-326 (heating).
#include <kerf/material.hpp>

#include <algorithm>
#include <bit>
#include <cstdint>

namespace {

using namespace kerf;

bool rises(const std::vector<double>& values) {
  for (std::size_t i = 1; i < values.size(); ++i)
    if (!(values[i] > values[i - 1])) return false;
  return true;
}

/// Yield stress over plastic strain, at one rate.
struct HardeningCurve {
  double rate = 0.0;  // [1/s]
  std::vector<double> strain, stress;  // [-], [Pa]

  static void describe(Schema<HardeningCurve>& s) {
    s.real(&HardeningCurve::rate, "plastic_strain_rate", "1/s", non_negative, "rate at which the curve holds")
        .by_default("0");
    s.reals(&HardeningCurve::strain, "plastic_strain", "-", non_negative,
            "plastic strains, from 0 up: total strain less stress over Young's modulus");
    s.reals(&HardeningCurve::stress, "yield_stress", "Pa", positive, "true yield stress at each of them");
    s.rule("yield_stress", "yield_stress must have as many entries as plastic_strain, and at least one",
           [](const HardeningCurve& c) { return !c.strain.empty() && c.stress.size() == c.strain.size(); });
    s.rule("plastic_strain", "the first plastic strain must be 0: there the material begins to yield",
           [](const HardeningCurve& c) { return c.strain.empty() || c.strain.front() == 0.0; });
    s.rule("plastic_strain", "plastic strains must rise from entry to entry",
           [](const HardeningCurve& c) { return rises(c.strain); });
  }

  std::size_t n() const { return strain.size(); }
  double slope(std::size_t i) const { return (stress[i + 1] - stress[i]) / (strain[i + 1] - strain[i]); }
  double last_slope() const { return n() > 1 ? slope(n() - 2) : 0.0; }
  double steepest_fall() const {
    double least = 0.0;
    for (std::size_t i = 0; i + 1 < n(); ++i) least = std::min(least, slope(i));
    return -least;
  }
  /// Within the table.
  double at(double ep) const {
    std::size_t i = 0;
    while (i + 2 < n() && ep >= strain[i + 1]) ++i;
    return n() == 1 ? stress[0] : stress[i] + std::min(ep - strain[i], strain[i + 1] - strain[i]) * slope(i);
  }
};

/// Where the yield stress and its derivatives are asked for, and what they are, of all points of a block.
struct alignas(64) FlowRows {
  double strain[lane_width], rate[lane_width];  // [-], [1/s]
  double value[lane_width], by_strain[lane_width], by_log_rate[lane_width];  // [Pa]
};

/// Flow stress Y(ep, rate) (1 + (rate/C)^(1/P)) f(T), radial return with the rate of the step itself and the
/// temperature of its start. A material for blocks: the tables are walked once for all points of a block.
struct TabulatedHardening final : Material {
  double G = 0.0;  // [Pa]
  std::vector<std::unique_ptr<HardeningCurve>> curves;
  std::string beyond = "constant", rate_interpolation = "linear";
  double C = -1.0, P = -1.0;  // [1/s], [-]; negative: not given
  std::vector<double> temperatures, temperature_factors;  // [K], [-]
  double initial_temperature = 0.0, specific_heat = 0.0, taylor_quinney = 0.9;  // [K], [J/(kg K)], [-]

  struct State {
    double effective_plastic_strain, temperature, plastic_strain_rate;
  };

  static void describe(Schema<TabulatedHardening>& s) {
    using M = TabulatedHardening;
    s.real(&M::G, "shear_modulus", "Pa", positive, "elastic shear modulus");
    s.block_list(&M::curves, "curves", "yield stress over plastic strain: one curve, or several for rising rates");
    s.choice(&M::beyond, "beyond", {"constant", "last_slope"},
             "what follows the last point of a curve: its stress, or a line on with its last slope, down to no less "
             "than 0")
        .by_default("constant");
    s.choice(&M::rate_interpolation, "rate_interpolation", {"linear", "logarithmic"},
             "between the rates of two curves; outside of them the nearest curve holds")
        .by_default("linear");
    s.real(&M::C, "C", "1/s", positive, "strain rate that doubles the yield stress (Cowper and Symonds)")
        .usual(between(1.0, 1e7))
        .optional();
    s.real(&M::P, "P", "-", between(0.1, 100.0), "the factor is 1 plus the plastic strain rate over C to the 1/P")
        .usual(between(1.0, 20.0))
        .optional();
    s.reals(&M::temperatures, "temperatures", "K", positive, "temperatures of temperature_factors, rising").optional();
    s.reals(&M::temperature_factors, "temperature_factors", "-", non_negative,
            "factor of the yield stress at each of the temperatures, constant outside of them")
        .optional();
    s.real(&M::initial_temperature, "initial_temperature", "K", positive, "temperature at the start")
        .by_default("293.15")
        .usual(between(100.0, 3000.0));
    s.real(&M::specific_heat, "specific_heat", "J/(kg K)", positive,
           "specific heat capacity; without it nothing is heated")
        .optional();
    s.real(&M::taylor_quinney, "taylor_quinney", "-", fraction, "share of the plastic work that heats")
        .by_default("0.9");
    describe_rules(s);
    s.state(&State::effective_plastic_strain, "effective_plastic_strain", "-", 0.0,
            "equivalent plastic strain, the time integral of sqrt(2/3 Dp:Dp)")
        .within(non_negative);
    s.state(&State::temperature, "temperature", "K", 293.15, "temperature from adiabatic plastic heating")
        .within(positive);
    s.state(&State::plastic_strain_rate, "plastic_strain_rate", "1/s", 0.0, "equivalent plastic strain rate");
  }
  static void describe_rules(Schema<TabulatedHardening>& s) {
    using M = TabulatedHardening;
    s.rule("curves", "give at least one curve", [](const M& m) { return !m.curves.empty(); });
    s.rule("curves", "the plastic_strain_rate of each curve must be above that of the curve before it",
           [](const M& m) { return rises(m.rates()); });
    s.rule("rate_interpolation", "logarithmic interpolation needs positive rates; give the first curve one",
           [](const M& m) { return m.rate_interpolation == "linear" || m.curves.size() < 2 || m.curves[0]->rate > 0; });
    s.rule("curves", "a curve must not fall below the one of the next lower rate: the flow would not be stable",
           [](const M& m) { return m.curves_in_order(); });
    s.rule("curves",
           "a yield stress, times its greatest temperature factor, falls by three times shear_modulus per plastic "
           "strain or more; no stress could follow it: make the curve less steep",
           [](const M& m) { return m.falls_slowly(); });
    s.rule("C", "C and P belong together; give both or neither", [](const M& m) { return (m.C > 0) == (m.P > 0); });
    s.rule("temperature_factors", "temperature_factors must have as many entries as temperatures",
           [](const M& m) { return m.temperatures.size() == m.temperature_factors.size(); });
    s.rule("temperatures", "temperatures must rise from entry to entry",
           [](const M& m) { return rises(m.temperatures); });
    s.rule("temperatures", "temperatures need specific_heat; with taylor_quinney: 0 nothing is heated",
           [](const M& m) { return m.temperatures.empty() || m.specific_heat > 0.0; });
  }

  void initialise(const InitialPoint&, double* state) const override { state[temperature_row] = initial_temperature; }
  double cost() const override { return 8.0; }

  void update(const MaterialBatch& b) const override { update_rows(b); }
  void update_single(const SingleMaterialBatch& b) const override { update_rows(b); }

 private:
  enum : int { strain_row, temperature_row, rate_row, n_rows };  // as in State
  using StateRows = double[n_rows][lane_width];
  static_assert(n_doubles<State> == n_rows);
  using Lane = double[lane_width];

  struct alignas(64) Block {
    double strain[6][lane_width], stress[6][lane_width], density[lane_width];
    double q[lane_width];  // trial equivalent stress [Pa]
    double thermal[lane_width];  // factor by temperature
    double low[lane_width], high[lane_width];  // the increment is between them
    double d[lane_width];  // plastic increment
    double dt, per_dt;  // [s], [1/s]
  };

  // What rules ask.
  std::vector<double> rates() const {
    std::vector<double> all;
    for (const auto& c : curves) all.push_back(c->rate);
    return all;
  }
  /// Curves may cross beyond the last point of either: the upper one then holds for both.
  bool curves_in_order() const {
    for (std::size_t i = 1; i < curves.size(); ++i) {
      const HardeningCurve &below = *curves[i - 1], &above = *curves[i];
      const double end = std::min(below.strain.back(), above.strain.back());
      for (const HardeningCurve* c : {&below, &above})
        for (const double ep : c->strain)
          if (ep <= end && above.at(ep) < below.at(ep)) return false;
    }
    return true;
  }
  bool falls_slowly() const {
    double fall = 0.0, factor = temperature_factors.empty() ? 1.0 : 0.0;
    for (const auto& c : curves) fall = std::max(fall, c->steepest_fall());
    for (const double f : temperature_factors) factor = std::max(factor, f);
    return fall * factor < 3.0 * G;
  }

  template <class Real>
  void update_rows(const MaterialRows<Real>& b) const {
    Block k;
    detail::LaneVariables<State> state;
    state.read(b.state);
    k.dt = b.dt;
    k.per_dt = 1.0 / (b.dt + 1e-300);
    for (int l = 0; l < lane_width; ++l) k.density[l] = b.density[l];
    for (int i = 0; i < 6; ++i)
      for (int l = 0; l < lane_width; ++l) {
        k.strain[i][l] = b.strain_increment[i][l];
        k.stress[i][l] = b.deviator[i][l];
      }
    find_thermal(state.values[temperature_row], k.thermal);
    predict(k, state.values[strain_row]);
    solve(k, state.values[strain_row]);
#pragma omp simd
    for (int l = 0; l < lane_width; ++l) flow(k, state.values, l);
    for (int i = 0; i < 6; ++i)
      for (int l = 0; l < lane_width; ++l) b.deviator[i][l] = static_cast<Real>(k.stress[i][l]);
    for (int l = 0; l < lane_width; ++l) b.shear_modulus[l] = static_cast<Real>(G);
    state.write(b.state);
  }

  void find_thermal(const Lane& temperature, Lane& factor) const {
    alignas(64) Lane slope;
    if (temperatures.empty())
      std::fill_n(factor, lane_width, 1.0);
    else
      walk(temperatures, temperature_factors, 0.0, temperature, factor, slope);
  }

  /// Value and slope of the line through the points of a table. Before the first point the first value holds, after
  /// the last one the line goes on with `last_slope`.
  static void walk(const std::vector<double>& x, const std::vector<double>& y, double last_slope, const Lane& at,
                   Lane& value, Lane& slope) {
    alignas(64) double x0[lane_width], y0[lane_width], x1[lane_width], y1[lane_width];
    for (int l = 0; l < lane_width; ++l) x0[l] = x[0], y0[l] = y[0], x1[l] = x[0] + 1.0, y1[l] = y[0];
    for (std::size_t i = 0; i < x.size(); ++i) {
      const bool is_last = i + 1 == x.size();
      const double from = x[i], first = y[i], to = is_last ? from + 1.0 : x[i + 1],
                   second = is_last ? first + last_slope : y[i + 1];
#pragma omp simd
      for (int l = 0; l < lane_width; ++l) {
        const bool here = at[l] >= from;
        x0[l] = select(here, from, x0[l]);
        y0[l] = select(here, first, y0[l]);
        x1[l] = select(here, to, x1[l]);
        y1[l] = select(here, second, y1[l]);
      }
    }
#pragma omp simd
    for (int l = 0; l < lane_width; ++l) {
      slope[l] = (y1[l] - y0[l]) / (x1[l] - x0[l]);
      value[l] = y0[l] + slope[l] * max_of(at[l] - x0[l], 0.0);
    }
  }

  /// One curve at the strains of all points; no less than 0.
  void walk_curve(const HardeningCurve& c, const Lane& strain, Lane& value, Lane& slope) const {
    walk(c.strain, c.stress, beyond == "last_slope" ? c.last_slope() : 0.0, strain, value, slope);
#pragma omp simd
    for (int l = 0; l < lane_width; ++l) {
      const bool some = value[l] > 0.0;
      value[l] = select(some, value[l], 0.0);
      slope[l] = select(some, slope[l], 0.0);
    }
  }

  /// Yield stress of the tables, without the factors: Y1 + w12 (Y2 - Y1) + w23 (Y3 - Y2) + ... with weights of the rate
  /// within 0 and 1.
  void find_yield(FlowRows& r) const {
    walk_curve(*curves[0], r.strain, r.value, r.by_strain);
    std::fill_n(r.by_log_rate, lane_width, 0.0);
    if (curves.size() == 1) return;
    alignas(64) Lane last, last_slope, next, next_slope;
    std::copy_n(r.value, lane_width, last);
    std::copy_n(r.by_strain, lane_width, last_slope);
    for (std::size_t i = 1; i < curves.size(); ++i) {
      walk_curve(*curves[i], r.strain, next, next_slope);
      const bool by_log = rate_interpolation == "logarithmic";
      const double low = curves[i - 1]->rate, high = curves[i]->rate;
      const double from = by_log ? kerf::log(low) : low, per_width = 1.0 / ((by_log ? kerf::log(high) : high) - from);
#pragma omp simd
      for (int l = 0; l < lane_width; ++l) {
        const bool above = next[l] > last[l];
        const double upper = select(above, next[l], last[l]), upper_slope = select(above, next_slope[l], last_slope[l]);
        const double rate = max_of(r.rate[l], 1e-300), place = select(by_log, positive_log(rate), rate);
        const double w = clamp_to((place - from) * per_width, 0.0, 1.0);
        const bool between_them = (w > 0.0) & (w < 1.0);
        r.value[l] += w * (upper - last[l]);
        r.by_strain[l] += w * (upper_slope - last_slope[l]);
        r.by_log_rate[l] += select(between_them, select(by_log, 1.0, rate) * per_width * (upper - last[l]), 0.0);
        last[l] = upper;
        last_slope[l] = upper_slope;
      }
    }
  }
  bool has_factor() const { return C > 0.0; }

  /// (i) Elastic predictor and (ii) admissibility, at no rate. The increment is not above q/3G, which takes all stress.
  /// Its first guess is the whole strain increment, or less where strain or rate alone would stop the flow before.
  void predict(Block& k, const Lane& strain) const {
    FlowRows r;
    std::copy_n(strain, lane_width, r.strain);
    std::fill_n(r.rate, lane_width, 0.0);
    find_yield(r);
    const bool factor = has_factor();
    const double log_C_dt = factor ? kerf::log(C * k.dt + 1e-300) : 0.0;
#pragma omp simd
    for (int l = 0; l < lane_width; ++l) predict_lane(k, r.value[l] * k.thermal[l], l);
    if (!factor) return;
      // The increment whose rate alone would carry the stress.
#pragma omp simd
    for (int l = 0; l < lane_width; ++l) {
      const double yield = r.value[l] * k.thermal[l], over = k.q[l] - yield;
      const bool some = (yield > 0.0) & (over > 0.0);
      const double ratio = select(some, over, 1.0) / select(some, yield, 1.0);
      k.d[l] = min_of(k.d[l], kerf::exp(clamp_to(log_C_dt + P * positive_log(ratio), -138.0, 60.0)));
    }
  }
  [[gnu::always_inline]] void predict_lane(Block& k, double yield, int l) const {
    const SymTensor increment = deviator(detail::tensor_at(k.strain, l));
    const SymTensor trial = detail::tensor_at(k.stress, l) + (2.0 * G) * increment;
    const double q = von_mises(trial), bound = (q - yield) / (3.0 * G);
    const double guess = max_of(min_of(equivalent_strain(increment), bound), 1e-6 * bound);
    detail::set_tensor(k.stress, l, trial);
    k.q[l] = q;
    k.low[l] = 0.0;
    k.high[l] = q / (3.0 * G);
    k.d[l] = select(bound > 0.0, guess, 0.0);
  }

  /// (iii) Roots d of r(d) = 3 G d + Y - q, between `low` and `high`: Newton's method, for ln d where the rate acts.
  /// Kinks and falling curves may lead it out of the interval or around in circles: then the interval is halved, in
  /// every other iteration from the tenth on. A point that has converged is not touched again.
  void solve(Block& k, const Lane& strain) const {
    alignas(64) double moving[lane_width];
    for (int l = 0; l < lane_width; ++l) moving[l] = select(k.d[l] > 0.0, 1.0, 0.0);
    const bool by_log = has_factor() || curves.size() > 1;
    for (int i = 0; any_positive(moving); ++i) {
      if (i == max_iterations) throw not_converged(moving);
      step(k, strain, moving, by_log, i > 10 && i % 2 == 0);
    }
  }

  void step(Block& k, const Lane& strain, Lane& moving, bool by_log, bool halves) const {
    FlowRows r;
    const bool factor = has_factor();
    const double per_C = 1.0 / max_of(C, 1e-300), per_P = 1.0 / P;
    for (int l = 0; l < lane_width; ++l) {
      r.strain[l] = strain[l] + k.d[l];
      r.rate[l] = k.d[l] * k.per_dt;
    }
    find_yield(r);
#pragma omp simd
    for (int l = 0; l < lane_width; ++l) {
      const double d = max_of(k.d[l], least);
      const double x = select(factor, positive_power(clamp_to(r.rate[l] * per_C, 1e-200, 1e200), per_P), 0.0);
      const double yield = r.value[l] * k.thermal[l], grows = (r.by_strain[l] * d + r.by_log_rate[l]) * k.thermal[l];
      const double residual = 3.0 * G * d + yield * (1.0 + x) - k.q[l],
                   slope = 3.0 * G * d + grows * (1.0 + x) + yield * x * per_P;
      const double low = select(residual > 0.0, k.low[l], d), high = select(residual > 0.0, d, k.high[l]);
      const double s = residual / select(slope > 0.0, slope, 1e-300);
      const double next = d * select(by_log, kerf::exp(clamp_to(-s, -3.0, 3.0)), 1.0 - s);
      const double middle = select(low > 0.0, std::sqrt(max_of(low, least) * high), 1e-4 * high);
      const bool inside = (next > low) & (next < high) & !halves;
      const bool moves = moving[l] > 0.0;
      const bool close = (std::fabs(residual) <= tolerance * slope) | (high - low <= 1e-15 * high) | (high <= least);
      k.d[l] = select(moves & !(residual == 0.0), select(inside, next, select(close, d, middle)), k.d[l]);
      k.low[l] = select(moves, low, k.low[l]);
      k.high[l] = select(moves, high, k.high[l]);
      moving[l] = select(moves & !close, 1.0, 0.0);
    }
  }

  /// (iv) Radial return and heating by the plastic work.
  [[gnu::always_inline]] void flow(Block& k, StateRows& state, int l) const {
    const double d = k.d[l], stress = max_of(k.q[l] - 3.0 * G * d, 0.0);
    const double share = select(d > 0.0, stress / (k.q[l] + 1e-300), 1.0);
    detail::set_tensor(k.stress, l, share * detail::tensor_at(k.stress, l));
    const double heat = select(specific_heat > 0.0, taylor_quinney / max_of(specific_heat, 1e-300), 0.0);
    state[strain_row][l] += d;
    state[rate_row][l] = d * k.per_dt;
    state[temperature_row][l] += heat * stress * d / k.density[l];
  }

  static detail::LaneError not_converged(const Lane& moving) {
    const int lane =
        static_cast<int>(std::find_if(moving, moving + lane_width, [](double m) { return m > 0.0; }) - moving);
    return {lane, "the return to the tabulated yield stress has not converged"};
  }
  static bool any_positive(const Lane& values) {  // each of which is 0 or 1
    std::int64_t bits = 0;
    for (int l = 0; l < lane_width; ++l) bits |= std::bit_cast<std::int64_t>(values[l]);
    return bits != 0;
  }

  static constexpr double least = 1e-60;  // of an increment
  static constexpr double tolerance = 1e-7;  // relative change of d in the last iteration; its square remains
  static constexpr int max_iterations = 400;  // one to three within a line of a table, some twenty with rates
};

}  // namespace

KERF_MATERIAL(TabulatedHardening, "tabulated_hardening", "J2 flow with tables of yield stress, rates and temperature")
