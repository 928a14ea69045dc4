// Reads the curves of tests/data/laws, and drives one hexahedron along the path of a curve.
#pragma once

#include <map>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "support/one_part.hpp"

namespace kerf::test {

/// A file of tests/data/laws.
struct Oracle {
  explicit Oracle(const std::string& name);
  const std::vector<double>& column(const std::string& name) const { return columns.at(name); }
  bool has(const std::string& name) const { return columns.contains(name); }
  std::size_t n_rows() const { return columns.begin()->second.size(); }
  double parameter(const std::string& name) const { return parameters.at(name).get<double>(); }
  /// "key: number" for a law's parameters, one after the other, by Kerf's and the file's names.
  std::string text(const std::vector<std::pair<std::string, std::string>>& names) const;

  nlohmann::json parameters, path;
  std::map<std::string, std::vector<double>> columns;
};

/// Greatest and root mean square error of one quantity, over the column's greatest value.
struct CurveError {
  double most = 0.0, rms = 0.0;
  std::size_t row = 0;  // of the greatest
};

/// Errors by column: those of stress, energy, volume and state variables that the law keeps. `names` says which state
/// variable a column shows; `steps` are those between two rows. Rows in `skipped` do not count.
std::map<std::string, CurveError> follow(const Oracle& oracle, const PartLaws& laws, int steps,
                                         const std::map<std::string, std::string>& names,
                                         const std::vector<std::size_t>& skipped = {});

}  // namespace kerf::test
