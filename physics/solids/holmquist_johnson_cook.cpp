// Holmquist-Johnson-Cook concrete: strength that grows with pressure and falls with damage, and pores that are crushed.
//
// Source: T.J. Holmquist, G.R. Johnson & W.H. Cook, "A computational constitutive model for concrete subjected to large
// strains, high strain rates and high pressures", Proc. 14th Int. Symp. on Ballistics (1993) 591-600.
#include <kerf/solid.hpp>

#include <limits>
#include <string>

namespace {

using namespace kerf;

/// Strength fc min([A (1 - D) + B P*^N] R, SFMAX), P* = p/fc, R = 1 + C ln max(rate/rate0, 1) with the rate of the
/// total deviatoric strain; in tension it falls to zero, see tension_strength. Damage D' = (ep' + mu_p')/max(D1 (P* +
/// T*)^D2, EFMIN). Pressure over mu = rho/rho0 - 1: elastic up to mu_crush, crushed along a straight line up to P_lock,
/// and K1 m + K2 m^2 + K3 m^3, m = (mu - mu_lock)/(1 + mu_lock), of the material without pores from there on.
struct HolmquistJohnsonCook final : PointwiseSolid<HolmquistJohnsonCook> {
  double G = 0.0, A = 0.0, B = 0.0, N = 0.0, C = 0.0, fc = 0.0, T = 0.0;
  double most_strength = std::numeric_limits<double>::infinity();
  double crush_pressure = 0.0, crush_mu = 0.0, lock_pressure = 0.0, lock_mu = 0.0, K1 = 0.0, K2 = 0.0, K3 = 0.0;
  double D1 = 0.0, D2 = 1.0, least_failure_strain = 0.0, reference_rate = 1.0;
  std::string tension_strength = "sum", tension_limit = "damaged";

  struct State {
    double effective_plastic_strain, damage, greatest_mu, plastic_mu;
  };

  static void describe(Schema<HolmquistJohnsonCook>& s) {
    using H = HolmquistJohnsonCook;
    s.real(&H::G, "shear_modulus", "Pa", positive, "elastic shear modulus");
    s.real(&H::fc, "compressive_strength", "Pa", positive, "fc, quasi-static uniaxial compressive strength");
    s.real(&H::A, "A", "-", positive, "cohesive strength over fc");
    s.real(&H::B, "B", "-", non_negative, "coefficient of the hardening with pressure");
    s.real(&H::N, "N", "-", between(0.0, 2.0), "exponent of the hardening with pressure");
    s.real(&H::C, "C", "-", between(0.0, 1.0), "strain rate coefficient").by_default("0");
    s.real(&H::reference_rate, "reference_rate", "1/s", positive, "strain rate at or below which it has no effect")
        .by_default("1");
    s.real(&H::most_strength, "most_strength", "-", positive,
           "SFMAX, the strength over fc is never more; no limit where absent")
        .optional();
    s.real(&H::T, "tensile_strength", "Pa", positive, "T, greatest hydrostatic tension of the intact material");
    s.choice(&H::tension_strength, "tension_strength", {"sum", "product"},
             "strength over fc in tension without the rate: A (1 - D) + A p/T, or A (1 - D) (1 + p/T)")
        .by_default("sum");
    s.choice(&H::tension_limit, "tension_limit", {"damaged", "intact"},
             "greatest hydrostatic tension: T (1 - D), or T whatever the damage")
        .by_default("damaged");
    s.real(&H::crush_pressure, "crush_pressure", "Pa", positive, "pressure at which pores begin to be crushed");
    s.real(&H::crush_mu, "crush_mu", "-", positive, "mu at crush_pressure; their ratio is the elastic bulk modulus");
    s.real(&H::lock_pressure, "lock_pressure", "Pa", positive, "pressure at which all pores are closed");
    s.real(&H::lock_mu, "lock_mu", "-", positive, "mu of the material without pores at no pressure");
    s.real(&H::K1, "K1", "Pa", positive, "bulk modulus of the material without pores");
    s.real(&H::K2, "K2", "Pa", any_value, "coefficient of m squared").by_default("0");
    s.real(&H::K3, "K3", "Pa", any_value, "coefficient of m cubed").by_default("0");
    s.real(&H::D1, "D1", "-", non_negative, "coefficient of the failure strain");
    s.real(&H::D2, "D2", "-", between(0.0, 10.0), "exponent of the failure strain").by_default("1");
    s.real(&H::least_failure_strain, "least_failure_strain", "-", positive, "EFMIN, the failure strain is never less");
    s.rule("lock_mu", "lock_mu must be above crush_mu", [](const H& h) { return h.lock_mu > h.crush_mu; });
    s.rule("lock_pressure", "lock_pressure must be above crush_pressure",
           [](const H& h) { return h.lock_pressure > h.crush_pressure; });
    s.rule("K1", "K1, K2 and K3 must give a pressure that rises from 0 to lock_pressure",
           [](const H& h) { return h.locks(); });
    s.rule("crush_mu",
           "crush_pressure / crush_mu and K1, the moduli of unloading, must be above the slope of the pressure while "
           "pores are crushed, else a cycle of unloading and loading would gain energy",
           [](const H& h) { return !h.locks() || min_of(h.elastic_modulus(), h.K1) > h.crush_slope(); });
    s.state(&State::effective_plastic_strain, "effective_plastic_strain", "-", 0.0, "equivalent plastic strain")
        .within(non_negative);
    s.state(&State::damage, "damage", "-", 0.0, "0 intact, 1 fractured").within(fraction);
    s.state(&State::greatest_mu, "greatest_mu", "-", 0.0, "greatest mu = rho/rho0 - 1 so far").within(non_negative);
    s.state(&State::plastic_mu, "plastic_mu", "-", 0.0, "mu that is left at no pressure").within(non_negative);
  }

