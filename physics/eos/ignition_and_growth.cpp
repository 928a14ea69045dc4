// Ignition and growth: how a shock starts the reaction of an explosive, and how it becomes a detonation.
//
// Sources: E.L. Lee & C.M. Tarver, "Phenomenological model of shock initiation in heterogeneous explosives", Phys.
// Fluids 23 (1980) 2362-2372; C.M. Tarver, J.O. Hallquist & L.M. Erickson, "Modeling short pulse duration shock
// initiation of solid explosives", 8th Symposium (International) on Detonation (1985) 951-961, for the third term.
#include <algorithm>
#include <string>
#include <vector>

#include "explosives/two_phases.hpp"
#include "kerf/law_use.hpp"

namespace {

using namespace kerf;
using namespace kerf::explosives;

/// dF/dt = I (1-F)^b (rho/rho0 - 1 - a)^x [F < figmax] + G1 (1-F)^c F^d (p/pr)^y [F < fg1max]
///       + G2 (1-F)^e F^g (p/pr)^z [F > fg2min].
/// The rate is integrated within the step at the step's last volume and energy, in pieces that burn a few per cent
/// each.
struct IgnitionAndGrowth final : PointwiseEos<IgnitionAndGrowth>, WarningLaw, EnergyHolder {
  Phase unreacted, products;
  double initial_energy = 0.0, initial_temperature = 298.0, reference_pressure = 1e11;  // [J/m3], [K], [Pa]
  double I = 0.0, b = 0.0, a = 0.0, x = 0.0, figmax = 1.0;  // [1/s], [-]
  double G1 = 0.0, c = 0.0, d = 0.0, y = 0.0, fg1max = 1.0;  // [1/s], [-]
  double G2 = 0.0, e = 0.0, g = 0.0, z = 0.0, fg2min = 0.0;  // [1/s], [-]

  struct State {
    double burn_fraction, temperature, products_volume;
  };

  static void describe(Schema<IgnitionAndGrowth>& s) {
    using T = IgnitionAndGrowth;
    s.block(&T::unreacted, "unreacted", "the explosive that has not reacted");
    s.block(&T::products, "products", "the products of the reaction");
    s.real(&T::initial_energy, "initial_energy", "J/m3", positive, "energy of the reaction per reference volume")
        .usual(between(1e8, 2e10));
    s.real(&T::initial_temperature, "initial_temperature", "K", positive, "temperature at the start")
        .by_default("298")
        .usual(between(150.0, 600.0));
    s.real(&T::reference_pressure, "reference_pressure", "Pa", positive,
           "pressure over which that in the growth terms is taken: 1 Mbar where G1 and G2 belong to Mbar")
        .by_default("100 GPa");
    s.real(&T::I, "I", "1/s", non_negative, "rate of ignition (tables give it in 1/us)").usual(between(1e5, 1e25));
    s.real(&T::b, "b", "-", non_negative, "exponent of the unburnt share in ignition").usual(between(0.0, 3.0));
    s.real(&T::a, "a", "-", any_value, "compression below which nothing ignites")
        .by_default("0")
        .usual(between(-0.1, 1.0));
    s.real(&T::x, "x", "-", positive, "exponent of the compression in ignition").usual(between(1.0, 30.0));
    s.real(&T::figmax, "figmax", "-", fraction, "burnt share at which ignition ends").by_default("1");
    s.real(&T::G1, "G1", "1/s", non_negative, "rate of growth (tables give it in 1/us, per Mbar to the power y)")
        .usual(between(1e4, 1e13));
    s.real(&T::c, "c", "-", non_negative, "exponent of the unburnt share in growth").usual(between(0.0, 3.0));
    s.real(&T::d, "d", "-", non_negative, "exponent of the burnt share in growth").usual(between(0.0, 3.0));
    s.real(&T::y, "y", "-", non_negative, "exponent of the pressure in growth").usual(between(0.5, 5.0));
    s.real(&T::fg1max, "fg1max", "-", fraction, "burnt share at which growth ends").by_default("1");
    s.real(&T::G2, "G2", "1/s", non_negative, "rate of completion").by_default("0");
    s.real(&T::e, "e", "-", non_negative, "exponent of the unburnt share in completion")
        .by_default("0")
        .usual(between(0.0, 3.0));
    s.real(&T::g, "g", "-", non_negative, "exponent of the burnt share in completion")
        .by_default("0")
        .usual(between(0.0, 3.0));
    s.real(&T::z, "z", "-", non_negative, "exponent of the pressure in completion")
        .by_default("0")
        .usual(between(0.0, 5.0));
    s.real(&T::fg2min, "fg2min", "-", fraction, "burnt share at which completion begins").by_default("0");
    s.state(&State::burn_fraction, "burn_fraction", "-", 0.0, "burnt share of the explosive").within(fraction);
    s.state(&State::temperature, "temperature", "K", 298.0, "temperature of both phases").within(positive);
    s.state(&State::products_volume, "products_volume", "-", 1.0, "volume ratio of the products").within(positive);
  }
  double initial_energy_density() const override { return initial_energy; }
  double energy_held(std::span<const double> state) const override { return (1.0 - state[0]) * initial_energy; }
  bool acts_by_itself() const override { return false; }
  double cost() const override { return 6.0; }

