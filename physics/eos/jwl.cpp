// Jones-Wilkins-Lee equation of state of detonation products, with programmed burn of the explosive that they come
// from.
//
// Sources: E.L. Lee, H.C. Hornig & J.W. Kury, "Adiabatic expansion of high explosive detonation products", UCRL-50422
// (1968), for the pressure; M.L. Wilkins, "Calculation of elastic-plastic flow", Methods in Computational Physics 3
// (1964) 211-263, and J.O. Hallquist, LS-DYNA Theory Manual (2006), section 19.8, for the burn fraction.
#include <kerf/eos.hpp>

#include <algorithm>
#include <stdexcept>

namespace {

using namespace kerf;

/// A point where the detonation starts.
struct Detonator {
  Vec3 point;  // [m]
  double time = 0.0;  // [s]

  static void describe(Schema<Detonator>& s) {
    s.vector(&Detonator::point, "point", "m", any_value, "where the detonation starts");
    s.real(&Detonator::time, "time", "s", non_negative, "when it starts").by_default("0");
  }
};

/// p = F [A (1 - w/(R1 V)) exp(-R1 V) + B (1 - w/(R2 V)) exp(-R2 V) + w E/V], with V = rho0/rho, the energy
/// E per reference volume, and the burn fraction F. The detonation runs from the detonators in straight lines with
/// velocity D and reaches a point at its lighting time. F is the greater of 2 D (t - t_l)/(3 h), with the element's
/// length h, and (1 - V)/(1 - V_CJ); once it is one, it stays one.
struct Jwl final : PointwiseEos<Jwl> {
  double A = 0.0, B = 0.0, R1 = 0.0, R2 = 0.0, omega = 0.0;  // [Pa], [-]
  double initial_energy = 0.0;  // [J/m3]
  double detonation_velocity = 0.0, cj_pressure = 0.0;  // [m/s], [Pa]; 0: not given
  std::string burn;
  std::vector<std::unique_ptr<Detonator>> detonators;

  struct State {
    double burn_fraction, lighting_time;
  };
  static constexpr unsigned inputs = with_length;
  static constexpr double never = 1e30;  // [s]
  static constexpr double least_fraction = 1e-4;  // what is less is round-off of the volume, and would light explosive

  static void describe(Schema<Jwl>& s) {
    s.real(&Jwl::A, "A", "Pa", positive, "first coefficient");
    s.real(&Jwl::B, "B", "Pa", any_value, "second coefficient");
    s.real(&Jwl::R1, "R1", "-", positive, "first exponent");
    s.real(&Jwl::R2, "R2", "-", positive, "second exponent");
    s.real(&Jwl::omega, "omega", "-", positive, "Grueneisen coefficient of the products");
    s.real(&Jwl::initial_energy, "initial_energy", "J/m3", positive, "energy of detonation per reference volume");
    s.real(&Jwl::detonation_velocity, "detonation_velocity", "m/s", positive,
           "velocity of the detonation; needed where there are detonators")
        .optional();
    s.real(&Jwl::cj_pressure, "cj_pressure", "Pa", positive,
           "Chapman-Jouguet pressure; needed where there are detonators and compression burns")
        .optional();
    s.choice(&Jwl::burn, "burn", {"both", "time", "compression"},
             "what burns the explosive: the lighting time, compression beyond the Chapman-Jouguet volume, or both")
        .by_default("both");
    s.block_list(&Jwl::detonators, "detonators", "where and when the detonation starts; without any, all is burnt")
        .optional();
    s.rule("detonators", "detonators need the key detonation_velocity",
           [](const Jwl& j) { return j.detonators.empty() || j.detonation_velocity > 0.0; });
    s.rule("detonators", "detonators need the key cj_pressure, unless burn is time",
           [](const Jwl& j) { return j.detonators.empty() || j.cj_pressure > 0.0 || j.burn == "time"; });
    s.state(&State::burn_fraction, "burn_fraction", "-", 0.0, "burnt share of the explosive").within(fraction);
    s.state(&State::lighting_time, "lighting_time", "s", never, "time at which the detonation arrives")
        .within(non_negative);
  }
  double initial_energy_density() const override { return initial_energy; }

  void initialise_point(const InitialPoint& point, State& state) const {
    if (detonators.empty()) {
      state = {1.0, 0.0};
      return;
    }
    if (burn != "time" && cj_pressure >= point.density * detonation_velocity * detonation_velocity)
      throw std::runtime_error(
          "jwl: cj_pressure is not below density times detonation_velocity squared; expected about a quarter of it");
    state.burn_fraction = 0.0;
    for (const auto& d : detonators)
      state.lighting_time =
          std::min(state.lighting_time, d->time + norm(point.position - d->point) / detonation_velocity);
  }

  EosOutput evaluate_point(const EosInputWith<inputs>& in, State& state) const {
    const double V = in.volume_ratio();
    state.burn_fraction = burnt_share(in, V, state);
    const double F = state.burn_fraction;
    const double first = A * kerf::exp(-R1 * V), second = B * kerf::exp(-R2 * V);
    const double E = in.reference_density * in.specific_energy + initial_energy, share = omega / V;
    const double products = first * (1.0 - share / R1) + second * (1.0 - share / R2) + share * E;
    // -V dp/dV at constant energy, and what the work of the pressure adds on the isentrope.
    const double slope = first * (R1 * V - omega - share / R1) + second * (R2 * V - omega - share / R2) + share * E;
    const double p = F * max_of(products, 0.0);
    const double burnt = max_of(F * (slope + omega * p), 0.0);
    // Compression that burns raises the pressure twice. What has not burnt is stiff as the detonation is fast.
    const bool burns = (F > 0.0) & (F < 1.0) & (burn.front() != 't');
    const double burning = select(burns, V * max_of(products, 0.0) / (compression_to_burn(in) + tiny<double>), 0.0);
    const double arriving = in.density * detonation_velocity * detonation_velocity * (1.0 - F);
    return {p, max_of(burnt + burning, arriving)};
  }

 private:
  /// 1 - V_CJ, from the jump of mass and momentum over the detonation.
  double compression_to_burn(const EosInput& in) const {
    return cj_pressure / (in.reference_density * detonation_velocity * detonation_velocity + tiny<double>);
  }
  double burnt_share(const EosInputWith<inputs>& in, double V, const State& state) const {
    const bool by_time = burn.front() != 'c', by_compression = burn.front() != 't' && cj_pressure > 0.0;
    const double D = detonation_velocity;
    const double since = select(by_time, max_of(in.time - state.lighting_time, 0.0), 0.0);
    const double burnt = (2.0 / 3.0) * D * since / (in.length + tiny<double>);
    const double compressed =
        select(by_compression, max_of(1.0 - V, 0.0) / (compression_to_burn(in) + tiny<double>), 0.0);
    const double most = min_of(max_of(burnt, compressed), 1.0);
    return select(state.burn_fraction >= 1.0, 1.0, select(most < least_fraction, 0.0, most));
  }
};

}  // namespace

KERF_EOS(Jwl, "jwl", "detonation products (Jones-Wilkins-Lee), with programmed burn from points")
