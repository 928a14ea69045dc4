// Zerilli-Armstrong strength: flow stress from the thermal activation of dislocations, for bcc and fcc metals.
//
// Source: F.J. Zerilli & R.W. Armstrong, "Dislocation-mechanics-based constitutive relations for material dynamics
// calculations", J. Appl. Phys. 61 (1987) 1816-1825, eqs. 13 and 14.
#include <kerf/radial_return.hpp>

namespace {

using namespace kerf;

/// Y = C0 + (C1 + C2 sqrt(ep)) exp((-C3 + C4 ln ep') T) + C5 ep^n, with the rate in 1/s and the absolute temperature.
/// bcc metals have no C2, fcc metals neither C1 nor C5.
struct ZerilliArmstrong final : RadialReturn<ZerilliArmstrong> {
  double C0 = 0.0, C1 = 0.0, C2 = 0.0, C3 = 0.0, C4 = 0.0, C5 = 0.0, n = 1.0;
  static constexpr double least_rate = 1e-10;  // [1/s]

  static void describe_flow(Schema<ZerilliArmstrong>& s) {
    using Z = ZerilliArmstrong;
    s.real(&Z::C0, "C0", "Pa", non_negative, "athermal stress, of solutes and of the size of grains");
    s.real(&Z::C1, "C1", "Pa", non_negative, "thermal stress without strain (bcc)").by_default("0");
    s.real(&Z::C2, "C2", "Pa", non_negative, "thermal stress over the root of the plastic strain (fcc)")
        .by_default("0");
    s.real(&Z::C3, "C3", "1/K", non_negative, "decrease with the temperature");
    s.real(&Z::C4, "C4", "1/K", non_negative, "increase with the temperature and the logarithm of the rate in 1/s");
    s.real(&Z::C5, "C5", "Pa", non_negative, "strain hardening coefficient (bcc)").by_default("0");
    s.real(&Z::n, "n", "-", Range{0.0, 5.0, true, false}, "strain hardening exponent (bcc)").by_default("1");
    s.rule("C1", "C0, C1 or C2 must be positive, else there is no strength",
           [](const Z& z) { return z.C0 + z.C1 + z.C2 > 0.0; });
  }

  [[gnu::always_inline]] FlowStress flow_stress(const FlowPoint& p) const {
    const bool fast = p.rate > least_rate, strained = p.plastic_strain > 1e-60;
    const double rate = select(fast, p.rate, least_rate), strain = select(strained, p.plastic_strain, 1e-60);
    const double thermal = kerf::exp((-C3 + C4 * positive_log(rate)) * p.temperature);
    const double root = select(strained, std::sqrt(strain), 0.0);
    const double hardening = C5 * select(strained, positive_power(strain, n), 0.0);
    const double share = p.increment / strain;  // d ln ep / d ln d
    const double by_rate = (C1 + C2 * root) * thermal * select(fast, C4 * p.temperature, 0.0);
    return {C0 + (C1 + C2 * root) * thermal + hardening, by_rate + (0.5 * C2 * root * thermal + n * hardening) * share};
  }
};

}  // namespace

KERF_MATERIAL(ZerilliArmstrong, "zerilli_armstrong", "strength by thermal activation of dislocations, bcc and fcc")
