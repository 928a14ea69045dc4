// Johnson-Cook damage: failure strain over triaxiality, rate and temperature, with softening where it is wanted.
//
// Sources: G.R. Johnson & W.H. Cook, "Fracture characteristics of three metals subjected to various strains, strain
// rates, temperatures and pressures", Eng. Fract. Mech. 21 (1985) 31-48, eqs. 4 and 5; the exponent of softening as in
// F. Neukamm, M. Feucht & A. Haufe, "Considering damage history in crashworthiness simulations" (2008).
#include <kerf/erosion.hpp>

namespace {

using namespace kerf;

/// D' = ep' / ef with ef = [D1 + D2 exp(D3 eta)] [1 + D4 ln max(ep'/rate0, 1)] [1 + D5 T*], eta the triaxiality,
/// tension positive, and T* = (T - Tr)/(Tm - Tr). The point fails at D = 1. With softening, the stress keeps 1 - ((D -
/// Dc)/(1 - Dc))^m of itself beyond D = Dc.
struct JohnsonCookDamage final : PointwiseErosion<JohnsonCookDamage> {
  double D1 = 0.0, D2 = 0.0, D3 = 0.0, D4 = 0.0, D5 = 0.0;
  double reference_rate = 1.0, reference_temperature = 0.0, melting_temperature = 0.0;  // [1/s], [K], [K]
  double least_failure_strain = 0.0;  // [-]
  std::string softening;
  double critical_damage = 0.0, exponent = 1.0;  // [-]

  struct Reads {
    double effective_plastic_strain, temperature;
  };
  struct State {
    double damage, last_plastic_strain;
  };
  static constexpr bool can_soften = true;
  bool softens() const override { return softening == "stress"; }

  static void describe(Schema<JohnsonCookDamage>& s) {
    s.real(&JohnsonCookDamage::D1, "D1", "-", any_value, "failure strain where the triaxiality has no effect");
    s.real(&JohnsonCookDamage::D2, "D2", "-", any_value, "failure strain that depends on the triaxiality");
    s.real(&JohnsonCookDamage::D3, "D3", "-", any_value,
           "exponent of the triaxiality, tension positive; of most metals negative")
        .usual(Range{-20.0, 0.0, false, false});
    s.real(&JohnsonCookDamage::D4, "D4", "-", any_value, "effect of the plastic strain rate").by_default("0");
    s.real(&JohnsonCookDamage::D5, "D5", "-", any_value, "effect of the temperature").by_default("0");
    s.real(&JohnsonCookDamage::reference_rate, "reference_rate", "1/s", positive,
           "plastic strain rate at or below which it has no effect")
        .by_default("1");
    s.real(&JohnsonCookDamage::reference_temperature, "reference_temperature", "K", positive,
           "temperature at or below which it has no effect")
        .by_default("293.15");
    s.real(&JohnsonCookDamage::melting_temperature, "melting_temperature", "K", positive,
           "melting temperature; needed where D5 is not zero")
        .optional();
    s.real(&JohnsonCookDamage::least_failure_strain, "least_failure_strain", "-", positive,
           "the failure strain is never less")
        .by_default("1e-6");
    s.choice(&JohnsonCookDamage::softening, "softening", {"none", "stress"},
             "whether damage weakens the deviator and tensile pressures before the element fails")
        .by_default("none");
    s.real(&JohnsonCookDamage::critical_damage, "critical_damage", "-", Range{0.0, 1.0, false, true},
           "damage at which softening begins")
        .by_default("0");
    s.real(&JohnsonCookDamage::exponent, "softening_exponent", "-", Range{0.0, 20.0, true, false},
           "exponent of softening over damage")
        .by_default("1");
    describe_interval(s);
    s.rule("D5", "D5 needs the key melting_temperature, above reference_temperature",
           [](const JohnsonCookDamage& d) { return d.D5 == 0.0 || d.melting_temperature > d.reference_temperature; });
    s.state(&State::damage, "damage", "-", 0.0, "accumulated plastic strain over failure strain").within(fraction);
    s.state(&State::last_plastic_strain, "damage_last_plastic_strain", "-", -1.0,
            "equivalent plastic strain that the damage has seen; negative before the first step");
    s.reads(&Reads::effective_plastic_strain, "effective_plastic_strain", "equivalent plastic strain of the material");
    s.reads(&Reads::temperature, "temperature", "temperature of the material, where it keeps one").by_default(0.0);
  }

  Verdict judge_point(const ErosionInputPoint& in, const Reads& reads, State& state) const {
    const SymTensor s = deviator(in.stress);
    const double q = von_mises(s),
                 eta = clamp_to(-in.pressure / (q + tiny<double>), -most_triaxiality, most_triaxiality);
    // What plastic strain there is before the first step has done no damage.
    const bool has_seen = state.last_plastic_strain >= 0.0;
    const double d = select(has_seen, max_of(reads.effective_plastic_strain - state.last_plastic_strain, 0.0), 0.0);
    const double rate = max_of(d / (in.dt * reference_rate + tiny<double>), 1.0);
    const double heat = clamp_to((reads.temperature - reference_temperature) /
                                     (max_of(melting_temperature - reference_temperature, 0.0) + tiny<double>),
                                 0.0, 1.0);
    const double strain = max_of((D1 + D2 * kerf::exp(D3 * eta)) * (1.0 + D4 * positive_log(rate)) * (1.0 + D5 * heat),
                                 least_failure_strain);
    state.damage = min_of(state.damage + d / strain, 1.0);
    state.last_plastic_strain = reads.effective_plastic_strain;
    const double beyond = max_of(state.damage - critical_damage, 0.0) / (1.0 - critical_damage);
    const bool any = beyond > 1e-60;
    const double kept = 1.0 - select(any, positive_power(select(any, beyond, 1.0), exponent), 0.0);
    return {state.damage, select(state.damage >= 1.0, 1.0, 0.0), kept, kept};
  }

 private:
  static constexpr double most_triaxiality = 100.0;  // exp(D3 eta) stays finite
};

}  // namespace

KERF_EROSION(JohnsonCookDamage, "johnson_cook_damage", "Johnson-Cook failure strain, with softening if wanted")
