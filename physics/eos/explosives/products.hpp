// The pressure of detonation products after Jones, Wilkins and Lee, and the state to which a detonation takes the
// explosive (Chapman and Jouguet).
//
// Sources: E.L. Lee, H.C. Hornig & J.W. Kury, UCRL-50422 (1968), for the pressure; W. Fickett & W.C. Davis, Detonation
// (University of California Press, 1979), section 2A, for the Chapman-Jouguet state.
#pragma once

#include <kerf/math.hpp>

namespace kerf::explosives {

struct PressureAndModulus {
  double pressure = 0.0;  // [Pa]
  double bulk_modulus = 0.0;  // adiabatic [Pa]
};

/// p = A (1 - w/(R1 V)) exp(-R1 V) + B (1 - w/(R2 V)) exp(-R2 V) + w E/V.
struct Products {
  double A = 0.0, B = 0.0, R1 = 1.0, R2 = 1.0, omega = 0.0;  // [Pa], [-]

  /// At the volume ratio V and the energy E per reference volume [J/m3]. Where the pressure is negative, it is 0.
  [[gnu::always_inline]] PressureAndModulus at(double V, double E) const {
    const double first = A * kerf::exp(-R1 * V), second = B * kerf::exp(-R2 * V), share = omega / V;
    const double p = max_of(first * (1.0 - share / R1) + second * (1.0 - share / R2) + share * E, 0.0);
    // -V dp/dV at constant energy, and what the work of the pressure adds on the isentrope.
    const double slope = first * (R1 * V - omega - share / R1) + second * (R2 * V - omega - share / R2) + share * E;
    return {p, slope + omega * p};
  }
};

/// Behind a detonation in explosive without pressure.
struct CjState {
  bool exists = false;
  double volume_ratio = 0.0;  // [-]
  double pressure = 0.0;  // [Pa]
  double impedance = 0.0;  // rho0 D^2 [Pa]

  double velocity(double reference_density) const { return std::sqrt(impedance / reference_density); }
};

/// Where the line from (V = 1, p = 0) touches the curve of states p(V, E) with E = E0 + p (1 - V)/2: there the
/// isentrope has the slope of the line, K/V = p/(1 - V). Between states that are less compressed, K/V lies below it. A
/// search in equal steps finds the first change of sign, so that no starting value is needed, and halvings find the
/// place to round-off.
inline CjState find_cj(const Products& products, double E0) {
  constexpr int n_steps = 4000, n_halvings = 60;
  // p is linear in E, and so found in one division: p = p(V, E0) / (1 - omega (1 - V)/(2 V)).
  const auto pressure = [&](double V) {
    const double rest = 1.0 - 0.5 * products.omega * (1.0 - V) / V;
    return rest > 0.0 ? products.at(V, E0).pressure / rest : -1.0;
  };
  const auto is_beyond = [&](double V) {
    const double p = pressure(V);
    return products.at(V, E0 + 0.5 * p * (1.0 - V)).bulk_modulus * (1.0 - V) >= V * p;
  };
  CjState cj;
  double above = 1.0;
  for (int i = 1; i < n_steps && !cj.exists; ++i) {
    double below = 1.0 - static_cast<double>(i) / n_steps;
    if (!(pressure(below) > 0.0)) break;
    if (is_beyond(below)) {
      cj.exists = true;
      for (int k = 0; k < n_halvings; ++k) {
        const double middle = 0.5 * (above + below);
        (is_beyond(middle) ? below : above) = middle;
      }
      cj.volume_ratio = below;
    }
    above = below;
  }
  if (!cj.exists) return cj;
  cj.pressure = pressure(cj.volume_ratio);
  cj.impedance = cj.pressure / (1.0 - cj.volume_ratio);
  return cj;
}

}  // namespace kerf::explosives
