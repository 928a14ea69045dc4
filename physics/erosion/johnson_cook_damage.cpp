// Johnson-Cook damage: failure strain over triaxiality, rate and temperature, with softening where it is wanted.
//
// Source: G.R. Johnson & W.H. Cook, "Fracture characteristics of three metals subjected to various strains, strain
// rates, temperatures and pressures", Eng. Fract. Mech. 21 (1985) 31-48, eqs. 4 and 5.
#include "accumulated_damage.hpp"

namespace {

using namespace kerf;

/// D' = ep' / ef with ef = [D1 + D2 exp(D3 eta)] [1 + D4 ln max(ep'/rate0, 1)] [1 + D5 T*], eta the triaxiality,
/// tension positive, and T* = (T - Tr)/(Tm - Tr). D = 1 is failure, or where softening begins.
struct JohnsonCookDamage final : AccumulatedDamage<JohnsonCookDamage> {
  double D1 = 0.0, D2 = 0.0, D3 = 0.0, D4 = 0.0, D5 = 0.0;
  double reference_rate = 1.0, reference_temperature = 0.0, melting_temperature = 0.0;  // [1/s], [K], [K]
  double least_failure_strain = 0.0;  // [-]

  using State = DamageState;
  struct Reads : DamageReads {
    double temperature;
  };

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
    s.rule("D5", "D5 needs the key melting_temperature, above reference_temperature",
           [](const JohnsonCookDamage& d) { return d.D5 == 0.0 || d.melting_temperature > d.reference_temperature; });
    describe_damage(s, "damage", "-", "accumulated plastic strain over failure strain", "damage");
    s.reads(&Reads::temperature, "temperature", "temperature of the material, where it keeps one").by_default(0.0);
  }

  double amount_at_failure() const { return 1.0; }
  [[gnu::always_inline]] double pace(const Point& in, const Reads& reads, double plastic_rate) const {
    const double rate = max_of(plastic_rate / reference_rate, 1.0);
    const double heat = clamp_to((reads.temperature - reference_temperature) /
                                     (max_of(melting_temperature - reference_temperature, 0.0) + tiny<double>),
                                 0.0, 1.0);
    const double strain =
        max_of((D1 + D2 * kerf::exp(D3 * triaxiality(in))) * (1.0 + D4 * positive_log(rate)) * (1.0 + D5 * heat),
               least_failure_strain);
    return 1.0 / strain;
  }
};

}  // namespace

KERF_EROSION(JohnsonCookDamage, "johnson_cook_damage", "Johnson-Cook failure strain, with softening if wanted")
