// P-alpha equation of state of porous solids that are crushed.
//
// Sources: W. Herrmann, "Constitutive equation for the dynamic compaction of ductile porous materials", J. Appl. Phys.
// 40 (1969) 2490-2499; M.M. Carroll & A.C. Holt, "Suggested modification of the P-alpha model for porous materials",
// J. Appl. Phys. 43 (1972) 759-761, for the pressure of the solid over the distension.
#include <kerf/eos.hpp>
#include <kerf/tension_limit.hpp>

#include <stdexcept>

namespace {

using namespace kerf;

/// p = p_s(alpha rho, e)/alpha with the solid's Mie-Grueneisen pressure p_s and the distension alpha, which falls with
/// the pressure on crush(p) = 1 + (alpha0 - 1) ((ps - p)/(ps - pe))^n between pe and ps, and never grows.
struct PAlpha final : PointwiseEos<PAlpha>, TensionLimit {
  double solid_density = 0.0, c0 = 0.0, s = 0.0, gamma0 = 0.0;  // [kg/m3], [m/s], [-], [-]
  double elastic_pressure = 0.0, solid_pressure = 0.0, exponent = 2.0;  // [Pa], [Pa], [-]

  struct State {
    double distension;
  };

  static void describe(Schema<PAlpha>& s) {
    s.real(&PAlpha::solid_density, "solid_density", "kg/m3", positive,
           "density of the solid without pores; the material's density is that of the porous body");
    s.real(&PAlpha::c0, "c0", "m/s", positive, "of the solid: shock velocity at vanishing particle velocity");
    s.real(&PAlpha::s, "s", "-", non_negative, "of the solid: slope of shock velocity over particle velocity");
    s.real(&PAlpha::gamma0, "gamma0", "-", non_negative, "of the solid: Grueneisen parameter");
    s.real(&PAlpha::elastic_pressure, "elastic_pressure", "Pa", non_negative, "pressure at which pores begin to close");
    s.real(&PAlpha::solid_pressure, "solid_pressure", "Pa", positive, "pressure at which all pores are closed");
    s.real(&PAlpha::exponent, "exponent", "-", between(1.0, 10.0), "exponent of the crush curve").by_default("2");
    describe_tension_limit(s);
    s.rule("solid_pressure", "solid_pressure must be above elastic_pressure",
           [](const PAlpha& p) { return p.solid_pressure > p.elastic_pressure; });
    s.state(&State::distension, "distension", "-", 1.0, "density of the solid in the pores' walls over the density")
        .within(Range{1.0, 100.0, false, false});
  }

  void initialise_point(const InitialPoint& point, State& state) const {
    if (point.density > solid_density)
      throw std::runtime_error("p_alpha: the density of the material is above solid_density; expected at most that");
    state.distension = solid_density / point.density;
  }

  EosOutput evaluate_point(const EosInput& in, State& state) const {
    const double initial = max_of(solid_density / in.reference_density, 1.0), old = state.distension;
    // The pores stay as they are, unless the pressure would then be above the crush curve.
    const EosOutput kept = porous(in, old);
    const bool crushes = (old > 1.0) & (kept.pressure > crush_pressure(old, initial));
    double alpha = old;
    if (crushes) alpha = crushed(in, old, initial);
    state.distension = alpha;
    // While pores close, a wave of further compression is slower; the modulus of unloading is the safe one.
    const EosOutput out = porous(in, alpha);
    return {limited(out.pressure), out.bulk_modulus};
  }

 private:
  static constexpr double least_room = 0.02;  // as in mie_gruneisen

  /// Pressure on the crush curve at a distension [Pa].
  double crush_pressure(double alpha, double initial) const {
    const double share = min_of(max_of((alpha - 1.0) / max_of(initial - 1.0, tiny<double>), 0.0), 1.0);
    const double power = select(share > 1e-60, positive_power(max_of(share, 1e-60), 1.0 / exponent), 0.0);
    return solid_pressure - (solid_pressure - elastic_pressure) * power;
  }
  /// Between one and the old distension, where the pressure of the porous body is that of the crush curve; one where
  /// it is above the curve's end all the same. The difference of the two grows with the distension. Its zero is found
  /// by false position, with the value at an end that stays halved (the Illinois method), and a bisection every fourth
  /// time, where the curve is steep. What lies between the last two places is straight to round-off.
  double crushed(const EosInput& in, double old, double initial) const {
    const auto excess = [&](double alpha) { return porous(in, alpha).pressure - crush_pressure(alpha, initial); };
    double low = 1.0, high = old, below = excess(low), above = excess(high);
    if (below >= 0.0) return low;
    if (above <= 0.0) return high;
    int last = 0;
    for (int i = 1; i < 200 && high - low > 1e-9; ++i) {
      double alpha = i % 4 == 0 ? 0.5 * (low + high) : (low * above - high * below) / (above - below);
      if (!(alpha > low && alpha < high)) alpha = 0.5 * (low + high);
      const double e = excess(alpha);
      if (e > 0.0) {
        if (last > 0) below *= 0.5;
        high = alpha, above = e, last = 1;
      } else {
        if (last < 0) above *= 0.5;
        low = alpha, below = e, last = -1;
      }
    }
    return (low * above - high * below) / (above - below);
  }
  /// Of the solid at density alpha rho, over alpha.
  EosOutput porous(const EosInput& in, double alpha) const {
    const double ratio = alpha * in.density / solid_density, mu = ratio - 1.0;
    const double stiffness = solid_density * c0 * c0, energy = solid_density * in.specific_energy;
    const double eta = max_of(mu / ratio, 0.0), left = 1.0 - s * eta, room = 1.0 / max_of(left, least_room);
    const double hugoniot = stiffness * eta * room * room;
    const double hugoniot_slope = stiffness * select(left > least_room, 1.0 + s * eta, least_room) * room * room * room;
    const bool tension = mu < 0.0;
    const double p =
        select(tension, stiffness * mu + gamma0 * energy, hugoniot * (1.0 - 0.5 * gamma0 * eta) + gamma0 * energy);
    const double slope = select(tension, ratio * stiffness,
                                (hugoniot_slope * (1.0 - 0.5 * gamma0 * eta) - 0.5 * gamma0 * hugoniot) / ratio);
    // rho dp/drho of p_s(alpha rho, e)/alpha is (rho_s dp_s/drho_s)/alpha; the work is that of the porous pressure,
    // (p/rho) dp/de = p/(alpha rho) rho_s gamma0 /alpha.
    return {p / alpha, max_of(0.0, (slope + gamma0 * p / ratio) / alpha)};
  }
};

}  // namespace

KERF_EOS(PAlpha, "p_alpha", "porous solid that is crushed: Mie-Grueneisen solid with distension (P-alpha)")
