// Ideal gas with constant specific heats.
//
// Source: any text on gas dynamics, for example H.W. Liepmann & A. Roshko, Elements of Gasdynamics (1957), chapter 1.
#include <kerf/eos.hpp>

namespace {

using namespace kerf;

/// p = (g - 1) rho e, with the energy e that the gas has at the start included. A gas does not pull.
struct IdealGas final : PointwiseEos<IdealGas> {
  double gamma = 0.0;  // [-]
  double initial_pressure = -1.0, initial_energy = -1.0;  // [Pa], [J/m3]; negative: not given
  using State = NoVariables;

  static void describe(Schema<IdealGas>& s) {
    s.real(&IdealGas::gamma, "gamma", "-", Range{1.0, 10.0, true, false}, "ratio of the specific heats");
    s.real(&IdealGas::initial_pressure, "initial_pressure", "Pa", non_negative,
           "pressure at the reference density before the first step")
        .optional();
    s.real(&IdealGas::initial_energy, "initial_energy", "J/m3", non_negative,
           "internal energy per reference volume at the start, in place of initial_pressure")
        .optional();
    s.rule("initial_pressure", "give either initial_pressure or initial_energy",
           [](const IdealGas& g) { return (g.initial_pressure >= 0.0) != (g.initial_energy >= 0.0); });
  }
  double initial_energy_density() const override {
    return initial_energy >= 0.0 ? initial_energy : initial_pressure / (gamma - 1.0);
  }

  EosOutput evaluate_point(const EosInput& in, const State&) const {
    const double at_start = select(initial_energy >= 0.0, initial_energy, initial_pressure / (gamma - 1.0));
    const double ratio = in.density / in.reference_density;
    const double E = in.reference_density * in.specific_energy + at_start;
    const double p = max_of(0.0, (gamma - 1.0) * ratio * E);
    return {p, gamma * p};
  }
};

}  // namespace

KERF_EOS(IdealGas, "ideal_gas", "gas with constant specific heats")
