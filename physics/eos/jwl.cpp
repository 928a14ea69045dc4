// Jones-Wilkins-Lee equation of state of detonation products, with programmed burn of the explosive that they come
// from.
//
// Sources: E.L. Lee, H.C. Hornig & J.W. Kury, "Adiabatic expansion of high explosive detonation products", UCRL-50422
// (1968), for the pressure; M.L. Wilkins, "Calculation of elastic-plastic flow", Methods in Computational Physics 3
// (1964) 211-263, and J.O. Hallquist, LS-DYNA Theory Manual (2006), section 19.8, for the burn fraction.
#include <algorithm>
#include <cmath>
#include <cstdio>
#include <stdexcept>

#include "explosives/detonator.hpp"
#include "explosives/products.hpp"

namespace {

using namespace kerf;
using namespace kerf::explosives;

/// p = F [A (1 - w/(R1 V)) exp(-R1 V) + B (1 - w/(R2 V)) exp(-R2 V) + w E/V], with V = rho0/rho, the energy
/// E per reference volume, and the burn fraction F. The detonation runs from the detonators with velocity D, in
/// straight lines or round what is no explosive, and reaches a point at its lighting time. F is the greater of 2 D (t -
/// t_l)/(3 h), with the element's length h, and (1 - V)/(1 - V_CJ); once it is one, it stays one.
struct Jwl final : PointwiseEos<Jwl>, DensityCheckedLaw, WarningLaw, EnergyHolder, FrontLaw {
  double A = 0.0, B = 0.0, R1 = 0.0, R2 = 0.0, omega = 0.0;  // [Pa], [-]
  double initial_energy = 0.0;  // [J/m3]
  double detonation_velocity = 0.0, cj_pressure = 0.0;  // [m/s], [Pa]; 0: not given
  std::string burn, arrival;
  Detonators detonators;

  struct State {
    double burn_fraction, lighting_time;
  };
  static constexpr unsigned inputs = with_length;
  static constexpr double least_fraction = 1e-4;  // what is less is round-off of the volume, and would light explosive

  static void describe(Schema<Jwl>& s) {
    s.real(&Jwl::A, "A", "Pa", non_negative, "first coefficient");
    s.real(&Jwl::B, "B", "Pa", any_value, "second coefficient");
    s.real(&Jwl::R1, "R1", "-", positive, "first exponent");
    s.real(&Jwl::R2, "R2", "-", positive, "second exponent");
    s.real(&Jwl::omega, "omega", "-", positive, "Grueneisen coefficient of the products");
    s.real(&Jwl::initial_energy, "initial_energy", "J/m3", positive, "energy of detonation per reference volume")
        .usual(between(1e8, 3e10));
    s.real(&Jwl::detonation_velocity, "detonation_velocity", "m/s", positive,
           "velocity of the detonation; that of the Chapman-Jouguet state where absent")
        .optional();
    s.real(&Jwl::cj_pressure, "cj_pressure", "Pa", positive,
           "pressure behind the detonation; that of the Chapman-Jouguet state where absent")
        .optional();
    s.choice(&Jwl::burn, "burn", {"both", "time", "compression"},
             "what burns the explosive: the lighting time, compression beyond the Chapman-Jouguet volume, or both")
        .by_default("both");
    s.choice(&Jwl::arrival, "arrival", {"straight", "eikonal"},
             "way of the detonation: straight lines through everything, or the shortest way inside the explosive")
        .by_default("straight");
    s.block_list(&Jwl::detonators, "detonators",
                 "where and when the detonation starts; without any, all is burnt, unless `burn` is compression or "
                 "`arrival` is eikonal")
        .optional();
    s.rule("burn", "`burn: time` needs the key detonators, or `arrival: eikonal` and another explosive beside it",
           [](const Jwl& j) { return j.burn != "time" || j.starts_unburnt(); });
    s.rule("detonators", "the key `normal` of a detonator must not be zero", [](const Jwl& j) {
      return std::none_of(j.detonators.begin(), j.detonators.end(),
                          [](const auto& d) { return d->is_plane() && !(norm(d->normal) > 0.0); });
    });
    s.state(&State::burn_fraction, "burn_fraction", "-", 0.0, "burnt share of the explosive").within(fraction);
    s.state(&State::lighting_time, "lighting_time", "s", never, "time at which the detonation arrives")
        .within(non_negative);
  }
  double initial_energy_density() const override { return initial_energy; }

  void initialise_point(const InitialPoint& point, State& state) const {
    if (!starts_unburnt()) {
      state = {1.0, 0.0};
      return;
    }
    for (const ParameterComplaint& complaint : complaints(point.density)) throw std::runtime_error(complaint.sentence);
    state.burn_fraction = 0.0;
    if (!asks_for_arrival() && burn != "compression")
      state.lighting_time = first_arrival(detonators, point.position, velocity(point.density));
  }

