// Words for what a parameter takes.
#include "input/parameter_text.hpp"

#include <cmath>

#include "core/diagnostics.hpp"
#include "core/units.hpp"

namespace kerf {
namespace {

std::string in_unit(const std::string& unit) { return unit == "-" || unit.empty() ? "" : " in " + unit; }

std::string of_variables(const std::vector<std::string>& names) {
  return names.empty() ? "" : " of " + listed(names, " and ");
}

}  // namespace

std::string listed(const std::vector<std::string>& names, const std::string& last) {
  std::string text;
  for (std::size_t i = 0; i < names.size(); ++i) text += (i == 0 ? "" : i + 1 == names.size() ? last : ", ") + names[i];
  return text;
}

std::string suggestion(const std::string& name, const std::vector<std::string>& candidates, const std::string& what) {
  const std::string near = nearest_name(name, candidates);
  if (!near.empty()) return "; did you mean `" + near + "`?";
  if (candidates.empty()) return {};
  if (candidates.size() == 1) return "; the only one is " + candidates.front();
  return "; " + what + " are " + listed(candidates);
}

std::string range_text(const Range& range, const std::string& unit) {
  const bool low = std::isfinite(range.low), high = std::isfinite(range.high);
  if (low && high && !range.low_open && !range.high_open)
    return "from " + quantity_text(range.low, "-") + " to " + quantity_text(range.high, unit);
  std::string text;
  if (low) text = (range.low_open ? "greater than " : "at least ") + quantity_text(range.low, unit);
  if (high)
    text += (low ? " and " : "") + ((range.high_open ? "less than " : "at most ") + quantity_text(range.high, unit));
  return text;
}

std::string expectation(const Parameter& p) {
  switch (p.kind) {
    case ValueKind::real:
      return quantity_name(p.unit);
    case ValueKind::integer:
      return "a whole number";
    case ValueKind::boolean:
      return "true or false";
    case ValueKind::text:
      return "a text";
    case ValueKind::choice:
      return "one of " + listed(p.choices, " or ");
    case ValueKind::vector:
      return "three numbers" + in_unit(p.unit);
    case ValueKind::reals:
      return "a list of numbers" + in_unit(p.unit);
    case ValueKind::integers:
      return "a list of whole numbers";
    case ValueKind::texts:
      return "a text or a list of texts";
    case ValueKind::text_map:
      return "a map from names to single values";
    case ValueKind::block:
      return "a map";
    case ValueKind::block_list:
      return "a list of maps";
    case ValueKind::block_map:
      return "a map from names to maps";
    case ValueKind::plugin:
      return "a map with `type:` (`kerf list " + p.plugin_kind + "` shows the types)";
    case ValueKind::plugin_list:
      return "a list of maps with `type:` (`kerf list " + p.plugin_kind + "` shows the types)";
    case ValueKind::plugin_map:
      return "a map from names to maps with `type:` (`kerf list " + p.plugin_kind + "` shows the types)";
    case ValueKind::curve:
      return "the name of a curve in `curves`";
    case ValueKind::expression:
      return "a formula" + of_variables(p.choices) + in_unit(p.unit);
    case ValueKind::expressions:
      return "a list of formulas" + of_variables(p.choices) + in_unit(p.unit);
  }
  return {};
}

std::string kind_text(const Parameter& p) {
  switch (p.kind) {
    case ValueKind::real:
      return "number";
    case ValueKind::integer:
      return "whole number";
    case ValueKind::boolean:
      return "true or false";
    case ValueKind::text:
      return "text";
    case ValueKind::choice:
      return listed(p.choices, " or ");
    case ValueKind::vector:
      return "three numbers";
    case ValueKind::reals:
      return "list of numbers";
    case ValueKind::integers:
      return "list of whole numbers";
    case ValueKind::texts:
      return "list of texts";
    case ValueKind::text_map:
      return "values by name";
    case ValueKind::block:
      return "block";
    case ValueKind::block_list:
      return "list of blocks";
    case ValueKind::block_map:
      return "blocks by name";
    case ValueKind::plugin:
      return p.plugin_kind;
    case ValueKind::plugin_list:
      return "list of " + p.plugin_kind;
    case ValueKind::plugin_map:
      return p.plugin_kind + " by name";
    case ValueKind::curve:
      return "name of a curve";
    case ValueKind::expression:
      return "formula" + of_variables(p.choices);
    case ValueKind::expressions:
      return "list of formulas" + of_variables(p.choices);
  }
  return {};
}

}  // namespace kerf
