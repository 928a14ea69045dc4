// Checks the physical dimensions of a formula.
#pragma once

#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "kerf/expression.hpp"

namespace kerf {

/// What is wrong, and how many characters from the beginning of the text.
struct DimensionFault {
  int offset = 0;
  std::string sentence;
};

/// What is wrong with the dimensions of a formula that is to be a condition, true or false. A number without a unit is
/// in SI: it goes with any dimension in a sum or a comparison, and is a pure number in a product. `unit_of` tells the
/// SI unit of a variable; one without a unit goes with any dimension. Pre: the formula is not empty.
std::vector<DimensionFault> faults_of_condition(
    const Expression& formula, const std::function<std::optional<std::string>(const std::string&)>& unit_of);

}  // namespace kerf