  EosOutput evaluate_point(const EosInputWith<inputs>& in, State& state) const {
    const double V = in.volume_ratio(), D = velocity(in.reference_density);
    // 1 - V_CJ, from the jump of mass and momentum over the detonation.
    const double to_burn = pressure_behind() / (in.reference_density * D * D + tiny<double>);
    state.burn_fraction = burnt_share(in, V, D, to_burn, state);
    const double F = state.burn_fraction;
    const auto [products, modulus] =
        Products{A, B, R1, R2, omega}.at(V, in.reference_density * in.specific_energy + initial_energy);
    // Compression that burns raises the pressure twice. What has not burnt is stiff as the detonation is fast.
    const bool burns = (F > 0.0) & (F < 1.0) & (burn.front() != 't');
    const double burning = select(burns, V * products / (to_burn + tiny<double>), 0.0);
    const double arriving = in.density * D * D * (1.0 - F);
    return {F * products, max_of(max_of(F * modulus, 0.0) + burning, arriving)};
  }

  std::vector<ParameterComplaint> complaints(double reference_density) const override {
    if (!starts_unburnt()) return {};
    find_detonation();
    if (!has_velocity_and_pressure())
      return {{"",
               "the constants of jwl have no Chapman-Jouguet state, from which the detonation's velocity and "
               "pressure follow; expected a set of constants of one explosive, or the keys detonation_velocity "
               "and cj_pressure"}};
    const double D = velocity(reference_density), most = reference_density * D * D;
    if (burn == "time" || pressure_behind() < most) return {};
    return {{cj_pressure > 0.0 ? "cj_pressure" : "detonation_velocity",
             text("the pressure behind the detonation, %.4g Pa, is not below density times velocity squared, %.4g Pa "
                  "for %.4g kg/m3 and %.4g m/s; expected about a quarter of it: check cj_pressure, "
                  "detonation_velocity and density",
                  pressure_behind(), most, reference_density, D)}};
  }

  std::vector<std::string> warnings(LawUse& use) const override {
    if (!starts_unburnt()) {
      const bool some = detonation_velocity > 0.0 || cj_pressure > 0.0;
      return {"no detonator is given, so that the explosive of part " + use.part + " is burnt at the start" +
              (some ? " and detonation_velocity and cj_pressure have no effect" : "") +
              "; name detonators, or burn it by compression"};
    }
    std::vector<std::string> lines;
    warn_of_other_detonation(use, lines);
    if (burn == "compression") {
      if (!detonators.empty())
        lines.push_back("`burn: compression` uses no detonators; leave them out, or burn by both");
      if (arrival == "eikonal")
        lines.push_back("`arrival: eikonal` has no effect with `burn: compression`; leave it out, or burn by both");
      return lines;
    }
    for (std::size_t k = 0; k < detonators.size(); ++k)
      if (detonators[k]->time >= use.end)
        lines.push_back(
            text("detonator %zu of part %s lights at %.3g s, and the run ends at %.3g s; raise time.end, or "
                 "let it light earlier",
                 k + 1, use.part.c_str(), detonators[k]->time, use.end));
    warn_of_far_detonators(use, lines);
    warn_of_arrival(use, lines);
    return lines;
  }

  double energy_held(std::span<const double> state) const override { return (1.0 - state[0]) * initial_energy; }
  bool acts_by_itself() const override { return burn != "compression"; }

  bool asks_for_arrival() const override { return arrival == "eikonal" && burn != "compression"; }
  double front_speed(double reference_density) const override { return velocity(reference_density); }
  int n_origins() const override { return static_cast<int>(detonators.size()); }
  FrontOrigin origin(int number, Vec3 x) const override {
    const Detonator& d = *detonators[static_cast<std::size_t>(number)];
    return {d.nearest(x), d.time};
  }
  std::string arrival_variable() const override { return "lighting_time"; }

 private:
  /// Without anything that could light it, the law is that of products.
  bool starts_unburnt() const { return !detonators.empty() || burn == "compression" || arrival == "eikonal"; }

  bool has_velocity_and_pressure() const { return cj_.exists || (detonation_velocity > 0.0 && cj_pressure > 0.0); }

  /// What is not given follows from the other constants. Found when the law is first asked, and once: it does not
  /// depend on the point.
  void find_detonation() const {
    if (!has_velocity_and_pressure()) cj_ = find_cj({A, B, R1, R2, omega}, initial_energy);
  }
  double velocity(double reference_density) const {
    return select(detonation_velocity > 0.0, detonation_velocity, cj_.velocity(reference_density));
  }
  double pressure_behind() const { return select(cj_pressure > 0.0, cj_pressure, cj_.pressure); }

