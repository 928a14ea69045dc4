// All conformance checks of a set of types, and their table.
#pragma once

#include <string>
#include <utility>
#include <vector>

#include "conformance/samples.hpp"
#include "conformance/verdicts.hpp"

namespace kerf {

struct ConformanceOptions {
  std::vector<std::pair<std::string, std::string>> types;  // kind and name
  std::vector<std::string> checks;  // wanted; all where empty
  std::string library;  // where the types are from; empty for what is built in
};

/// The names of all checks, for --check.
const std::vector<std::string>& conformance_checks();

/// Runs all checks. Runs of whole models take place in a temporary folder. Throws std::runtime_error where that cannot
/// be made.
Verdicts test_types(const Registry& registry, const Samples& samples, const ConformanceOptions& options);

/// The rows as a table, with a line of counts at its end.
std::string table_of(const std::vector<ConformanceRow>& rows);

}  // namespace kerf
