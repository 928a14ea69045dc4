// Files about equations of state: points, isentropes, Hugoniots, and cycles of those that keep a history.
#include <cmath>

#include "support/curves.hpp"

namespace kerf::test {

namespace {

/// Kerf's law for a file, with its parameters.
struct Equation {
  std::string law, parameters;
  double density = 0.0;  // [kg/m3]
};

std::string list(const nlohmann::json& values, double factor) {
  std::string text;
  for (const auto& v : values) {
    char number[40];
    std::snprintf(number, sizeof number, "%.17g", factor * v.get<double>() + 0.0);
    text += (text.empty() ? "[" : ", ") + std::string(number);
  }
  return text + "]";
}

Equation compaction(const Oracle& o) {
  const nlohmann::json& p = o.parameters;
  // The files count ln V negative in compression.
  return {"tabulated_compaction",
          "{compactions: " + list(p.at("ev"), -1.0) + ", pressures: " + list(p.at("C"), 1.0) +
              ", unloading_moduli: " + list(p.at("Ku"), 1.0) + ", thermal_factors: " + list(p.at("T"), 1.0) + ", " +
              o.text({{"gamma", "gamma"}}) + "}",
          o.parameter("rho0")};
}

Equation equation_of(const Oracle& o) {
  const auto starts = [&](const char* text) { return o.name.starts_with(text); };
  if (starts("eos_gruneisen_"))
    return {"mie_gruneisen",
            "{" +
                o.text({{"c0", "c0"},
                        {"s", "S1"},
                        {"s2", "S2"},
                        {"s3", "S3"},
                        {"gamma0", "gamma0"},
                        {"gamma_slope", "a"},
                        {"initial_energy", "E0"}}) +
                "}",
            o.parameter("rho0")};
  if (starts("eos_polynomial_"))
    return {"linear_polynomial",
            "{" +
                o.text({{"C0", "C0"},
                        {"C1", "C1"},
                        {"C2", "C2"},
                        {"C3", "C3"},
                        {"C4", "C4"},
                        {"C5", "C5"},
                        {"C6", "C6"},
                        {"initial_energy", "E0"}}) +
                "}",
            o.parameter("rho0")};
  if (starts("eos_ideal_"))
    return {"ideal_gas",
            "{" + o.text({{"gamma", "gamma"}}) + ", " +
                key_and_number("initial_energy", o.parameter("rho0") * o.parameter("e0")) + "}",
            o.parameter("rho0")};
  if (starts("eos_stiffened_")) {
    const double gamma = o.parameter("gamma"), stiffness = o.parameter("pinf");
    const double pressure = (gamma - 1.0) * o.parameter("rho0") * o.parameter("e0") - gamma * stiffness;
    return {"stiffened_gas",
            "{" + o.text({{"gamma", "gamma"}, {"stiffness", "pinf"}}) + ", " +
                key_and_number("initial_pressure", pressure) + "}",
            o.parameter("rho0")};
  }
  if (starts("eos_tillotson_"))
    return {"tillotson",
            "{" +
                o.text({{"a", "a"},
                        {"b", "b"},
                        {"A", "A"},
                        {"B", "B"},
                        {"E0", "E0"},
                        {"alpha", "alpha"},
                        {"beta", "beta"},
                        {"incipient_vaporisation_energy", "Eiv"},
                        {"complete_vaporisation_energy", "Ecv"}}) +
                "}",
            o.parameter("rho0")};
  if (starts("eos_murnaghan_") || starts("eos_birch_murnaghan_"))
    return {starts("eos_murnaghan_") ? "murnaghan" : "birch_murnaghan",
            "{" + o.text({{"bulk_modulus", "K0"}, {"pressure_derivative", "K0_prime"}}) + "}", o.parameter("rho0")};
  if (starts("eos_palpha_"))
    return {"p_alpha",
            "{" +
                o.text({{"solid_density", "rho_s"},
                        {"c0", "c0"},
                        {"s", "s"},
                        {"gamma0", "gamma0"},
                        {"elastic_pressure", "pe"},
                        {"solid_pressure", "ps"},
                        {"exponent", "n"}}) +
                "}",
            o.parameter("rho_s") / o.parameter("alpha0")};
  if (starts("eos_tabulated_compaction_")) return compaction(o);
  if (starts("eos_jwl_"))
    return {
        "jwl",
        "{" +
            o.text({{"A", "A"}, {"B", "B"}, {"R1", "R1"}, {"R2", "R2"}, {"omega", "omega"}, {"initial_energy", "E0"}}) +
            "}",
        o.parameter("rho0")};
  return {};
}

/// The second pressure of the files about Tillotson's equation: without the quadratic term in cold expansion.
std::vector<CurveResult> without_quadratic_term(Oracle o, Equation e) {
  o.columns.at("pressure_Pa") = o.column("pressure_without_B_Pa");
  o.columns.at("bulk_modulus_Pa") = o.column("bulk_modulus_without_B_Pa");
  e.parameters.insert(1, "quadratic_in_expansion: false, ");
  std::vector<CurveResult> results = eos_point_results(o, e.law, e.parameters, e.density, 1e-9, 1e-8);
  for (CurveResult& r : results) r.column += " without B";
  return results;
}

std::vector<CurveResult> check(const Oracle& o) {
  const Equation e = equation_of(o);
  if (o.name.ends_with("_cycles")) {
    std::map<std::string, std::string> names;
    if (o.has("alpha")) names["alpha"] = "distension";
    if (o.has("largest_compaction")) names["largest_compaction"] = "greatest_compaction";
    return eos_path_results(
        o, e.law, e.parameters, e.density, 4000, names,
        {{"pressure_Pa", 1e-4}, {"specific_energy_J_kg", 1e-4}, {"alpha", 1e-5}, {"largest_compaction", 1e-5}});
  }
  std::vector<CurveResult> results;
  // Products of explosives do not pull: where the formula would, the file's pressure is not theirs.
  const bool pulls = e.law == "jwl" && o.name.ends_with("_points");
  if (!pulls) results = eos_point_results(o, e.law, e.parameters, e.density, 1e-9, 1e-8);
  if (o.has("pressure_without_B_Pa"))
    for (const CurveResult& r : without_quadratic_term(o, e)) results.push_back(r);
  if (o.name.ends_with("isentrope") && e.law != "jwl")
    for (const CurveResult& r : eos_path_results(o, e.law, e.parameters, e.density, 1000, {},
                                                 {{"pressure_Pa", 1e-6}, {"specific_energy_J_kg", 1e-5}}))
      results.push_back(r);
  return results;
}

bool fits(const Oracle& o) { return !equation_of(o).law.empty(); }

const RegisterCurves registered({"equation of state", fits, check});

}  // namespace

}  // namespace kerf::test
