// Reads the curves of tests/data/laws, and drives one hexahedron along the path of a curve.
#pragma once

#include <functional>
#include <map>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "drive/driven_cell.hpp"
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

/// Moves one hexahedron along the path of a curve. `at_row` is told the row of the file that has been reached.
void drive(const Oracle& oracle, const PartLaws& laws, int steps_per_row,
           const std::function<void(const CellPart<double>&, std::size_t)>& at_row);

}  // namespace kerf::test
