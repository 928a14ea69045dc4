// Checks against the curves of an independent program that are no path of one element with one law: points and paths of
// equations of state, sums of criteria, detonation. Paths of laws are the drive files of tests/curves.
#pragma once

#include <functional>
#include <map>
#include <string>
#include <vector>

#include "support/oracle.hpp"

namespace kerf::test {

/// The error of one column of a file, over the column's greatest value where the family does not say otherwise.
struct CurveResult {
  std::string column;
  double error = 0.0, tolerance = 0.0;
  std::size_t row = 0;  // of the greatest error
  bool passes() const { return error <= tolerance; }  // not where it is no number
};

/// All files about one law.
struct CurveFamily {
  std::string law;
  std::function<bool(const Oracle&)> fits;
  std::function<std::vector<CurveResult>(const Oracle&)> check;
};

/// A static object of this type makes a family known.
struct RegisterCurves {
  explicit RegisterCurves(CurveFamily family);
};

/// While it lives, paths are run in `factor` times as many steps.
class FinerSteps {
 public:
  explicit FinerSteps(double factor);
  ~FinerSteps();
  FinerSteps(const FinerSteps&) = delete;
  FinerSteps& operator=(const FinerSteps&) = delete;
};

/// The family of a file; null where there is none.
const CurveFamily* family_of(const Oracle& oracle);

/// Parameters of an equation of state that a file of strength laws names in its parameters: {"type": "gruneisen", ...}
/// as what PartLaws take. Empty type where the law brings its own pressure.
void set_eos(const Oracle& oracle, PartLaws& laws);

/// Pressure and modulus of an equation of state at the densities and energies of a file, from the state at the start:
/// errors over the value itself, or over `floor` times the column's greatest value where that is more.
std::vector<CurveResult> eos_point_results(const Oracle& oracle, const std::string& eos, const std::string& parameters,
                                           double reference_density, double pressure_tolerance,
                                           double modulus_tolerance, double floor = 1e-3);

/// One hexahedron of a fluid, compressed and expanded through the densities of a file in at least `steps` steps, from
/// its first row on: errors of pressure, energy and of the state variables in `names`, over the column's greatest
/// value.
std::vector<CurveResult> eos_path_results(const Oracle& oracle, const std::string& eos, const std::string& parameters,
                                          double reference_density, int steps,
                                          const std::map<std::string, std::string>& names,
                                          const std::map<std::string, double>& tolerances);

/// How results are printed.
enum class PrintedAs { worst_column, all_columns, markdown };

/// Prints law, file, column, error, tolerance, row and whether it passes: of the column that comes nearest to its
/// tolerance and of those that fail, or of all; as markdown, one row of a table for the file. Returns whether all pass.
/// A file without a family does not pass.
bool print_results(const std::string& file, PrintedAs form);

}  // namespace kerf::test
