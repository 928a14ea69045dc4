// Damage that weakens the whole stress and speeds itself up: the modified Johnson-Cook model.
//
// Source: T. Borvik, O.S. Hopperstad, T. Berstad & M. Langseth, "A computational model of viscoplasticity and ductile
// damage for impact and penetration", Eur. J. Mech. A 20 (2001) 685-712.
#include <kerf/erosion.hpp>

namespace {

using namespace kerf;

/// With r the plastic strain of the sound stress s~, which the material keeps: s = (1 - D) s~, pressure included; p' =
/// r' / (1 - D); D' = Dc p' / (pf - pd) beyond p = pd; pf = [D1 + D2 exp(D3 eta)] (1 + p'/rate0)^D4 (1 + D5 T*). The
/// point fails at D = Dc.
struct ModifiedJohnsonCookDamage final : PointwiseErosion<ModifiedJohnsonCookDamage> {
  double D1 = 0.0, D2 = 0.0, D3 = 0.0, D4 = 0.0, D5 = 0.0;
  double critical_damage = 0.3, threshold_strain = 0.0, least_failure_strain = 0.0;  // [-]
  double reference_rate = 1.0, reference_temperature = 0.0, melting_temperature = 0.0;  // [1/s], [K], [K]

  struct Reads {
    double effective_plastic_strain, temperature;
  };
  struct State {
    double damage, plastic_strain, last_plastic_strain;
  };
  static constexpr bool can_soften = true;

  static void describe(Schema<ModifiedJohnsonCookDamage>& s) {
    using Law = ModifiedJohnsonCookDamage;
    s.real(&Law::D1, "D1", "-", any_value, "failure strain where the triaxiality has no effect");
    s.real(&Law::D2, "D2", "-", any_value, "failure strain that depends on the triaxiality");
    s.real(&Law::D3, "D3", "-", any_value, "exponent of the triaxiality, tension positive; of most metals negative")
        .usual(Range{-20.0, 0.0, false, false});
    s.real(&Law::D4, "D4", "-", any_value, "exponent of 1 + p'/reference_rate").by_default("0");
    s.real(&Law::D5, "D5", "-", any_value, "effect of the temperature").by_default("0");
    s.real(&Law::critical_damage, "critical_damage", "-", Range{0.0, 1.0, true, true}, "damage at failure, Dc");
    s.real(&Law::threshold_strain, "threshold_strain", "-", non_negative, "plastic strain at which damage begins, pd")
        .by_default("0");
    s.real(&Law::reference_rate, "reference_rate", "1/s", positive, "rate0 of the failure strain");
    s.real(&Law::reference_temperature, "reference_temperature", "K", positive,
           "temperature at or below which it has no effect")
        .by_default("293.15");
    s.real(&Law::melting_temperature, "melting_temperature", "K", positive,
           "melting temperature; needed where D5 is not zero")
        .optional();
    s.real(&Law::least_failure_strain, "least_failure_strain", "-", positive,
           "the failure strain is never less, counted from threshold_strain")
        .by_default("1e-6");
    describe_interval(s);
    s.rule("D5", "D5 needs the key melting_temperature, above reference_temperature",
           [](const Law& d) { return d.D5 == 0.0 || d.melting_temperature > d.reference_temperature; });
    s.state(&State::damage, "damage", "-", 0.0, "share of the area that is lost").within(fraction);
    s.state(&State::plastic_strain, "damaged_plastic_strain", "-", 0.0, "plastic strain of the damaged material, p")
        .within(non_negative);
    s.state(&State::last_plastic_strain, "damage_last_plastic_strain", "-", -1.0,
            "plastic strain of the sound stress that the damage has seen; negative before the first step");
    s.reads(&Reads::effective_plastic_strain, "effective_plastic_strain", "plastic strain of the sound stress, r");
    s.reads(&Reads::temperature, "temperature", "temperature of the material, where it keeps one").by_default(0.0);
  }

  Verdict judge_point(const ErosionInputPoint& in, const Reads& reads, State& state) const {
    const bool has_seen = state.last_plastic_strain >= 0.0;
    const double dr = select(has_seen, max_of(reads.effective_plastic_strain - state.last_plastic_strain, 0.0), 0.0);
    const double sound = max_of(1.0 - state.damage, least_sound);
    const double slope = critical_damage / failure_strain_beyond(in, reads, dr / sound);
    // (i) What of the step is below the threshold, where D stays.
    const double below = clamp_to(threshold_strain - state.plastic_strain, 0.0, dr / sound);
    const double rest = dr - below * sound;
    // (ii) Beyond it, D' = slope r' / (1 - D): (1 - D)^2 falls by 2 slope times the increment of r.
    const double left = std::sqrt(max_of(sound * sound - 2.0 * slope * rest, least_sound * least_sound));
    const double damage = select(rest > 0.0, max_of(1.0 - left, state.damage), state.damage);
    state.plastic_strain += below + (damage - state.damage) / slope;
    state.damage = damage;
    state.last_plastic_strain = reads.effective_plastic_strain;
    const double kept = 1.0 - damage;
    return {damage, select(damage >= critical_damage, 1.0, 0.0), kept, kept, kept};
  }

 private:
  /// pf - pd. Triaxiality is the same of the sound and of the damaged stress.
  double failure_strain_beyond(const ErosionInputPoint& in, const Reads& reads, double dp) const {
    const double q = von_mises(deviator(in.stress));
    const double eta = clamp_to(-in.pressure / (q + tiny<double>), -100.0, 100.0);
    const double rate = dp / (in.dt * reference_rate + tiny<double>);
    const double heat = clamp_to((reads.temperature - reference_temperature) /
                                     (max_of(melting_temperature - reference_temperature, 0.0) + tiny<double>),
                                 0.0, 1.0);
    const double pf = (D1 + D2 * kerf::exp(D3 * eta)) * positive_power(1.0 + rate, D4) * (1.0 + D5 * heat);
    return max_of(pf - threshold_strain, least_failure_strain);
  }

  static constexpr double least_sound = 1e-3;  // a step that breaks the point needs no more
};

}  // namespace

KERF_EROSION(ModifiedJohnsonCookDamage, "modified_johnson_cook_damage",
             "damage that weakens the whole stress, failure strain over triaxiality, rate and temperature")
