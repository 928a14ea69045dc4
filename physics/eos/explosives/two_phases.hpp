// A mixture of two phases of Jones-Wilkins-Lee form, unreacted explosive and products, with one pressure and one
// temperature.
//
// Source: E.L. Lee & C.M. Tarver, "Phenomenological model of shock initiation in heterogeneous explosives", Phys.
// Fluids 23 (1980) 2362-2372, for the phases; the equilibrium is found here by a bracketed Newton method.
#pragma once

#include <kerf/eos.hpp>

namespace kerf::explosives {

/// p = A exp(-R1 V) + B exp(-R2 V) + w Cv T/V, e = A/R1 exp(-R1 V) + B/R2 exp(-R2 V) + Cv T per reference volume.
struct Phase {
  double A = 0.0, B = 0.0, R1 = 1.0, R2 = 1.0, omega = 0.0;  // [Pa], [-]
  double heat_capacity = 0.0;  // Cv [J/(m3 K)]

  static void describe(Schema<Phase>& s) {
    s.real(&Phase::A, "A", "Pa", positive, "first coefficient");
    s.real(&Phase::B, "B", "Pa", any_value, "second coefficient");
    s.real(&Phase::R1, "R1", "-", positive, "first exponent");
    s.real(&Phase::R2, "R2", "-", positive, "second exponent");
    s.real(&Phase::omega, "omega", "-", positive, "Grueneisen coefficient");
    s.real(&Phase::heat_capacity, "heat_capacity", "J/(m3 K)", positive,
           "heat capacity at constant volume per reference volume");
  }

  /// At a volume ratio, without the temperature's share.
  struct Cold {
    double pressure, energy, stiffness;  // the last is -dp/dV [Pa]
  };
  Cold cold(double V) const {
    const double first = A * kerf::exp(-R1 * V), second = B * kerf::exp(-R2 * V);
    return {first + second, first / R1 + second / R2, R1 * first + R2 * second};
  }
  /// dp/dT at constant volume [Pa/K].
  double thermal(double V) const { return omega * heat_capacity / V; }
};

struct MixtureState {
  double pressure = 0.0, temperature = 0.0;  // [Pa], [K]
  double bulk_modulus = 0.0;  // adiabatic, at constant burnt share [Pa]
  double products_volume = 1.0;  // volume ratio of the products [-]
};

struct TwoPhases {
  Phase unreacted, products;
  double energy_of_unreacted = 0.0;  // e of unreacted explosive at the start [J/m3]
  double reaction_energy = 0.0;  // E0 [J/m3]

  static constexpr double pure = 1e-8;  // a share below it is none

  /// At the burnt share F, the volume ratio V and the energy E since the start per reference volume. `guess` is the
  /// volume ratio of the products in a state nearby.
  MixtureState at(double F, double V, double E, double guess) const {
    if (F < pure) return of_one(unreacted, V, E + energy_of_unreacted, guess);
    if (F > 1.0 - pure) return of_one(products, V, E + reaction_energy, V);
    const Split split = equilibrium(F, V, E, guess);
    MixtureState m;
    m.products_volume = split.products_volume;
    m.temperature = split.temperature;
    m.pressure = max_of(split.pressure, 0.0);
    // dp = -a dV + b dT of each phase, and no heat: see doc/theory/detonation.md.
    const double a1 = stiffness(unreacted, split.unreacted_volume, m.temperature),
                 a2 = stiffness(products, split.products_volume, m.temperature),
                 b1 = unreacted.thermal(split.unreacted_volume), b2 = products.thermal(split.products_volume);
    const double s0 = (1.0 - F) / a1 + F / a2, s1 = (1.0 - F) * b1 / a1 + F * b2 / a2,
                 s2 = (1.0 - F) * b1 * b1 / a1 + F * b2 * b2 / a2, C = heat_capacity(F);
    m.bulk_modulus = V / (s0 - m.temperature * s1 * s1 / (C + m.temperature * s2));
    return m;
  }

 private:
  struct Split {
    double products_volume, unreacted_volume, temperature, pressure;
  };

  double heat_capacity(double F) const { return (1.0 - F) * unreacted.heat_capacity + F * products.heat_capacity; }

  /// -dp/dV at constant temperature; the cold curve of stretched explosive falls, which must not make it negative.
  static double stiffness(const Phase& phase, double V, double T) {
    const double cold = phase.A * phase.R1 * kerf::exp(-phase.R1 * V);
    return max_of(phase.cold(V).stiffness + phase.thermal(V) * T / V, 1e-3 * cold + tiny<double>);
  }

  static MixtureState of_one(const Phase& phase, double V, double energy, double guess) {
    const Phase::Cold cold = phase.cold(V);
    MixtureState m;
    m.products_volume = guess;
    m.temperature = max_of((energy - cold.energy) / phase.heat_capacity, 0.0);
    const double b = phase.thermal(V), T = m.temperature;
    m.pressure = max_of(cold.pressure + b * T, 0.0);
    m.bulk_modulus = V * (stiffness(phase, V, T) + T * b * b / phase.heat_capacity);
    return m;
  }

  /// Newton's method for the volume ratio of the products, whose pressure less that of the unreacted explosive falls as
  /// it grows. A step that leaves the bracket, or that does not halve it in three, gives way to a halving.
  Split equilibrium(double F, double V, double E, double guess) const {
    constexpr int most_steps = 200;
    const double rest = 1.0 - F, C = heat_capacity(F), per_C = 1.0 / C;
    const double energy = E + rest * energy_of_unreacted + F * reaction_energy;
    double low = 0.02 * min_of(V, 1.0), high = V / F * (1.0 - 1e-9);
    double x = guess > low && guess < high ? guess : 0.5 * (low + min_of(high, 2.0 * V));
    double width = high - low;
    Split s{};
    for (int i = 0; i < most_steps; ++i) {
      s.products_volume = x;
      s.unreacted_volume = (V - F * x) / rest;
      const Phase::Cold p = products.cold(x), u = unreacted.cold(s.unreacted_volume);
      const double hot = (energy - rest * u.energy - F * p.energy) * per_C;
      s.temperature = max_of(hot, 0.0);
      const double bp = products.thermal(x), bu = unreacted.thermal(s.unreacted_volume), T = s.temperature;
      s.pressure = p.pressure + bp * T;
      const double excess = s.pressure - (u.pressure + bu * T);
      if (excess > 0.0)
        low = x;
      else
        high = x;
      const double warming = hot > 0.0 ? F * per_C * (p.pressure - u.pressure) : 0.0;
      const double slope =
          -(p.stiffness + bp * T / x) - (u.stiffness + bu * T / s.unreacted_volume) * (F / rest) + (bp - bu) * warming;
      double next = x - excess / slope;
      const bool slow = i % 3 == 2 && high - low > 0.5 * width;
      if (i % 3 == 2) width = high - low;
      // Over many powers of ten the middle is the geometric one.
      if (!(next > low && next < high) || slow) next = high > 4.0 * low ? std::sqrt(low * high) : 0.5 * (low + high);
      if (excess == 0.0 || std::fabs(next - x) <= 1e-14 * x) break;
      x = next;
    }
    return s;
  }
};

}  // namespace kerf::explosives
