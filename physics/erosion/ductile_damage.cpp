// Ductile damage over a failure strain that is given at triaxialities, nonlinear in the strain, with an instability at
// which softening begins: the form of GISSMO.
//
// Source: F. Neukamm, M. Feucht & A. Haufe, "Considering damage history in crashworthiness simulations" (2008).
#include "accumulated_damage.hpp"

namespace {

using namespace kerf;

/// D' = (n/ef) D^(1 - 1/n) ep', that is D^(1/n) grows by ep'/ef; the instability F likewise with the critical strain.
/// D = 1 is failure, or where softening by a fracture energy begins; softening over damage begins at F = 1.
struct DuctileDamage final : AccumulatedDamage<DuctileDamage> {
  std::vector<double> triaxialities, failure_strain, critical_strain;  // [-]
  double damage_exponent = 1.0;  // n [-]
  using Reads = DamageReads;
  struct State : DamageState {
    double instability, damage_at_instability;  // [-]
  };

  static void describe(Schema<DuctileDamage>& s) {
    using Law = DuctileDamage;
    s.reals(&Law::failure_strain, "failure_strain", "-", positive,
            "plastic strain at failure: one value, or one for each of the triaxialities, linear between them and "
            "constant outside");
    s.reals(&Law::triaxialities, "triaxialities", "-", any_value,
            "mean over equivalent stress, tension positive, ascending")
        .optional();
    s.reals(&Law::critical_strain, "critical_strain", "-", positive,
            "plastic strain at which `softening: stress` begins, as many values as failure_strain has; without it "
            "softening begins at critical_damage")
        .optional();
    s.real(&Law::damage_exponent, "damage_exponent", "-", Range{0.0, 20.0, true, false},
           "n of the damage (ep/ef)^n at constant triaxiality")
        .by_default("1");
    const auto as_many = [](const Law& l) { return l.triaxialities.empty() ? 1 : l.triaxialities.size(); };
    s.rule("failure_strain", "expected one value, or as many as there are triaxialities",
           [as_many](const Law& l) { return l.failure_strain.size() == as_many(l); });
    s.rule("critical_strain", "expected as many values as failure_strain has", [](const Law& l) {
      return l.critical_strain.empty() || l.critical_strain.size() == l.failure_strain.size();
    });
    s.rule(
        "critical_strain", "critical_strain acts with `softening: stress` and without critical_damage only",
        [](const Law& l) { return l.critical_strain.empty() || (l.softening == "stress" && l.critical_damage < 0.0); });
    s.rule("critical_strain", "the instability is found at each point; expected no nonlocal_radius beside it",
           [](const Law& l) { return l.critical_strain.empty() || !(l.nonlocal_radius > 0.0); });
    s.rule("triaxialities", "triaxialities must ascend strictly", [](const Law& l) {
      for (std::size_t i = 1; i < l.triaxialities.size(); ++i)
        if (!(l.triaxialities[i - 1] < l.triaxialities[i])) return false;
      return true;
    });
    describe_damage(s, "damage", "-", "(ep/ef)^n where the triaxiality stays", "damage");
    s.state(&State::instability, "instability", "-", 0.0, "(ep/critical strain)^n where the triaxiality stays, up to 1")
        .within(fraction);
    s.state(&State::damage_at_instability, "damage_at_instability", "-", 1.0, "damage at which the instability was 1");
  }

  double amount_at_failure() const { return 1.0; }
  double softening_begins(const State& state) const {
    if (critical_strain.empty()) return max_of(critical_damage, 0.0);
    return select(state.instability >= 1.0, state.damage_at_instability, 1.0);
  }
  [[gnu::always_inline]] double pace(const Point& in, const Reads&, double) const {
    return 1.0 / at(failure_strain, triaxiality(in));
  }
  /// `way` is the plastic strain of the step over the failure strain.
  double growth(const Point& in, double way, State& state) const {
    const double before = root(state.amount);
    if (!critical_strain.empty()) {
      const double eta = triaxiality(in), unstable = root(state.instability);
      const double closer = way * at(failure_strain, eta) / at(critical_strain, eta);
      const bool arrives = unstable < 1.0 && unstable + closer >= 1.0;
      // The damage at the moment of the step at which the instability is 1.
      const double share = clamp_to((1.0 - unstable) / (closer + tiny<double>), 0.0, 1.0);
      state.damage_at_instability =
          select(arrives, min_of(power(before + share * way), 1.0), state.damage_at_instability);
      state.instability = select(unstable + closer >= 1.0, 1.0, power(unstable + closer));
    }
    return max_of(power(before + way) - state.amount, 0.0);
  }

 private:
  static double raised(double x, double exponent) {
    const bool any = x > 1e-300;  // the damage of a first step may be as little
    return select(any, positive_power(select(any, x, 1.0), exponent), 0.0);
  }
  double power(double x) const { return damage_exponent == 1.0 ? x : raised(x, damage_exponent); }
  double root(double x) const { return damage_exponent == 1.0 ? x : raised(x, 1.0 / damage_exponent); }
  double at(const std::vector<double>& strains, double eta) const {
    double strain = strains.front();
    for (std::size_t i = 1; i < triaxialities.size(); ++i)
      strain += clamp_to((eta - triaxialities[i - 1]) / (triaxialities[i] - triaxialities[i - 1]), 0.0, 1.0) *
                (strains[i] - strains[i - 1]);
    return strain;
  }
};

}  // namespace

KERF_EROSION(DuctileDamage, "ductile_damage",
             "damage over a failure strain at triaxialities, with instability and softening if wanted")