  double burnt_share(const EosInputWith<inputs>& in, double V, double D, double to_burn, const State& state) const {
    const bool by_time = burn.front() != 'c', by_compression = burn.front() != 't' && pressure_behind() > 0.0;
    const double since = select(by_time, max_of(in.time - state.lighting_time, 0.0), 0.0);
    const double burnt = (2.0 / 3.0) * D * since / (in.length + tiny<double>);
    const double compressed = select(by_compression, max_of(1.0 - V, 0.0) / (to_burn + tiny<double>), 0.0);
    const double most = min_of(max_of(burnt, compressed), 1.0);
    return select(state.burn_fraction >= 1.0, 1.0, select(most < least_fraction, 0.0, most));
  }

  template <class... Values>
  static std::string text(const char* format, Values... values) {
    char line[512];
    std::snprintf(line, sizeof line, format, values...);
    return line;
  }

  /// The front that the lighting times describe, and the one that the equation of state makes, drift apart where the
  /// constants belong to different explosives.
  void warn_of_other_detonation(const LawUse& use, std::vector<std::string>& lines) const {
    constexpr double much = 0.01;
    const CjState cj = find_cj({A, B, R1, R2, omega}, initial_energy);
    if (!cj.exists) {
      lines.push_back(
          "the constants of jwl have no Chapman-Jouguet state; check A, B, R1, R2, omega and initial_energy");
      return;
    }
    const auto differ = [](double given, double found) { return given > 0.0 && std::fabs(given / found - 1.0) > much; };
    if (const double D = cj.velocity(use.density); differ(detonation_velocity, D))
      lines.push_back(
          text("the constants of jwl give a detonation velocity of %.5g m/s with the density of part %s, %+.1f "
               "%% from the detonation_velocity of %.5g m/s; check constants and density, or leave "
               "detonation_velocity out",
               D, use.part.c_str(), 100.0 * (D / detonation_velocity - 1.0), detonation_velocity));
    if (differ(cj_pressure, cj.pressure))
      lines.push_back(
          text("the constants of jwl give a Chapman-Jouguet pressure of %.4g Pa, %+.1f %% from the cj_pressure "
               "of %.4g Pa; check the constants, or leave cj_pressure out",
               cj.pressure, 100.0 * (cj.pressure / cj_pressure - 1.0), cj_pressure));
  }

  /// A detonator that lies off the explosive lights it late, and is most likely in the wrong place or unit.
  void warn_of_far_detonators(LawUse& use, std::vector<std::string>& lines) const {
    for (std::size_t k = 0; k < detonators.size(); ++k) {
      const Detonator& d = *detonators[k];
      const double off = use.distance([&d](Vec3 x) { return d.nearest(x); });
      if (!(off > 2.0 * use.length)) continue;
      lines.push_back(
          text("detonator %zu lies %.3g m off the nearest element of its explosive, which is lit late by %.3g s; "
               "place it inside",
               k + 1, off, off / velocity(use.density)));
    }
  }

  void warn_of_arrival(LawUse& use, std::vector<std::string>& lines) const {
    if (const std::int64_t n = use.count_from("lighting_time", never); n > 0)
      lines.push_back(
          text("the detonation never reaches %lld of the %lld elements of part %s; place a detonator in that "
               "piece of the explosive, or join it with one that burns",
               static_cast<long long>(n), static_cast<long long>(use.n_elements), use.part.c_str()));
    else if (const double last = use.greatest("lighting_time", never); last > use.end)
      lines.push_back(
          text("the detonation reaches the last element of part %s at %.3g s, and the run ends at %.3g s; raise "
               "time.end if all is to burn",
               use.part.c_str(), last, use.end));
    // Measured with TNT, see tests/data/laws/burn_mesh_convergence.csv: 3.7 % of the pressure behind the detonation at
    // 25 cells, and half of that with twice as many.
    constexpr double error_of_one = 0.93;
    constexpr int fewest = 50;
    const double first = use.least("lighting_time"), last = use.greatest("lighting_time", never);
    const double cells = (last - first) * velocity(use.density) / use.length + 1.0;
    if (!(last >= first) || cells >= fewest) return;
    lines.push_back(
        text("the detonation runs over %.0f cells of part %s, with which the pressure behind it is off by about "
             "%.0f %% of its greatest value on average; use %d cells or more along its way",
             cells, use.part.c_str(), 100.0 * error_of_one / cells, fewest));
  }

  mutable CjState cj_;  // of the law's own constants; unused where velocity and pressure are given
};

}  // namespace

KERF_EOS(Jwl, "jwl", "detonation products (Jones-Wilkins-Lee), with programmed burn")
