// Steinberg-Guinan strength: shear modulus and yield stress that grow with pressure and fall with temperature, up to
// melting, for metals at rates above some 1e5/s.
//
// Sources: D.J. Steinberg, S.G. Cochran & M.W. Guinan, "A constitutive model for metals applicable at high-strain
// rate", J. Appl. Phys. 51 (1980) 1498-1504, eqs. 1 to 4; D.J. Steinberg, "Equation of state and strength properties of
// selected materials", UCRL-MA-106439 (1996), for constants; J.C. Simo & T.J.R. Hughes, Computational Inelasticity
// (1998), box 3.1 (radial return).
#include <kerf/law_use.hpp>
#include <kerf/material.hpp>

#include <cmath>
#include <cstdio>
#include <string>
#include <vector>

namespace {

using namespace kerf;

/// G = G0 [1 + A p eta^(-1/3) - B (T - Tr)] and Y = min(Y0 (1 + beta (ep + ei))^n, Ymax) G/G0 with eta = rho/rho0; none
/// of either at T >= Tm = Tm0 exp(2 a (1 - 1/eta)) eta^(2 (gamma0 - a - 1/3)).
///
/// The temperature is (e - ec)/cv, with the energy ec of the cold curve of the equation of state. Its pressure is
/// linear in energy, p = pc + rho Gamma (e - ec) with rho Gamma = rho0 (gamma0 + b mu). So each step's pressure and
/// energy tell the cold pressure pc, whatever the equation is, and dec = -pc d(1/rho) is integrated beside.
struct SteinbergGuinan final : PointwiseMaterial<SteinbergGuinan>, WarningLaw {
  double G0 = 0.0, Y0 = 0.0, Y_max = 0.0;  // [Pa]
  double beta = 0.0, n = 0.0, initial_strain = 0.0;  // [-]
  double A = 0.0, B = 0.0;  // [1/Pa], [1/K]
  double melting = 0.0, gamma0 = 0.0, b = 0.0, a = 0.0;  // [K], [-], [-], [-]
  double cv = 0.0, initial_temperature = 0.0, reference_temperature = 0.0;  // [J/(kg K)], [K], [K]

  struct State {
    double effective_plastic_strain, temperature, plastic_strain_rate, melting_temperature, shear_modulus;
    double cold_energy, cold_pressure, cold_volume_ratio;  // of one place on the cold curve [J/kg], [Pa], [-]
    double volume_ratio;  // at the end of the last step [-]
  };

