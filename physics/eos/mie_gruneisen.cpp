// Mie-Grueneisen equation of state about a linear shock Hugoniot.
//
// Sources: D.J. Steinberg, "Equation of state and strength properties of selected materials", UCRL-MA-106439 (1996);
// M.A. Meyers, Dynamic Behavior of Materials (1994), chapters 4 and 5.
#include <kerf/eos.hpp>

#include <limits>

namespace {

using namespace kerf;

/// p = pH (1 - g eta/2) + rho0 g e with eta = 1 - rho0/rho, g = gamma0 + b mu, mu = rho/rho0 - 1, and the Hugoniot
/// pH = rho0 c0^2 eta / (1 - s eta)^2 of us = c0 + s up. In tension p = rho0 c0^2 mu + rho0 g e.
struct MieGruneisen final : PointwiseEos<MieGruneisen> {
  double c0 = 0.0;  // [m/s]
  double s = 0.0, gamma0 = 0.0, b = 0.0;  // [-]
  double tension_limit = std::numeric_limits<double>::infinity();  // [Pa]
  using State = NoVariables;

  static void describe(Schema<MieGruneisen>& schema) {
    schema.real(&MieGruneisen::c0, "c0", "m/s", positive, "shock velocity at vanishing particle velocity");
    schema.real(&MieGruneisen::s, "s", "-", non_negative, "slope of shock velocity over particle velocity");
    schema.real(&MieGruneisen::gamma0, "gamma0", "-", non_negative, "Grueneisen parameter at the reference density");
    schema
        .real(&MieGruneisen::b, "gamma_slope", "-", any_value,
              "first-order volume correction b: Grueneisen parameter (gamma0 + b mu)/(1 + mu)")
        .by_default("0");
    schema
        .real(&MieGruneisen::tension_limit, "tension_limit", "Pa", non_negative,
              "the pressure never falls below minus this; no limit where absent")
        .optional();
  }

  EosOutput evaluate_point(const EosInput& in, const State&) const {
    const double rho0 = in.reference_density, ratio = in.density / rho0, mu = ratio - 1.0;
    const double stiffness = rho0 * c0 * c0, energy = rho0 * in.specific_energy;
    const double g = gamma0 + b * mu;
    // The Hugoniot ends where 1 - s eta vanishes; short of that the pressure is held finite.
    const double eta = max_of(mu / ratio, 0.0), room = 1.0 / max_of(1.0 - s * eta, 0.02);
    const double hugoniot = stiffness * eta * room * room;
    const double hugoniot_slope = stiffness * (1.0 + s * eta) * room * room * room;  // d pH / d eta
    const double thermal = b * (energy - 0.5 * eta * hugoniot);
    const double compressed = hugoniot * (1.0 - 0.5 * g * eta) + g * energy;
    const double compressed_slope =
        (hugoniot_slope * (1.0 - 0.5 * g * eta) - 0.5 * g * hugoniot) / ratio + ratio * thermal;  // rho dp/drho
    const bool tension = mu < 0.0;
    const double p = select(tension, stiffness * mu + g * energy, compressed);
    const double slope = select(tension, ratio * (stiffness + b * energy), compressed_slope);
    return {max_of(-tension_limit, p), max_of(0.0, slope + g * p / ratio)};
  }
};

}  // namespace

KERF_EOS(MieGruneisen, "mie_gruneisen", "Mie-Grueneisen pressure about a linear shock Hugoniot")
