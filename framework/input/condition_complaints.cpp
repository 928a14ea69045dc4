// Checks the names and the dimensions of a user's condition.
#include "input/condition_complaints.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <optional>

#include "core/diagnostics.hpp"
#include "core/dimensions.hpp"

namespace kerf {

namespace {

const KnownVariable* find(const VariableCondition& c, const std::string& name) {
  const auto found = std::find_if(c.known.begin(), c.known.end(), [&](const auto& k) { return name == k.name; });
  return found == c.known.end() ? nullptr : &*found;
}

/// Where a variable first stands in the text.
int offset_of(const Expression& condition, std::size_t variable) {
  for (const Expression::Instruction& i : condition.program())
    if (i.op == Expression::Op::variable && i.index == static_cast<int>(variable)) return i.offset;
  return 0;
}

void complain_of_names(const VariableCondition& c, const std::map<std::string, std::string>& units,
                       std::vector<ReadComplaint>& all) {
  std::vector<std::string> names;
  for (const KnownVariable& k : c.known) names.emplace_back(k.name);
  for (const auto& [name, unit] : units)
    if (find(c, name) == nullptr) names.push_back(name);
  for (std::size_t i = 0; i < c.condition->variables().size(); ++i) {
    const std::string& name = c.condition->variables()[i];
    const bool known = find(c, name) != nullptr;
    if (known && name != "pressure" && units.contains(name))
      all.push_back({c.parameter, offset_of(*c.condition, i),
                     fmt::format("a law of the material keeps a variable \"{}\" too, and nobody could know which is "
                                 "meant; expected another variable",
                                 name)});
    if (known || units.contains(name)) continue;
    const std::string near = nearest_name(name, names);
    all.push_back({c.parameter, offset_of(*c.condition, i),
                   fmt::format("there is no variable \"{}\"{}; the variables are {}", name,
                               near.empty() ? "" : fmt::format("; did you mean {}?", near), fmt::join(names, ", "))});
  }
}

}  // namespace

std::vector<ReadComplaint> complaints_about(const VariableCondition& c,
                                            const std::map<std::string, std::string>& units) {
  std::vector<ReadComplaint> all;
  if (c.condition->variables().empty())
    all.push_back({c.parameter, 0, "the condition names no variable, so that it holds always or never; expected one"});
  complain_of_names(c, units, all);
  const auto unit_of = [&](const std::string& name) -> std::optional<std::string> {
    if (const KnownVariable* k = find(c, name)) return k->unit;
    const auto found = units.find(name);
    return found == units.end() ? std::nullopt : std::optional(found->second);
  };
  for (const DimensionFault& f : faults_of_condition(*c.condition, unit_of))
    all.push_back({c.parameter, f.offset, f.sentence});
  return all;
}

}  // namespace kerf