  static void describe(Schema<SteinbergGuinan>& s) {
    using M = SteinbergGuinan;
    s.real(&M::G0, "shear_modulus", "Pa", positive, "elastic shear modulus at no pressure and reference_temperature");
    s.real(&M::Y0, "yield_stress", "Pa", positive, "yield stress before hardening, there");
    s.real(&M::Y_max, "maximum_yield_stress", "Pa", positive, "yield stress that hardening does not exceed, there");
    s.real(&M::beta, "beta", "-", non_negative, "hardening coefficient").usual(between(0.0, 1e4));
    s.real(&M::n, "n", "-", between(0.0, 1.0), "hardening exponent");
    s.real(&M::initial_strain, "initial_plastic_strain", "-", non_negative, "plastic strain of the hardening at start")
        .by_default("0");
    s.real(&M::A, "A", "1/Pa", non_negative,
           "growth with pressure of shear modulus and yield stress, as a share (tables give it in 1/Mbar)")
        .usual(between(0.0, 1e-9));
    s.real(&M::B, "B", "1/K", non_negative, "fall with temperature of shear modulus and yield stress, as a share")
        .usual(between(0.0, 1e-2));
    s.real(&M::melting, "melting_temperature", "K", positive, "melting temperature at the reference density");
    s.real(&M::gamma0, "gamma0", "-", non_negative, "Grueneisen parameter of the equation of state");
    s.real(&M::b, "gamma_slope", "-", any_value, "its first-order volume correction; as in mie_gruneisen")
        .by_default("0");
    s.real(&M::a, "a", "-", non_negative, "first-order volume correction of the Grueneisen parameter in melting")
        .usual(between(0.0, 5.0));
    s.real(&M::cv, "specific_heat", "J/(kg K)", positive, "specific heat capacity at constant volume")
        .usual(between(10.0, 1e4));
    s.real(&M::initial_temperature, "initial_temperature", "K", positive, "temperature at the start")
        .by_default("300")
        .usual(between(100.0, 3000.0));
    s.real(&M::reference_temperature, "reference_temperature", "K", positive,
           "temperature at which shear_modulus and yield_stress hold")
        .by_default("300")
        .usual(between(100.0, 3000.0));
    s.rule("maximum_yield_stress", "maximum_yield_stress must not be less than yield_stress",
           [](const M& m) { return m.Y_max >= m.Y0; });
    s.rule("melting_temperature", "melting_temperature must be above reference_temperature",
           [](const M& m) { return m.melting > m.reference_temperature; });
    describe_state(s);
  }
  static void describe_state(Schema<SteinbergGuinan>& s) {
    s.state(&State::effective_plastic_strain, "effective_plastic_strain", "-", 0.0,
            "equivalent plastic strain, the time integral of sqrt(2/3 Dp:Dp); all strain of molten material counts")
        .within(non_negative);
    s.state(&State::temperature, "temperature", "K", 300.0, "temperature from the energy above the cold curve")
        .within(positive);
    s.state(&State::plastic_strain_rate, "plastic_strain_rate", "1/s", 0.0, "equivalent plastic strain rate");
    s.state(&State::melting_temperature, "melting_temperature", "K", 0.0,
            "melting temperature at the density; molten where the temperature is not below it");
    s.state(&State::shear_modulus, "shear_modulus", "Pa", 0.0, "shear modulus; 0 where molten");
    s.state(&State::cold_energy, "cold_energy", "J/kg", 0.0, "internal energy on the cold curve");
    s.state(&State::cold_pressure, "cold_pressure", "Pa", 0.0, "pressure on the cold curve");
    s.state(&State::cold_volume_ratio, "cold_volume_ratio", "-", 1.0, "volume over undeformed volume of these two");
    s.state(&State::volume_ratio, "volume_ratio", "-", 1.0, "volume over undeformed volume");
  }
  void initialise_point(const InitialPoint& point, State& state) const {
    state.temperature = initial_temperature;
    state.melting_temperature = melting;
    state.shear_modulus = G0;
    state.cold_energy = -cv * initial_temperature;
    state.cold_pressure = point.density * gamma0 * state.cold_energy;
  }
  double cost() const override { return 12.0; }

  /// The cold curve is integrated from the pressure less Gamma rho e, which must be what the equation of state adds.
  std::vector<std::string> warnings(LawUse& use) const override {
    std::vector<std::string> lines;
    char line[320];
    if (initial_temperature >= melting) {
      std::snprintf(line, sizeof line,
                    "part %s is molten at the start, and has no strength: its initial_temperature of %.4g K is not "
                    "below its melting_temperature of %.4g K; check both and their units",
                    use.part.c_str(), initial_temperature, melting);
      lines.emplace_back(line);
    }
    const double much = 0.02 * (gamma0 + 0.1), here = (gamma0 + 0.1 * b) / 1.1;
    if (std::fabs(use.grueneisen - gamma0) > much)
      std::snprintf(line, sizeof line,
                    "gamma0 of steinberg_guinan is %.4g, and the equation of state of part %s has %.4g, so that "
                    "temperatures are wrong; give both laws the same",
                    gamma0, use.part.c_str(), use.grueneisen);
    else if (std::fabs(use.grueneisen_compressed - here) > much)
      std::snprintf(line, sizeof line,
                    "at 1.1 times the density, steinberg_guinan has a Grueneisen parameter of %.4g by its gamma_slope, "
                    "and the equation of state of part %s has %.4g, so that temperatures are wrong; give both laws the "
                    "same",
                    here, use.part.c_str(), use.grueneisen_compressed);
    else
      return lines;
    lines.emplace_back(line);
    return lines;
  }

