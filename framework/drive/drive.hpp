// Takes every material along every path of a drive file, compares with references, and writes curves.
#pragma once

#include <functional>
#include <string>
#include <vector>

#include "drive/driven_cell.hpp"

namespace kerf {

/// The error of one column against a reference.
struct DriveCheck {
  std::string column, file;
  double error = 0.0, tolerance = 0.0;  // over the column's greatest value
  std::size_t row = 0;  // of the greatest error, from 0
  bool passes() const { return error <= tolerance; }  // not where it is no number
};

/// One material along one path.
struct DrivenCurve {
  std::string material, path;
  std::vector<DrivenColumn> columns;
  std::vector<std::vector<double>> rows;
  std::vector<DriveCheck> checks;
  std::int64_t steps = 0;
  double failed_at = -1.0;  // [s]; negative where the element lives
};

/// Takes all materials along all paths. `folder` is where the files of references and histories are looked for.
/// `refine` multiplies the number of steps. Throws InputError where a file or an initial state is wrong, and
/// PhysicsError, naming material, path and time, where a law cannot go on.
std::vector<DrivenCurve> drive(const DriveInput& input, const std::string& folder, double refine = 1.0);

/// A row per check: material, path, column, error, tolerance, and whether it passes.
std::string check_table(const std::vector<DrivenCurve>& curves);

/// Writes MATERIAL.PATH.csv for every curve, and drive.json, which `framework/post/drive.py` draws. `folder` ends in /
/// and is made where it is not there. Throws std::runtime_error where a file cannot be written.
void write_curves(const DriveInput& input, const std::string& input_folder, const std::vector<DrivenCurve>& curves,
                  const std::string& folder);

}  // namespace kerf
