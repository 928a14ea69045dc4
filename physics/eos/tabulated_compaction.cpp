// Tabulated compaction: porous materials that are crushed for good, with a term of the energy.
//
// Source: R.D. Krieg, "A simple constitutive description for cellular concrete", Sandia National Laboratories
// SC-DR-72-0883 (1972); J.O. Hallquist, LS-DYNA Theory Manual (2006), section 22.8 (equation of state form 8).
#include <kerf/compaction_table.hpp>
#include <kerf/eos.hpp>
#include <kerf/tension_limit.hpp>

namespace {

using namespace kerf;

/// p = C(x) + gamma T(x) E while the compaction x grows beyond all it has been; else C(x_max) - K(x_max) (x_max - x) +
/// gamma T(x) E, with the greatest compaction x_max and the energy E per reference volume. Not below the tension limit.
struct TabulatedCompaction final : Eos, CompactionTable, TensionLimit {
  std::vector<double> factors;  // T, one for each compaction; empty: 1 [-]
  double gamma = 0.0, initial_energy = 0.0;  // [-], [J/m3]

  struct State {
    double greatest_compaction;
  };

  static void describe(Schema<TabulatedCompaction>& s) {
    using T = TabulatedCompaction;
    describe_table(s);
    s.reals(&T::factors, "thermal_factors", "-", non_negative,
            "factor T of the thermal pressure gamma T E at each of `compactions`; 1 where absent")
        .optional();
    s.real(&T::gamma, "gamma", "-", non_negative, "coefficient of the energy per reference volume").by_default("0");
    s.real(&T::initial_energy, "initial_energy", "J/m3", any_value, "internal energy per reference volume at the start")
        .by_default("0");
    describe_tension_limit(s);
    s.rule("thermal_factors", "thermal_factors must be as many values as compactions",
           [](const T& t) { return t.factors.empty() || t.factors.size() == t.compactions.size(); });
    s.state(&State::greatest_compaction, "greatest_compaction", "-", 0.0, "greatest compaction so far")
        .within(non_negative);
  }
  bool uses_energy() const override { return gamma != 0.0; }
  double initial_energy_density() const override { return initial_energy; }

  void evaluate(const EosBatch& b) const override {
    alignas(64) double x[lane_width], greatest[lane_width], p[lane_width], k[lane_width], inside[lane_width],
        factor[lane_width], slope[lane_width], ratio[lane_width], energy[lane_width];
    const double rho0 = b.reference_density;
    for (int l = 0; l < lane_width; ++l) {
      ratio[l] = b.density[l] / rho0;
      energy[l] = rho0 * b.specific_energy[l] + initial_energy;
      greatest[l] = b.state[l];
    }
#pragma omp simd
    for (int l = 0; l < lane_width; ++l) x[l] = compaction_of(1.0 / ratio[l]);
    CompactionTable::evaluate(x, greatest, p, k);
    for (int l = 0; l < lane_width; ++l) {
      inside[l] = clamp_to(x[l], 0.0, compactions.back());
      factor[l] = 1.0;
      slope[l] = 0.0;
    }
    if (!factors.empty()) look_up(factors, inside, factor, slope);
    const bool is_mu = measure.front() == 'm';
#pragma omp simd
    for (int l = 0; l < lane_width; ++l) {
      const double thermal = gamma * factor[l], whole = p[l] + thermal * energy[l];
      // rho dT/drho; T does not change beyond the table's ends.
      const double change = select(x[l] == inside[l], slope[l], 0.0) * select(is_mu, ratio[l], 1.0);
      p[l] = limited(whole);
      k[l] = max_of(0.0, k[l] + gamma * change * energy[l] + thermal * p[l] / ratio[l]);
    }
    for (int l = 0; l < lane_width; ++l) {
      b.pressure[l] = p[l];
      b.bulk_modulus[l] = k[l];
    }
    if (b.new_state)
      for (int l = 0; l < lane_width; ++l) b.new_state[l] = greatest[l];
  }
};

}  // namespace

KERF_EOS(TabulatedCompaction, "tabulated_compaction", "porous material that is crushed for good, by a table")
