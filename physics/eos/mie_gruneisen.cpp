// Mie-Grueneisen equation of state about a shock Hugoniot, linear or cubic.
//
// Sources: D.J. Steinberg, "Equation of state and strength properties of selected materials", UCRL-MA-106439 (1996);
// M.A. Meyers, Dynamic Behavior of Materials (1994), chapters 4 and 5.
#include <kerf/eos.hpp>
#include <kerf/tension_limit.hpp>

#include <cmath>
#include <limits>

namespace {

using namespace kerf;

/// p = pH (1 - g eta/2) + rho0 g e with eta = 1 - rho0/rho, g = gamma0 + b mu, mu = rho/rho0 - 1, and the Hugoniot
/// pH = rho0 c0^2 eta / (1 - s eta - s2 eta^2 - s3 eta^3)^2 of us = c0 + s up + s2 up^2/us + s3 up^3/us^2. In tension
/// p = rho0 c0^2 mu + rho0 g e. The energy rho0 e includes that at the start.
///
/// A law for blocks rather than points: where the Hugoniot ends is computed once for all points of a block.
struct MieGruneisen final : Eos, TensionLimit {
  double c0 = 0.0;  // [m/s]
  double s = 0.0, s2 = 0.0, s3 = 0.0, gamma0 = 0.0, b = 0.0;  // [-]
  double initial_energy = 0.0;  // [J/m3]
  using State = NoVariables;

  static void describe(Schema<MieGruneisen>& schema) {
    schema.real(&MieGruneisen::c0, "c0", "m/s", positive, "shock velocity at vanishing particle velocity")
        .usual(between(50.0, 2e4));
    schema.real(&MieGruneisen::s, "s", "-", non_negative, "slope of shock velocity over particle velocity")
        .usual(between(0.0, 5.0));
    schema.real(&MieGruneisen::s2, "s2", "-", any_value, "coefficient of (up/us) up in the shock velocity")
        .by_default("0");
    schema.real(&MieGruneisen::s3, "s3", "-", any_value, "coefficient of (up/us)^2 up in the shock velocity")
        .by_default("0");
    schema.real(&MieGruneisen::gamma0, "gamma0", "-", non_negative, "Grueneisen parameter at the reference density")
        .usual(between(0.0, 5.0));
    schema
        .real(&MieGruneisen::b, "gamma_slope", "-", any_value,
              "first-order volume correction b: Grueneisen parameter (gamma0 + b mu)/(1 + mu)")
        .by_default("0");
    schema
        .real(&MieGruneisen::initial_energy, "initial_energy", "J/m3", any_value,
              "internal energy per reference volume at the start")
        .by_default("0");
    describe_tension_limit(schema);
  }
  double initial_energy_density() const override { return initial_energy; }

  void evaluate(const EosBatch& b) const override {
    alignas(64) double density[lane_width], energy[lane_width], pressure[lane_width], modulus[lane_width];
    for (int l = 0; l < lane_width; ++l) {
      density[l] = b.density[l];
      energy[l] = b.specific_energy[l];
    }
    const double rho0 = b.reference_density, end = last_monotone();
#pragma omp simd
    for (int l = 0; l < lane_width; ++l) {
      const EosOutput out = at_point(density[l], energy[l], rho0, end);
      pressure[l] = out.pressure;
      modulus[l] = out.bulk_modulus;
    }
    for (int l = 0; l < lane_width; ++l) {
      b.pressure[l] = pressure[l];
      b.bulk_modulus[l] = modulus[l];
    }
  }

 private:
  static constexpr double least_room = 0.02;

  [[gnu::always_inline]] EosOutput at_point(double density, double specific_energy, double rho0, double end) const {
    const double ratio = density / rho0, mu = ratio - 1.0;
    const double stiffness = rho0 * c0 * c0, energy = rho0 * specific_energy + initial_energy;
    const double g = gamma0 + b * mu;
    // The Hugoniot ends where the denominator vanishes or the pressure would fall; from there on the denominator is
    // held, so that the pressure stays finite and rises.
    const double eta = max_of(mu / ratio, 0.0), within = min_of(eta, end);
    const double left = 1.0 - (s + (s2 + s3 * within) * within) * within, kept = max_of(left, least_room);
    const double room = 1.0 / kept;
    const double hugoniot = stiffness * eta * room * room;
    const bool is_held = !((left > least_room) & (eta <= end));
    const double steepness = select(is_held, kept, rise(eta));
    const double hugoniot_slope = stiffness * steepness * room * room * room;  // d pH / d eta
    const double thermal = b * (energy - 0.5 * eta * hugoniot);
    const double compressed = hugoniot * (1.0 - 0.5 * g * eta) + g * energy;
    const double compressed_slope =
        (hugoniot_slope * (1.0 - 0.5 * g * eta) - 0.5 * g * hugoniot) / ratio + ratio * thermal;  // rho dp/drho
    const bool tension = mu < 0.0;
    const double p = select(tension, stiffness * mu + g * energy, compressed);
    const double slope = select(tension, ratio * (stiffness + b * energy), compressed_slope);
    // Cold states beyond the end would let the pressure fall on the isentrope; the solid stays as stiff as it began.
    return {limited(p), max_of(select(is_held, stiffness, 0.0), slope + g * limited(p) / ratio)};
  }

  /// d pH / d eta over rho0 c0^2, times the third power of the denominator 1 - s eta - s2 eta^2 - s3 eta^3.
  double rise(double eta) const { return 1.0 + (s + (3.0 * s2 + 5.0 * s3 * eta) * eta) * eta; }

  /// The eta from which the denominator is held, where a cubic Hugoniot would fall before eta is one, or its
  /// denominator reaches zero and grows again; else infinite. It is where the denominator is least, the first root of
  /// s + 2 s2 eta + 3 s3 eta^2: there the pressure goes over to the held one without a kink.
  double last_monotone() const {
    constexpr double never = std::numeric_limits<double>::infinity();
    if (s2 == 0.0 && s3 == 0.0) return never;
    const double root = std::sqrt(max_of(s2 * s2 - 3.0 * s * s3, 0.0)), below = root - s2;
    const bool turns = (s2 * s2 >= 3.0 * s * s3) & (below > 0.0);
    const double turn = s / select(turns, below, 1.0);
    const double left = 1.0 - (s + (s2 + s3 * turn) * turn) * turn;
    // Where the rise is least: its slope is s + 6 s2 eta + 15 s3 eta^2, which for s3 <= 0 falls to the end of eta.
    const double lowest =
        (std::sqrt(max_of(9.0 * s2 * s2 - 15.0 * s * s3, 0.0)) - 3.0 * s2) / (15.0 * select(s3 > 0.0, s3, 1.0));
    const double at_worst = rise(min_of(select(s3 > 0.0, lowest, 1.0), 1.0));
    return select(turns & ((at_worst <= 0.0) | (left <= least_room)), turn, never);
  }
};

}  // namespace

KERF_EOS(MieGruneisen, "mie_gruneisen", "Mie-Grueneisen pressure about a linear or cubic shock Hugoniot")