  void update_point(const SolidInput& in, SymTensor& stress, State& state, SolidModuli& moduli) const {
    const double mu = in.density / in.reference_density - 1.0;
    const double strain = equivalent_strain(deviator(in.strain_increment));
    const double rate_factor = 1.0 + C * positive_log(max_of(strain / (in.dt * reference_rate + tiny<double>), 1.0));
    const Pores pores = crushed(mu, state.greatest_mu);
    // Strength at the pressure of the end of the step, with the damage of its start as far as it limits the tension.
    const double pressure = max_of(pores.pressure, -limit_of_tension(state.damage));
    const SymTensor trial = deviator(stress) + (2.0 * G) * deviator(in.strain_increment);
    const double q = von_mises(trial), crushing = max_of(pores.plastic_mu - state.plastic_mu, 0.0);
    // Damage grows at the mean pressure of that part of the step in which pores are crushed or the point yields.
    const double over = (q - strength(pressure, state.damage, rate_factor)) / (3.0 * G * strain + tiny<double>);
    const double part = select(crushing > 0.0, 1.0, clamp_to(over, 0.0, 1.0));
    const double mean = pressure + 0.5 * part * (-(1.0 / 3.0) * stress.trace() - pressure);
    const double failure_strain = max_of(D1 * power(max_of((mean + T) / fc, 0.0), D2), least_failure_strain);
    const double before = min_of(state.damage + crushing / failure_strain, 1.0);
    // Where tension has used up the strength, what round-off leaves of a stress must not damage the point.
    const bool yields = q > strength(pressure, before, rate_factor) + round_off * fc;
    const double grown = before + plastic_strain(q, pressure, before, rate_factor, failure_strain) / failure_strain;
    const double damage = select(yields, min_of(grown, 1.0), before);
    const double now = select(yields, min_of(q, strength(pressure, damage, rate_factor)), q);
    state.effective_plastic_strain += (q - now) / (3.0 * G);
    state.damage = damage;
    state.greatest_mu = pores.greatest_mu;
    state.plastic_mu = pores.plastic_mu;
    const double p = max_of(pores.pressure, -limit_of_tension(damage));
    stress = (now / (q + tiny<double>)) * trial - SymTensor{p, p, p, 0.0, 0.0, 0.0};
    moduli = {G, (1.0 + mu) * pores.slope};
  }

 private:
  static constexpr double round_off = 1e-9;
  struct Pores {
    double pressure, slope;  // without the limit of tension; dp/dmu, of unloading where that is the greater [Pa]
    double greatest_mu, plastic_mu;
  };