  /// Terms of the rate that can never act, and a rate of completion in other units.
  std::vector<std::string> warnings(LawUse&) const override {
    std::vector<std::string> lines;
    if (I > 0.0 && !(figmax > 0.0)) lines.push_back("ignition ends at a figmax of 0, and never acts; give its share");
    if (G1 > 0.0 && !(fg1max > 0.0)) lines.push_back("growth ends at an fg1max of 0, and never acts; give its share");
    if (G2 > 0.0 && !(fg2min < 1.0))
      lines.push_back("completion begins at an fg2min of 1, where nothing is left to burn; lower it, or leave G2 out");
    if (!(G2 > 0.0) && fg2min + e + g + z > 0.0)
      lines.push_back("e, g, z and fg2min have no effect without G2; give it, or leave them out");
    if (G2 > 0.0 && (G2 < least_G2 || G2 > most_G2))
      lines.push_back(
          "G2 is not within 1e4 and 1e13 1/s; tables give it in 1/us, per Mbar to the power z: check its "
          "unit and reference_pressure");
    return lines;
  }

  void initialise_point(const InitialPoint&, State& state) const { state.temperature = initial_temperature; }

  EosOutput evaluate_point(const EosInput& in, State& state) const {
    const TwoPhases phases{unreacted, products,
                           unreacted.cold(1.0).energy + unreacted.heat_capacity * initial_temperature, initial_energy};
    const double V = in.volume_ratio(), E = in.reference_density * in.specific_energy;
    MixtureState m = phases.at(state.burn_fraction, V, E, state.products_volume);
    burn(phases, V, E, in.dt, state.burn_fraction, m);
    state.temperature = m.temperature;
    state.products_volume = m.products_volume;
    return {m.pressure, max_of(m.bulk_modulus, 0.0)};
  }

 private:
  static constexpr double least_G2 = 1e4, most_G2 = 1e13;  // [1/s], as usual for G1
  static constexpr double all_but = 1e-6;  // what is left then burns at once
  static constexpr double most_burnt = 0.02;  // in a piece of a step; Heun's method errs by the square of it

  /// Carries the burnt share through a step, and the mixture with it.
  void burn(const TwoPhases& phases, double V, double E, double dt, double& F, MixtureState& m) const {
    const double compression = 1.0 / V - 1.0 - a;
    constexpr int most_pieces = 1000;
    double left = dt;
    for (int i = 0; i < most_pieces && left > 0.0 && F < 1.0; ++i) {
      const double first = rate(F, compression, m.pressure);
      if (!(first > 0.0)) return;
      // Rates by powers of F and of 1 - F have no bounded slope at either end: pieces are shares of what is there.
      const double at_ends = max_of(min_of(0.5 * F, 0.2 * (1.0 - F)), 1e-6);
      const double most = i + 1 == most_pieces ? 1.0 : min_of(most_burnt, at_ends);
      const double piece = min_of(left, most / first);
      const double F_first = min_of(F + piece * first, 1.0);
      const double second = rate(F_first, compression, phases.at(F_first, V, E, m.products_volume).pressure);
      F += 0.5 * piece * (first + second);
      if (F > 1.0 - all_but) F = 1.0;
      m = phases.at(F, V, E, m.products_volume);
      left -= piece;
    }
  }

  double rate(double F, double compression, double pressure) const {
    const double unburnt = 1.0 - F, p = pressure / reference_pressure;
    const auto power = [](double base, double exponent) { return exponent == 0.0 ? 1.0 : kerf::pow(base, exponent); };
    double sum = 0.0;
    if (compression > 0.0 && F < figmax) sum += I * power(unburnt, b) * power(compression, x);
    if (F < fg1max) sum += G1 * power(unburnt, c) * power(F, d) * power(p, y);
    if (G2 > 0.0 && F > fg2min) sum += G2 * power(unburnt, e) * power(F, g) * power(p, z);
    return sum;
  }
};

}  // namespace

KERF_EOS(IgnitionAndGrowth, "ignition_and_growth", "shock initiation of an explosive: ignition, growth and completion")