  void update_point(const PointInput& in, SymTensor& stress, State& state, double& shear_modulus) const {
    const double specific_volume = 1.0 / in.reference_density, volume_ratio = in.volume_ratio();
    const SymTensor increment = deviator(in.strain_increment);
    begin(in, state);
    // (i) thermal energy at the start of the step, then at its end: by adiabatic change of volume, and by the work of
    // the stress
    const double grueneisen = in.reference_density * (gamma0 + b * (1.0 / state.volume_ratio - 1.0));  // rho Gamma
    const double start = thermal_energy(in, grueneisen, specific_volume, state);
    const double expansion = (volume_ratio - state.volume_ratio) * specific_volume;
    const double adiabatic = start * (1.0 - grueneisen * expansion), per_density = specific_volume * volume_ratio;
    const double work = double_dot(stress, increment) * per_density;
    // (ii) share of the strength that pressure and temperature leave
    const double temperature = temperature_of(adiabatic + work);
    const double compression = 1.0 / volume_ratio;  // rho/rho0
    const double melts = melting * kerf::exp(2.0 * a * (1.0 - volume_ratio)) *
                         positive_power(compression, 2.0 * (gamma0 - a - 1.0 / 3.0));
    const double by_pressure = A * in.pressure * positive_power(compression, -1.0 / 3.0);
    const double share = 1.0 + by_pressure - B * (temperature - reference_temperature);
    const bool solid = (temperature < melts) & (share > least_share);
    const double g = select(solid, share, 0.0), G = G0 * g;
    // (iii) elastic predictor and radial return
    const SymTensor trial = stress + (2.0 * G) * increment;
    const double q = von_mises(trial);
    const double d =
        select(solid, plastic_increment(q, g, state.effective_plastic_strain), equivalent_strain(increment));
    const SymTensor returned = select(solid, 1.0 - 3.0 * G * d / (q + tiny<double>), 0.0) * trial;
    const double mean_work = 0.5 * double_dot(stress + returned, increment) * per_density;
    stress = returned;
    state.effective_plastic_strain += d;
    state.plastic_strain_rate = d / (in.dt + tiny<double>);
    state.temperature = temperature_of(adiabatic + mean_work);
    state.melting_temperature = melts;
    state.shear_modulus = shear_modulus = G;
    state.volume_ratio = volume_ratio;
  }

 private:
  /// Before the first step, `temperature` is that of no specific energy, which an input may have set.
  [[gnu::always_inline]] void begin(const PointInput& in, State& state) const {
    const bool starts = !(in.dt > 0.0);
    const double energy = -cv * state.temperature;
    state.cold_energy = select(starts, energy, state.cold_energy);
    state.cold_pressure = select(starts, in.reference_density * gamma0 * energy, state.cold_pressure);
  }

  /// Follows the cold curve from the place in `state` to the volume of the step's start, by the trapezoidal rule, and
  /// leaves that place. Returns e - ec [J/kg].
  [[gnu::always_inline]] static double thermal_energy(const PointInput& in, double grueneisen, double specific_volume,
                                                      State& state) {
    const double half = 0.5 * (state.volume_ratio - state.cold_volume_ratio) * specific_volume;
    const double if_cold = in.pressure - grueneisen * in.specific_energy;  // pc less rho Gamma ec
    const double energy = (state.cold_energy - half * (state.cold_pressure + if_cold)) / (1.0 + half * grueneisen);
    state.cold_energy = energy;
    state.cold_pressure = if_cold + grueneisen * energy;
    state.cold_volume_ratio = state.volume_ratio;
    return in.specific_energy - energy;
  }

  /// Not below 0, but what is not a number stays that.
  [[gnu::always_inline]] double temperature_of(double thermal) const {
    return select(thermal < 0.0, 0.0, thermal / cv);
  }

  /// Root d of r(d) = 3 G d + Y(ep + d) - q, over g. r increases and is concave: Newton's method climbs to the root.
  /// Three iterations leave round-off of all metals of UCRL-MA-106439, with increments from 1e-6 to 1.
  [[gnu::always_inline]] double plastic_increment(double q, double g, double strain) const {
    const double load = q / select(g > 0.0, g, 1.0);
    double d = 0.0;
    for (int i = 0; i < 4; ++i) {
      const double x = max_of(1.0 + beta * (strain + initial_strain + d), 1.0);
      const double hardened = Y0 * positive_power(x, n);
      const bool bounded = hardened > Y_max;
      const double yield = select(bounded, Y_max, hardened), slope = select(bounded, 0.0, n * beta * hardened / x);
      d += max_of(load - 3.0 * G0 * d - yield, 0.0) / (3.0 * G0 + slope);
    }
    return d;
  }

  static constexpr double least_share = 1e-3;  // of the shear modulus that counts as one
};

}  // namespace

KERF_MATERIAL(SteinbergGuinan, "steinberg_guinan", "strength that follows pressure, temperature and melting")
