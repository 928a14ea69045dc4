// Stiffened gas: liquids at high pressure.
//
// Source: F.H. Harlow & A.A. Amsden, "Fluid Dynamics", Los Alamos monograph LA-4700 (1971), section on the
// stiffened-gas equation of state.
#include <kerf/eos.hpp>
#include <kerf/tension_limit.hpp>

#include <cmath>
#include <limits>

namespace {

using namespace kerf;

constexpr double absent = std::numeric_limits<double>::quiet_NaN();

/// p = (g - 1) rho e - g P, with the energy e that the fluid has at the start included, and the stiffness P.
struct StiffenedGas final : PointwiseEos<StiffenedGas>, TensionLimit {
  double gamma = 0.0, stiffness = 0.0;  // [-], [Pa]
  double initial_pressure = absent, initial_energy = absent;  // [Pa], [J/m3]
  using State = NoVariables;

  static void describe(Schema<StiffenedGas>& s) {
    s.real(&StiffenedGas::gamma, "gamma", "-", Range{1.0, 20.0, true, false},
           "exponent of the adiabat, the ratio of specific heats");
    s.real(&StiffenedGas::stiffness, "stiffness", "Pa", non_negative,
           "the pressure is that of an ideal gas, less so much; gamma times it is the bulk modulus at no pressure");
    s.real(&StiffenedGas::initial_pressure, "initial_pressure", "Pa", any_value,
           "pressure at the reference density before the first step; 0 where initial_energy is absent, too")
        .optional();
    s.real(
         &StiffenedGas::initial_energy, "initial_energy", "J/m3", positive,
         "in place of initial_pressure: (p + gamma stiffness)/(gamma - 1) before the first step, the whole energy per "
         "reference volume")
        .optional();
    describe_tension_limit(s);
    s.rule("initial_energy", "give initial_pressure or initial_energy, not both",
           [](const StiffenedGas& g) { return std::isnan(g.initial_pressure) || std::isnan(g.initial_energy); });
    s.rule("stiffness",
           "the stiffness and the initial pressure (of initial_energy, too) must add up to more than nothing, else the "
           "fluid does not resist compression",
           [](const StiffenedGas& g) { return g.pressure_at_start() + g.stiffness > 0.0; });
  }
  /// What the fluid gives when it expands along its isentrope to no pressure [J/m3]. The energy that holds it together
  /// is not part of it, else errors of the energy balance would be compared with a number that means nothing.
  double initial_energy_density() const override {
    const double p = pressure_at_start();
    if (!(p > 0.0)) return 0.0;
    if (stiffness == 0.0) return energy_at_start();
    // (p + P) V^g is constant on the isentrope, and the energy at no pressure is g P V/(g - 1).
    const double widest = positive_power((p + stiffness) / stiffness, 1.0 / gamma);
    return energy_at_start() - widest * gamma * stiffness / (gamma - 1.0);
  }

  EosOutput evaluate_point(const EosInput& in, const State&) const {
    const double ratio = in.density / in.reference_density;
    const double E = in.reference_density * in.specific_energy + energy_at_start();
    const double p = (gamma - 1.0) * ratio * E - gamma * stiffness;
    return {limited(p), max_of(0.0, gamma * (p + stiffness))};
  }

 private:
  double pressure_at_start() const {
    const double given = select(std::isnan(initial_pressure), 0.0, initial_pressure);
    return select(std::isnan(initial_energy), given, (gamma - 1.0) * initial_energy - gamma * stiffness);
  }
  double energy_at_start() const { return (pressure_at_start() + gamma * stiffness) / (gamma - 1.0); }
};

}  // namespace

KERF_EOS(StiffenedGas, "stiffened_gas", "liquid as an ideal gas under an inner pressure")
