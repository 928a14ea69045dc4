// Johnson-Holmquist JH-2: brittle solids whose strength falls with damage, and which then take up more room.
//
// Source: G.R. Johnson & T.J. Holmquist, "An improved computational constitutive model for brittle materials", High
// Pressure Science and Technology 1993, AIP (1994) 981-984.
#include <kerf/solid.hpp>

#include <limits>

namespace {

using namespace kerf;

/// Strength si - D (si - sf) over the equivalent stress at the Hugoniot elastic limit, si = A (P* + T*)^N R for intact
/// and sf = min(B P*^M R, SFMAX) for fractured material, R = 1 + C ln max(rate/rate0, 1) with the rate of the total
/// deviatoric strain. Damage D' = ep' / [D1 (P* + T*)^D2]. Pressure K1 mu + K2 mu^2 + K3 mu^3 + dP in compression and
/// K1 mu + dP, not below -T (1 - D), in tension. dP grows by the elastic energy that damage sets free.
struct JohnsonHolmquist2 final : PointwiseSolid<JohnsonHolmquist2> {
  double G = 0.0, A = 0.0, B = 0.0, C = 0.0, M = 0.0, N = 0.0, T = 0.0;
  double most_fractured = std::numeric_limits<double>::infinity();
  double hel = 0.0, hel_pressure = 0.0, D1 = 0.0, D2 = 0.0, K1 = 0.0, K2 = 0.0, K3 = 0.0, beta = 1.0;
  double reference_rate = 1.0;

  struct State {
    double effective_plastic_strain, damage, bulking_pressure;
  };

  static void describe(Schema<JohnsonHolmquist2>& s) {
    using J = JohnsonHolmquist2;
    s.real(&J::G, "shear_modulus", "Pa", positive, "elastic shear modulus");
    s.real(&J::A, "A", "-", positive, "coefficient of the intact strength");
    s.real(&J::N, "N", "-", between(0.0, 2.0), "exponent of the intact strength");
    s.real(&J::B, "B", "-", non_negative, "coefficient of the fractured strength");
    s.real(&J::M, "M", "-", between(0.0, 2.0), "exponent of the fractured strength");
    s.real(&J::C, "C", "-", between(0.0, 1.0), "strain rate coefficient").by_default("0");
    s.real(&J::reference_rate, "reference_rate", "1/s", positive, "strain rate at or below which it has no effect")
        .by_default("1");
    s.real(&J::most_fractured, "most_fractured_strength", "-", positive,
           "the normalised fractured strength is never more; no limit where absent")
        .optional();
    s.real(&J::T, "tensile_strength", "Pa", positive, "greatest hydrostatic tension of the intact material");
    s.real(&J::hel, "hugoniot_elastic_limit", "Pa", positive, "axial stress at the Hugoniot elastic limit");
    s.real(&J::hel_pressure, "hugoniot_elastic_pressure", "Pa", positive, "pressure at the Hugoniot elastic limit");
    s.real(&J::D1, "D1", "-", non_negative, "coefficient of the failure strain; 0: failure at the first yield");
    s.real(&J::D2, "D2", "-", between(0.0, 10.0), "exponent of the failure strain");
    s.real(&J::K1, "K1", "Pa", positive, "bulk modulus");
    s.real(&J::K2, "K2", "Pa", any_value, "coefficient of mu squared in compression").by_default("0");
    s.real(&J::K3, "K3", "Pa", any_value, "coefficient of mu cubed in compression").by_default("0");
    s.real(&J::beta, "bulking_share", "-", fraction, "share of the lost elastic energy that becomes bulking pressure")
        .by_default("1");
    s.rule("hugoniot_elastic_limit", "hugoniot_elastic_limit must be above hugoniot_elastic_pressure",
           [](const J& j) { return j.hel > j.hel_pressure; });
    s.state(&State::effective_plastic_strain, "effective_plastic_strain", "-", 0.0, "equivalent plastic strain")
        .within(non_negative);
    s.state(&State::damage, "damage", "-", 0.0, "0 intact, 1 fractured").within(fraction);
    s.state(&State::bulking_pressure, "bulking_pressure", "Pa", 0.0, "pressure that damage has added")
        .within(non_negative);
  }

