// Running of curves: paths of deformation and points of equations of state.
#include "support/curves.hpp"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <stdexcept>

#include "support/eos_point.hpp"

namespace kerf::test {

namespace {

/// Greatest error of a quantity along a path.
struct CurveError {
  double most = 0.0;
  std::size_t row = 0;
};

std::vector<CurveFamily>& families() {
  static std::vector<CurveFamily> all;
  return all;
}

double step_factor = 1.0;  // see FinerSteps

/// Steps between two rows, so that the path has at least `steps`.
int per_row(const Oracle& oracle, int steps) {
  const double rows = std::max(static_cast<double>(oracle.n_rows()) - 1.0, 1.0);
  return std::max(static_cast<int>(std::ceil(step_factor * steps / rows - 1e-9)), 1);
}

}  // namespace

RegisterCurves::RegisterCurves(CurveFamily family) { families().push_back(std::move(family)); }

FinerSteps::FinerSteps(double factor) { step_factor = factor; }
FinerSteps::~FinerSteps() { step_factor = 1.0; }

const CurveFamily* family_of(const Oracle& oracle) {
  for (const CurveFamily& f : families())
    if (f.fits(oracle)) return &f;
  return nullptr;
}

void set_eos(const Oracle& oracle, PartLaws& laws) {
  laws.density = oracle.parameter("density");
  const nlohmann::json& eos = oracle.parameters.at("eos");
  if (!eos.is_object()) return;
  const std::string type = eos.at("type");
  const auto value = [&](const char* key, double absent) {
    return eos.contains(key) ? eos[key].get<double>() : absent;
  };
  const auto term = [&](const char* ours, const char* theirs) { return key_and_number(ours, value(theirs, 0.0)); };
  if (type == "linear") {
    laws.eos = "linear";
    laws.eos_parameters = "{" + term("bulk_modulus", "K") + "}";
  } else if (type == "gruneisen") {
    laws.eos = "mie_gruneisen";
    laws.eos_parameters = "{" + term("c0", "c0") + ", " + term("s", "S1") + ", " + term("gamma0", "gamma0") + ", " +
                          term("gamma_slope", "a");
    for (const auto& [ours, theirs] : {std::pair{"s2", "S2"}, {"s3", "S3"}, {"initial_energy", "E0"}})
      if (value(theirs, 0.0) != 0.0) laws.eos_parameters += ", " + term(ours, theirs);
    laws.eos_parameters += "}";
  } else if (type == "stiffened_gas") {
    laws.eos = "stiffened_gas";
    laws.eos_parameters = "{" + term("gamma", "gamma") + ", " + term("stiffness", "pinf") + ", " +
                          term("initial_pressure", "initial_pressure") + "}";
  } else {
    throw std::runtime_error("no equation of state of the files is called " + type);
  }
}

std::vector<CurveResult> eos_point_results(const Oracle& oracle, const std::string& eos, const std::string& parameters,
                                           double reference_density, double pressure_tolerance,
                                           double modulus_tolerance, double floor) {
  EosPoint point(eos, parameters, reference_density);
  CurveResult p{"pressure_Pa", 0.0, pressure_tolerance, 0}, k{"bulk_modulus_Pa", 0.0, modulus_tolerance, 0};
  const auto note = [&](CurveResult& result, double value, std::size_t row) {
    const std::vector<double>& column = oracle.column(result.column);
    double greatest = 0.0;
    for (const double v : column) greatest = std::max(greatest, std::fabs(v));
    const double error = std::fabs(value - column[row]) / std::max(std::fabs(column[row]), floor * greatest + 1e-300);
    if (error <= result.error) return;
    result.error = error;
    result.row = row;
  };
  for (std::size_t row = 0; row < oracle.n_rows(); ++row) {
    const double density = oracle.column("density_kg_m3")[row];
    const EosOutput out = point.evaluate(density, oracle.column("specific_energy_J_kg")[row], false);
    note(p, out.pressure, row);
    if (oracle.has(k.column)) note(k, out.bulk_modulus, row);
  }
  if (oracle.has(k.column)) return {p, k};
  return {p};
}

std::vector<CurveResult> eos_path_results(const Oracle& oracle, const std::string& eos, const std::string& parameters,
                                          double reference_density, int steps,
                                          const std::map<std::string, std::string>& names,
                                          const std::map<std::string, double>& tolerances) {
  const std::vector<double>& density = oracle.column("density_kg_m3");
  PartLaws laws;
  laws.element = "{linear_viscosity: 0, quadratic_viscosity: 0}";
  laws.strength_parameters = "{shear_modulus: 1}";  // the deviator stays zero
  laws.eos = eos;
  laws.eos_parameters = parameters;
  laws.density = reference_density;
  laws.compression = density.front() / reference_density;
  const CellMesh mesh = distorted_block(1, 1, 1, 1e-3, 0.0, 1);
  OnePart part(mesh, laws);
  part.set(PartStore::internal_energy, 0, 0, oracle.column("specific_energy_J_kg").front() * part.element_mass(0));
  part.initialise();
  std::map<std::string, CurveError> errors;
  std::map<std::string, double> greatest;
  const int n = per_row(oracle, steps);
  for (std::size_t row = 1; row < oracle.n_rows(); ++row) {
    for (int i = 1; i <= n; ++i) {
      const double volume =
          density.front() * (1.0 / density[row - 1] + (1.0 / density[row] - 1.0 / density[row - 1]) * i / n);
      std::vector<Vec3> to;
      for (const Vec3 x : mesh.x) to.push_back(x * std::cbrt(volume));
      part.move_to(to, 1e-9);
    }
    const auto note = [&](const std::string& column, double value) {
      const double wanted = oracle.column(column)[row], error = std::fabs(value - wanted);
      greatest[column] = std::max(greatest[column], std::fabs(wanted));
      if (error <= errors[column].most) return;
      errors[column] = {error, row};
    };
    note("pressure_Pa", part.pressure(0));
    note("specific_energy_J_kg", part.get(PartStore::internal_energy, 0) / part.element_mass(0));
    for (const auto& [column, variable] : names) note(column, part.variable(variable, 0));
  }
  std::vector<CurveResult> results;
  for (const auto& [column, error] : errors)
    results.push_back(
        {column, error.most / (greatest[column] > 0.0 ? greatest[column] : 1.0), tolerances.at(column), error.row});
  return results;
}

bool print_results(const std::string& file, PrintedAs form) {
  const Oracle oracle(file);
  const CurveFamily* family = family_of(oracle);
  if (family == nullptr) {
    if (form != PrintedAs::markdown)
      std::printf("%-24s %-44s no law of this file is known\n", "-", oracle.name.c_str());
    return false;
  }
  const std::vector<CurveResult> results = family->check(oracle);
  const auto share = [](const CurveResult& r) {
    return r.tolerance > 0.0 ? r.error / r.tolerance : (r.passes() ? 0.0 : 1e300);
  };
  const auto worst = std::max_element(results.begin(), results.end(),
                                      [&](const CurveResult& a, const CurveResult& b) { return share(a) < share(b); });
  bool all = !results.empty();
  for (auto r = results.begin(); r != results.end(); ++r) {
    all = all && r->passes();
    if (form == PrintedAs::markdown) {
      if (r == worst)
        std::printf("| %s | `%s` | %s | %.1e | %.1e |\n", family->law.c_str(), oracle.name.c_str(), r->column.c_str(),
                    r->error, r->tolerance);
    } else if (form == PrintedAs::all_columns || r == worst || !r->passes()) {
      std::printf("%-24s %-44s %-34s %10.2e %10.2e row %4zu %s\n", family->law.c_str(), oracle.name.c_str(),
                  r->column.c_str(), r->error, r->tolerance, r->row, r->passes() ? "pass" : "FAIL");
    }
  }
  return all;
}

}  // namespace kerf::test
