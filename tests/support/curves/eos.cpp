// Files about equations of state: points, isentropes, Hugoniots and cycles of compaction.
#include <algorithm>
#include <cmath>

#include "support/curves.hpp"
#include "support/eos_point.hpp"

namespace kerf::test {

namespace {

/// A law as a file describes it.
struct Subject {
  std::string law, parameters;
  double density = 0.0;  // at the start
};

/// Greatest error of a column, over the value or over a thousandth of the column's greatest value, whichever is more:
/// below that, terms have cancelled.
class Worst {
 public:
  Worst(std::string column, double tolerance, const std::vector<double>& wanted)
      : result_{std::move(column), 0.0, tolerance, 0} {
    for (const double v : wanted) greatest_ = std::max(greatest_, std::fabs(v));
  }
  void note(double value, double wanted, std::size_t row) {
    const double error = std::fabs(value - wanted) / std::max(std::fabs(wanted), 1e-3 * greatest_ + 1e-300);
    if (error <= result_.error) return;  // what is no number is noted
    result_.error = error;
    result_.row = row;
  }
  const CurveResult& result() const { return result_; }

 private:
  CurveResult result_;
  double greatest_ = 0.0;
};

/// Pressure and modulus at each density and energy. A modulus that the formula makes negative is 0 in Kerf; where a law
/// holds the pressure at `least`, its modulus is not that of the formula.
std::vector<CurveResult> points(const Oracle& o, const Subject& s, double p_tolerance, double k_tolerance,
                                const std::string& variant = "", double least = -1e300) {
  const std::vector<double>&pressure = o.column("pressure" + variant + "_Pa"),
        &modulus = o.column("bulk_modulus" + variant + "_Pa");
  EosPoint point(s.law, s.parameters, s.density);
  Worst p("pressure" + variant + "_Pa", p_tolerance, pressure),
      k("bulk_modulus" + variant + "_Pa", k_tolerance, modulus);
  for (std::size_t row = 0; row < o.n_rows(); ++row) {
    const EosOutput out = point.evaluate(o.column("density_kg_m3")[row], o.column("specific_energy_J_kg")[row], false);
    p.note(out.pressure, std::max(pressure[row], least), row);
    if (pressure[row] >= least) k.note(out.bulk_modulus, std::max(modulus[row], 0.0), row);
  }
  return {p.result(), k.result()};
}

/// Jump of momentum and of energy from the state at the start, with Kerf's pressure.
std::vector<CurveResult> jumps(const Oracle& o, const Subject& s) {
  EosPoint point(s.law, s.parameters, s.density);
  const double at_start = point.evaluate(s.density, 0.0, false).pressure;
  const std::vector<double>&us = o.column("shock_velocity_m_s"), &up = o.column("particle_velocity_m_s"),
        &density = o.column("density_kg_m3"), &energy = o.column("specific_energy_J_kg");
  // Twice round-off of a point: the columns of the file have it, too.
  Worst momentum("jump of momentum", 2e-12, o.column("pressure_Pa")), heat("jump of energy", 2e-12, energy);
  for (std::size_t row = 0; row < o.n_rows(); ++row) {
    const double p = point.evaluate(density[row], energy[row], false).pressure;
    momentum.note(p, at_start + s.density * us[row] * up[row], row);
    heat.note(0.5 * (p + at_start) * (1.0 / s.density - 1.0 / density[row]), energy[row], row);
  }
  return {momentum.result(), heat.result()};
}

/// By the last word of the file's name.
std::vector<CurveResult> check(const Oracle& o, const Subject& s, double least = -1e300) {
  std::vector<CurveResult> results;
  const auto add = [&](const std::vector<CurveResult>& more) {
    results.insert(results.end(), more.begin(), more.end());
  };
  if (o.name.ends_with("_points")) {
    add(points(o, s, 1e-12, 1e-8, "", least));
  } else if (o.name.ends_with("_hugoniot")) {
    add(points(o, s, 1e-12, 1e-8));
    add(jumps(o, s));
  } else {
    // The energies of the file are good to 1e-10 and better.
    add(points(o, s, 1e-9, 1e-8));
    // A hexahedron in 1000 steps, to second order in the step; in more where it widens more than tenfold.
    const std::vector<double>& density = o.column("density_kg_m3");
    const int steps = density.front() > 10.0 * density.back() ? 2000 : 1000;
    add(eos_path_results(o, s.law, s.parameters, s.density, steps, {},
                         {{"pressure_Pa", 1e-6}, {"specific_energy_J_kg", 1e-5}}));
  }
  return results;
}

std::string braced(const Oracle& o, const std::vector<std::pair<std::string, std::string>>& names) {
  return "{" + o.text(names) + "}";
}
std::string gas(const Oracle& o, const std::string& others) {
  return "{" + others + ", " + key_and_number("initial_energy", o.parameter("rho0") * o.parameter("e0")) + "}";
}

std::vector<CurveResult> check_gruneisen(const Oracle& o) {
  return check(o, {"mie_gruneisen",
                   braced(o, {{"c0", "c0"},
                              {"s", "S1"},
                              {"s2", "S2"},
                              {"s3", "S3"},
                              {"gamma0", "gamma0"},
                              {"gamma_slope", "a"},
                              {"initial_energy", "E0"}}),
                   o.parameter("rho0")});
}

std::vector<CurveResult> check_polynomial(const Oracle& o) {
  return check(o, {"linear_polynomial",
                   braced(o, {{"C0", "C0"},
                              {"C1", "C1"},
                              {"C2", "C2"},
                              {"C3", "C3"},
                              {"C4", "C4"},
                              {"C5", "C5"},
                              {"C6", "C6"},
                              {"initial_energy", "E0"}}),
                   o.parameter("rho0")});
}

std::vector<CurveResult> check_ideal(const Oracle& o) {
  return check(o, {"ideal_gas", gas(o, o.text({{"gamma", "gamma"}})), o.parameter("rho0")});
}

std::vector<CurveResult> check_stiffened(const Oracle& o) {
  return check(o, {"stiffened_gas", gas(o, o.text({{"gamma", "gamma"}, {"stiffness", "pinf"}})), o.parameter("rho0")});
}

std::vector<CurveResult> check_tillotson(const Oracle& o) {
  const std::string text = o.text({{"a", "a"},
                                   {"b", "b"},
                                   {"A", "A"},
                                   {"B", "B"},
                                   {"E0", "E0"},
                                   {"alpha", "alpha"},
                                   {"beta", "beta"},
                                   {"incipient_vaporisation_energy", "Eiv"},
                                   {"complete_vaporisation_energy", "Ecv"}});
  std::vector<CurveResult> results = check(o, {"tillotson", "{" + text + "}", o.parameter("rho0")});
  const Subject without{"tillotson", "{" + text + ", quadratic_in_expansion: false}", o.parameter("rho0")};
  if (o.has("pressure_without_B_Pa"))
    for (const CurveResult& r : points(o, without, 1e-12, 1e-8, "_without_B")) results.push_back(r);
  return results;
}

std::vector<CurveResult> check_solid(const Oracle& o, const std::string& law) {
  return check(o, {law, braced(o, {{"bulk_modulus", "K0"}, {"pressure_derivative", "K0_prime"}}), o.parameter("rho0")});
}

std::vector<CurveResult> check_compaction(const Oracle& o) {
  std::vector<double> x = o.parameters.at("ev").get<std::vector<double>>();
  for (double& v : x) v = std::fabs(v);
  std::string text = "compactions: " + nlohmann::json(x).dump() + ", pressures: " + o.parameters.at("C").dump() +
                     ", unloading_moduli: " + o.parameters.at("Ku").dump();
  if (o.parameters.contains("T")) text += ", thermal_factors: " + o.parameters.at("T").dump();
  return eos_path_results(o, "tabulated_compaction", "{" + text + ", " + o.text({{"gamma", "gamma"}}) + "}",
                          o.parameter("rho0"), 1000, {{"largest_compaction", "greatest_compaction"}},
                          {{"pressure_Pa", 1e-4}, {"specific_energy_J_kg", 1e-4}, {"largest_compaction", 1e-9}});
}

std::vector<CurveResult> check_palpha(const Oracle& o) {
  const std::string text = braced(o, {{"solid_density", "rho_s"},
                                      {"c0", "c0"},
                                      {"s", "s"},
                                      {"gamma0", "gamma0"},
                                      {"elastic_pressure", "pe"},
                                      {"solid_pressure", "ps"},
                                      {"exponent", "n"}});
  return eos_path_results(o, "p_alpha", text, o.column("density_kg_m3").front(), 1000, {{"alpha", "distension"}},
                          {{"pressure_Pa", 1e-4}, {"specific_energy_J_kg", 1e-4}, {"alpha", 1e-5}});
}

std::vector<CurveResult> check_jwl(const Oracle& o) {
  const std::string text =
      braced(o, {{"A", "A"}, {"B", "B"}, {"R1", "R1"}, {"R2", "R2"}, {"omega", "omega"}, {"initial_energy", "E0"}});
  return check(o, {"jwl", text, o.parameter("rho0")}, 0.0);  // products do not pull
}

struct Registered {
  Registered(const std::string& law, const std::string& prefix,
             const std::function<std::vector<CurveResult>(const Oracle&)>& checks)
      : made({law, [prefix](const Oracle& o) { return o.name.starts_with(prefix); }, checks}) {}
  RegisterCurves made;
};
const Registered registered[] = {
    {"mie_gruneisen", "eos_gruneisen_", check_gruneisen},
    {"linear_polynomial", "eos_polynomial_", check_polynomial},
    {"ideal_gas", "eos_ideal_", check_ideal},
    {"stiffened_gas", "eos_stiffened_", check_stiffened},
    {"tillotson", "eos_tillotson_", check_tillotson},
    {"murnaghan", "eos_murnaghan_", [](const Oracle& o) { return check_solid(o, "murnaghan"); }},
    {"birch_murnaghan", "eos_birch_murnaghan_", [](const Oracle& o) { return check_solid(o, "birch_murnaghan"); }},
    {"tabulated_compaction", "eos_tabulated_compaction_", check_compaction},
    {"p_alpha", "eos_palpha_", check_palpha},
    {"jwl", "eos_jwl_", check_jwl},
};

}  // namespace

}  // namespace kerf::test
