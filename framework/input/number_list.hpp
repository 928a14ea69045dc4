// Reads lists of numbers that are written as one text: "0 0 -1646 m/s", "[0, 0, -1646] m/s".
#pragma once

#include <string>
#include <vector>

namespace kerf {

/// SI values, or the sentence that says why there are none.
struct QuantityList {
  std::vector<double> values;
  std::string error;
};

/// The numbers of one text; a unit at its end counts for all of them.
QuantityList list_to_si(const std::string& text, const std::string& si_unit);

/// Numbers that stand apart, each with its own unit or all without.
QuantityList items_to_si(const std::vector<std::string>& items, const std::string& si_unit);

/// Strict whole number: "200", "1e6"; nothing after it, no fraction, no octal.
bool parse_integer(const std::string& text, long long& value);

}  // namespace kerf
