// Polynomial equation of state, linear in the energy: gases, liquids, fitted solids.
//
// Source: J.O. Hallquist, LS-DYNA Theory Manual (2006), section 22.1 (equation of state form 1).
#include <kerf/eos.hpp>
#include <kerf/law_use.hpp>
#include <kerf/tension_limit.hpp>

#include <cmath>
#include <cstdio>
#include <string>
#include <vector>

namespace {

using namespace kerf;

/// p = C0 + C1 mu + C2 mu^2 + C3 mu^3 + (C4 + C5 mu + C6 mu^2) E, with mu = rho/rho0 - 1 and the energy E per
/// reference volume; C2 and C6 act in compression only.
struct LinearPolynomial final : PointwiseEos<LinearPolynomial>, TensionLimit, WarningLaw {
  double C0 = 0.0, C1 = 0.0, C2 = 0.0, C3 = 0.0;  // [Pa]
  double C4 = 0.0, C5 = 0.0, C6 = 0.0;  // [-]
  double initial_energy = 0.0;  // [J/m3]
  using State = NoVariables;

  static void describe(Schema<LinearPolynomial>& s) {
    s.real(&LinearPolynomial::C0, "C0", "Pa", any_value, "constant coefficient").by_default("0");
    s.real(&LinearPolynomial::C1, "C1", "Pa", non_negative, "coefficient of mu").by_default("0");
    s.real(&LinearPolynomial::C2, "C2", "Pa", any_value, "coefficient of mu squared, in compression only")
        .by_default("0");
    s.real(&LinearPolynomial::C3, "C3", "Pa", any_value, "coefficient of mu cubed").by_default("0");
    s.real(&LinearPolynomial::C4, "C4", "-", any_value, "coefficient of the energy").by_default("0");
    s.real(&LinearPolynomial::C5, "C5", "-", any_value, "coefficient of mu times the energy").by_default("0");
    s.real(&LinearPolynomial::C6, "C6", "-", any_value,
           "coefficient of mu squared times the energy, in compression only")
        .by_default("0");
    s.real(&LinearPolynomial::initial_energy, "initial_energy", "J/m3", any_value,
           "internal energy per reference volume at the start")
        .by_default("0");
    describe_tension_limit(s);
    s.rule("C1", "C1 or C4 must be positive, else the material does not resist compression",
           [](const LinearPolynomial& p) { return p.C1 > 0.0 || p.C4 > 0.0; });
  }
  double initial_energy_density() const override { return initial_energy; }
  bool uses_energy() const override { return C4 != 0.0 || C5 != 0.0 || C6 != 0.0; }

  /// C0 is a pressure of the undeformed material, which nothing stands against when a run starts. It stores no energy:
  /// what the first step sets in motion by it may be more than all energy of the model.
  std::vector<std::string> warnings(LawUse& use) const override {
    constexpr double much = 0.01;  // the strain that lets the pressure go; metals yield below it
    const double pressure = C0 + C4 * initial_energy, modulus = C1 + C5 * initial_energy + C4 * pressure;
    if (C0 == 0.0 || std::fabs(pressure) <= much * modulus) return {};
    char line[256];
    std::snprintf(
        line, sizeof line,
        "C0 gives part %s a pressure of %.3g Pa at the start, %.2g of its bulk modulus, by which it bursts or "
        "collapses; leave C0 out, or let C4 initial_energy balance it",
        use.part.c_str(), pressure, std::fabs(pressure) / modulus);
    return {line};
  }

  EosOutput evaluate_point(const EosInput& in, const State&) const {
    const double ratio = in.density / in.reference_density, mu = ratio - 1.0;
    const double E = in.reference_density * in.specific_energy + initial_energy;
    const double c2 = select(mu > 0.0, C2, 0.0), c6 = select(mu > 0.0, C6, 0.0);
    const double gamma = C4 + (C5 + c6 * mu) * mu;  // dp/dE
    const double p = C0 + (C1 + (c2 + C3 * mu) * mu) * mu + gamma * E;
    const double slope = C1 + (2.0 * c2 + 3.0 * C3 * mu) * mu + (C5 + 2.0 * c6 * mu) * E;  // dp/dmu
    return {limited(p), max_of(0.0, ratio * slope + gamma * limited(p) / ratio)};
  }
};

}  // namespace

KERF_EOS(LinearPolynomial, "linear_polynomial", "polynomial in the density, linear in the energy; ideal gases too")