  double cost() const override { return 6.0; }

  void update_point(const SolidInput& in, SymTensor& stress, State& state, SolidModuli& moduli) const {
    const double mu = in.density / in.reference_density - 1.0;
    const double rate = equivalent_strain(deviator(in.strain_increment)) / (in.dt * reference_rate + tiny<double>);
    const double rate_factor = 1.0 + C * positive_log(max_of(rate, 1.0));
    // Strength at the pressure of the end of the step, with the damage and the bulking of its start.
    const double pressure = pressure_at(mu, state.bulking_pressure, state.damage);
    const SymTensor trial = deviator(stress) + (2.0 * G) * deviator(in.strain_increment);
    const double q = von_mises(trial);
    const double old_strength = strength(pressure, state.damage, rate_factor);
    // Where tension has used up the strength, what round-off leaves of a stress must not fail the point.
    const bool yields = q > old_strength + round_off * (hel - hel_pressure);
    const double damage = select(yields, damaged(pressure, state.damage, rate_factor, q - old_strength), state.damage);
    const double new_strength = strength(pressure, damage, rate_factor);
    const double kept = min_of(q, old_strength), now = select(yields, min_of(q, new_strength), q);
    // Bulking: the elastic energy of the deviator that damage alone sets free, in compression.
    const double lost = select(yields, max_of(kept * kept - now * now, 0.0), 0.0) / (6.0 * G);
    const double linear = K1 * mu, shifted = linear + state.bulking_pressure;
    const double bulked = -linear + std::sqrt(shifted * shifted + 2.0 * beta * K1 * lost);
    const double bulking = select((mu > 0.0) & (lost > 0.0), bulked, state.bulking_pressure);
    state.effective_plastic_strain += (q - now) / (3.0 * G);
    state.damage = damage;
    state.bulking_pressure = bulking;
    const double p = pressure_at(mu, bulking, damage);
    stress = (now / (q + tiny<double>)) * trial - SymTensor{p, p, p, 0.0, 0.0, 0.0};
    const double slope = K1 + select(mu > 0.0, (2.0 * K2 + 3.0 * K3 * mu) * mu, 0.0);
    moduli = {G, max_of((1.0 + mu) * slope, 0.0)};
  }

 private:
  static constexpr double round_off = 1e-9;
  /// x^exponent, 0 where x is not positive.
  static double power(double x, double exponent) {
    const bool some = x > 1e-60;
    const double value = positive_power(select(some, x, 1.0), exponent);
    return select(exponent == 0.0, 1.0, select(some, value, 0.0));
  }
  /// Damage at the end of a step whose trial stress is `over` above the strength. The strength falls linearly with
  /// damage, and so more plastic strain d is needed: 3 G d = over + (d / ef) (intact - fractured). Where that has no
  /// solution, the point fails within the step.
  double damaged(double p, double damage, double rate_factor, double over) const {
    const double failure_strain = D1 * power(positive_pressure(p), D2);
    const double fall = strength(p, 0.0, rate_factor) - strength(p, 1.0, rate_factor);
    const double stiffness = 3.0 * G * failure_strain - fall;
    const double grown = over / (max_of(stiffness, 0.0) + tiny<double>);
    return select(stiffness > 0.0, min_of(damage + grown, 1.0), 1.0);
  }
  double positive_pressure(double p) const { return max_of((p + T) / hel_pressure, 0.0); }  // P* + T*
  double strength(double p, double damage, double rate_factor) const {
    const double intact = A * power(positive_pressure(p), N) * rate_factor;
    const double fractured = min_of(B * power(max_of(p / hel_pressure, 0.0), M) * rate_factor, most_fractured);
    return 1.5 * (hel - hel_pressure) * (intact - damage * (intact - fractured));
  }
  double pressure_at(double mu, double bulking, double damage) const {
    const double compressed = (K1 + (K2 + K3 * mu) * mu) * mu + bulking;
    return select(mu > 0.0, compressed, max_of(K1 * mu + bulking, -T * (1.0 - damage)));
  }
};

}  // namespace

KERF_SOLID(JohnsonHolmquist2, "johnson_holmquist_2", "ceramics and glass with damage and bulking (JH-2)")
