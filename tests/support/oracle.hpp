// Reads the curves of tests/data/laws, and drives one hexahedron along the path of a curve.
#pragma once

#include <functional>
#include <map>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "support/one_part.hpp"

namespace kerf::test {

/// A file of curves: what its first lines say, and its columns.
struct Oracle {
  /// `name` is that of a file of tests/data/laws, without ".csv", or the path of a file.
  explicit Oracle(const std::string& name);
  const std::vector<double>& column(const std::string& name) const { return columns.at(name); }
  bool has(const std::string& name) const { return columns.contains(name); }
  std::size_t n_rows() const { return n_rows_; }
  double parameter(const std::string& name) const { return number(parameters.at(name)); }
  /// "key: number" for a law's parameters, one after the other, by Kerf's and the file's names. A parameter that the
  /// file does not have is left out.
  std::string text(const std::vector<std::pair<std::string, std::string>>& names) const;
  /// The name of the law along whose path the file goes, as the file says it; empty for other files.
  std::string law() const { return path.is_object() && parameters.is_object() ? parameters.value("law", "") : ""; }

  std::string name;  // of the file, without folder and ".csv"
  nlohmann::json parameters, path, material, failure;  // JSON of the lines "# parameters:", "# path:" and so on
  std::vector<std::string> comments;  // all lines that begin with #
  std::map<std::string, std::vector<double>> columns;
  std::map<std::string, std::vector<std::string>> words;  // columns that hold text

 private:
  static double number(const nlohmann::json& value);
  void read_comment(const std::string& line);
  std::size_t n_rows_ = 0;
};

/// "key: number" with all digits.
std::string key_and_number(const std::string& key, double value);

/// Moves one hexahedron along the path of a curve: axial strain, shear, equal strains, or a lateral stress that is
/// kept, for which the lateral strain of every step is solved. `after_step` is told the length of the step, `at_row`
/// the row of the file that has been reached.
void drive(const Oracle& oracle, const PartLaws& laws, int steps_per_row,
           const std::function<void(const OnePart&, double)>& after_step,
           const std::function<void(const OnePart&, std::size_t)>& at_row);

/// Greatest and root mean square error of one quantity, over the column's greatest value.
struct CurveError {
  double most = 0.0, rms = 0.0;
  std::size_t row = 0;  // of the greatest
};

/// Errors by column: those of stress, energy, volume and state variables that the law keeps. `names` says which state
/// variable a column shows; `steps` are those between two rows. Rows in `skipped`, and rows that the file marks as near
/// a jump, do not count.
std::map<std::string, CurveError> follow(const Oracle& oracle, const PartLaws& laws, int steps,
                                         const std::map<std::string, std::string>& names,
                                         const std::vector<std::size_t>& skipped = {});

}  // namespace kerf::test