  /// x^exponent, 0 where x is not positive.
  static double power(double x, double exponent) {
    const bool some = x > 1e-60;
    const double value = positive_power(select(some, x, 1.0), exponent);
    return select(exponent == 0.0, 1.0, select(some, value, 0.0));
  }
  double elastic_modulus() const { return crush_pressure / crush_mu; }
  /// Pressure and slope over m of the material without pores [Pa].
  double solid_pressure(double m) const { return (K1 + (K2 + K3 * m) * m) * m; }
  double solid_slope(double m) const { return K1 + (2.0 * K2 + 3.0 * K3 * m) * m; }
  /// m at lock_pressure, by Newton's method. It depends on constants alone: compilers take it out of loops over points.
  double locked_m() const {
    double m = 0.0;
    for (int i = 0; i < 8; ++i) m += (lock_pressure - solid_pressure(m)) / solid_slope(m);
    return m;
  }
  double locked_mu() const { return lock_mu + (1.0 + lock_mu) * locked_m(); }
  double crush_slope() const { return (lock_pressure - crush_pressure) / (locked_mu() - crush_mu); }
  /// Newton's method has found m at lock_pressure, and the pressure rises up to there. Its slope is a parabola.
  bool locks() const {
    const double m = locked_m(), least = K3 != 0.0 ? clamp_to(-K2 / (3.0 * K3), 0.0, m) : m;
    return m > 0.0 && min_of(solid_slope(least), solid_slope(m)) > 0.0 &&
           std::fabs(solid_pressure(m) - lock_pressure) < 1e-12 * lock_pressure;
  }

  Pores crushed(double mu, double old_greatest) const {
    const double most = max_of(mu, old_greatest), elastic = elastic_modulus(), lock = locked_mu();
    const double share = clamp_to((most - crush_mu) / (lock - crush_mu), 0.0, 1.0);
    const double unloading = (1.0 - share) * elastic + share * K1;
    const double reached = crush_pressure + (lock_pressure - crush_pressure) * share;
    const double m = (mu - lock_mu) / (1.0 + lock_mu);
    const bool is_elastic = most <= crush_mu, is_locked = most >= lock, compressed = m > 0.0;
    const double locked = select(compressed, solid_pressure(m), K1 * m);
    const double locked_slope = max_of(select(compressed, solid_slope(m), K1), 0.0) / (1.0 + lock_mu);
    Pores p;
    p.pressure = select(is_elastic, elastic * mu, select(is_locked, locked, reached - unloading * (most - mu)));
    p.slope = select(is_locked, locked_slope, unloading);
    p.greatest_mu = most;
    p.plastic_mu = select(is_elastic, 0.0, select(is_locked, lock_mu, most - reached / unloading));
    return p;
  }
  double limit_of_tension(double damage) const { return T * select(tension_limit.front() == 'i', 1.0, 1.0 - damage); }

  /// Over fc, without the limits: intact - fall * damage.
  struct Strength {
    double intact, fall;
  };
  Strength unlimited_strength(double p, double rate_factor) const {
    const double tension = min_of(p, 0.0) / T, hardening = B * power(max_of(p / fc, 0.0), N);
    const double fall = A * select(tension_strength.front() == 'p', 1.0 + tension, 1.0);
    return {(A * (1.0 + tension) + hardening) * rate_factor, fall * rate_factor};
  }
  double strength(double p, double damage, double rate_factor) const {
    const Strength s = unlimited_strength(p, rate_factor);
    return fc * clamp_to(s.intact - s.fall * damage, 0.0, most_strength);
  }
  /// Plastic strain d of a step whose trial stress is q: 3 G d = q - strength, which falls with damage by d / ef until
  /// none is left. Where that has no solution, the point fails within the step: infinite.
  double plastic_strain(double q, double p, double damage, double rate_factor, double failure_strain) const {
    const Strength s = unlimited_strength(p, rate_factor);
    const double stiffness = 3.0 * G - fc * s.fall / failure_strain;
    const double falling = (q - fc * (s.intact - s.fall * damage)) / (max_of(stiffness, 0.0) + tiny<double>);
    const double limited = (q - fc * most_strength) / (3.0 * G);
    return min_of(max_of(falling, limited), q / (3.0 * G));
  }
};

}  // namespace

KERF_SOLID(HolmquistJohnsonCook, "holmquist_johnson_cook", "concrete with damage and pores that are crushed (HJC)")
