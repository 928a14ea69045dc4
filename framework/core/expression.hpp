// Reads formulas of the input.
#pragma once

#include <functional>
#include <string>
#include <string_view>
#include <vector>

#include "kerf/expression.hpp"

namespace kerf {

/// A formula, or the sentence that says why there is none, and how many characters of the text stand before the place.
struct ReadExpression {
  Expression expression;
  std::string error;
  int offset = 0;

  bool ok() const { return error.empty(); }
};

/// The text of the parameter of the input with this name (without `$`), or null where there is none.
using ParameterText = std::function<const std::string*(const std::string& name)>;

/// Reads `text`. `variables` are the names that it may use; where the list is empty, it may use any name. `parameter`
/// tells what `$name` stands for; without it, there are no parameters.
ReadExpression read_expression(std::string_view text, const std::vector<std::string>& variables,
                               const ParameterText& parameter = {});

}  // namespace kerf
