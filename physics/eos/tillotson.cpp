// Tillotson equation of state: metals and rocks from cold compression to vapour, for hypervelocity impact.
//
// Sources: J.H. Tillotson, "Metallic equations of state for hypervelocity impact", General Atomic GA-3216 (1962); H.J.
// Melosh, Impact Cratering (1989), appendix II; W. Benz & E. Asphaug, "Catastrophic disruptions revisited", Icarus 142
// (1999) 5-20, for the blend between the branches.
#include <kerf/eos.hpp>
#include <kerf/tension_limit.hpp>

namespace {

using namespace kerf;

/// With mu = rho/rho0 - 1, w = e/(E0 (rho/rho0)^2) + 1 and z = rho0/rho - 1:
/// condensed  p = (a + b/w) rho e + A mu + B mu^2, where compressed, or expanded with e <= e_iv;
/// expanded   p = a rho e + [b rho e/w + A mu exp(-beta z)] exp(-alpha z^2), where e >= e_cv;
/// between the two energies the pressure is their mean, weighted linearly in e.
struct Tillotson final : PointwiseEos<Tillotson>, TensionLimit {
  double a = 0.0, b = 0.0, A = 0.0, B = 0.0, E0 = 0.0;  // [-], [-], [Pa], [Pa], [J/kg]
  double alpha = 0.0, beta = 0.0, incipient = 0.0, complete = 0.0;  // [-], [-], [J/kg], [J/kg]
  bool quadratic = true;
  using State = NoVariables;

  static void describe(Schema<Tillotson>& s) {
    using T = Tillotson;
    s.real(&T::a, "a", "-", positive, "Grueneisen parameter of the hot gas");
    s.real(&T::b, "b", "-", non_negative, "with a, the Grueneisen parameter at no energy");
    s.real(&T::A, "A", "Pa", positive, "bulk modulus");
    s.real(&T::B, "B", "Pa", any_value, "coefficient of mu squared");
    s.real(&T::E0, "E0", "J/kg", positive, "energy that fits b; not an initial energy");
    s.real(&T::alpha, "alpha", "-", non_negative, "exponent of the expansion, quadratic");
    s.real(&T::beta, "beta", "-", non_negative, "exponent of the expansion, linear");
    s.real(&T::incipient, "incipient_vaporisation_energy", "J/kg", positive, "energy at which vaporisation begins");
    s.real(&T::complete, "complete_vaporisation_energy", "J/kg", positive, "energy at which all is vapour");
    s.boolean(&T::quadratic, "quadratic_in_expansion",
              "whether cold expanded material has the term B mu^2, too; codes differ")
        .by_default("true");
    describe_tension_limit(s);
    s.rule("complete_vaporisation_energy", "complete_vaporisation_energy must be above incipient_vaporisation_energy",
           [](const T& t) { return t.complete > t.incipient; });
  }

  EosOutput evaluate_point(const EosInput& in, const State&) const {
    const double ratio = in.density / in.reference_density, e = in.specific_energy;
    const Branch cold = condensed(ratio, in.density, e), hot = expanded(ratio, in.density, e);
    const double share = select(ratio < 1.0, clamp_to((e - incipient) / (complete - incipient), 0.0, 1.0), 0.0);
    const bool blends = (share > 0.0) & (share < 1.0);
    const double p = (1.0 - share) * cold.p + share * hot.p;
    const double by_energy = (1.0 - share) * cold.by_energy + share * hot.by_energy +
                             select(blends, (hot.p - cold.p) / (complete - incipient), 0.0);
    const double by_density = (1.0 - share) * cold.by_density + share * hot.by_density;
    return {limited(p), max_of(0.0, by_density + limited(p) / in.density * by_energy)};
  }

 private:
  struct Branch {
    double p, by_density, by_energy;  // [Pa], rho dp/drho [Pa], dp/de [kg/m3]
  };
  /// b/w, and its derivatives by ln rho and, times e, by e. Energies below -0.9 E0 (rho/rho0)^2, which nothing reaches
  /// but by errors, would turn the sign of w: it is held above a tenth.
  struct Cooling {
    double b_over_w, by_density, by_energy;
  };
  Cooling cooling(double ratio, double e) const {
    const double free = e / (E0 * ratio * ratio) + 1.0, w = max_of(free, 0.1), grows = select(free > 0.1, w - 1.0, 0.0);
    return {b / w, 2.0 * b * grows / (w * w), -b * grows / (w * w)};
  }

  Branch condensed(double ratio, double density, double e) const {
    const double mu = ratio - 1.0, heat = density * e, square = select((mu > 0.0) | quadratic, B, 0.0);
    const Cooling c = cooling(ratio, e);
    return {(a + c.b_over_w) * heat + (A + square * mu) * mu,
            (a + c.b_over_w + c.by_density) * heat + ratio * (A + 2.0 * square * mu),
            density * (a + c.b_over_w + c.by_energy)};
  }
  Branch expanded(double ratio, double density, double e) const {
    const double mu = ratio - 1.0, heat = density * e, z = max_of(1.0 / ratio - 1.0, 0.0);
    const Cooling c = cooling(ratio, e);
    const double wide = kerf::exp(-alpha * z * z), falling = A * kerf::exp(-beta * z);
    const double thermal = c.b_over_w * heat, elastic = falling * mu, both = thermal + elastic;
    // Of each factor in turn, with rho dz/drho = -rho0/rho.
    const double by_density = a * heat + wide * (thermal + c.by_density * heat + falling * ratio +
                                                 elastic * beta / ratio + 2.0 * alpha * z / ratio * both);
    return {a * heat + wide * both, by_density, density * (a + wide * (c.b_over_w + c.by_energy))};
  }
};

}  // namespace

KERF_EOS(Tillotson, "tillotson", "metals and rocks from cold compression to vapour")
