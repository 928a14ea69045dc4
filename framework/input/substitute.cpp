// Replacement of `$name` by the text of a parameter.
#include "input/substitute.hpp"

#include <algorithm>
#include <utility>

namespace kerf {

namespace {

using Names = std::vector<std::string>;

void replace(Node& node, const std::vector<Entry>& values, const Names& names, Diagnostics& diagnostics) {
  for (Node& item : node.items) replace(item, values, names, diagnostics);
  for (Entry& entry : node.entries) replace(entry.value, values, names, diagnostics);
  if (!names_a_parameter(node)) return;
  const std::string name = node.text.substr(1);
  const auto it = std::find(names.begin(), names.end(), name);
  if (it != names.end()) {
    const Node& value = values[static_cast<std::size_t>(it - names.begin())].value;
    if (value.is_scalar() && !names_a_parameter(value)) node.text = value.text;  // else the declaration is refused
    return;
  }
  const std::string near = nearest_name(name, names);
  diagnostics.error(node.origin,
                    "there is no parameter \"" + name + "\"; " +
                        (near.empty() ? "declare it in the block `parameters`" : "did you mean $" + near + "?"));
}

}  // namespace

// "$a * x" is a formula, which finds its parameters itself.
bool names_a_parameter(const Node& node) {
  return node.is_scalar() && !node.text.empty() && node.text[0] == '$' &&
         node.text.find_first_of(" +-*/^()<>=!,") == std::string::npos;
}

void substitute_parameters(Node& root, Diagnostics& diagnostics) {
  std::vector<Entry> values;
  Names names;
  const Entry* block = std::as_const(root).find("parameters");
  if (block)
    for (const Entry& e : block->value.entries) {
      if (names_a_parameter(e.value))
        diagnostics.error(e.value.origin, "the parameter \"" + e.key + "\" is " + e.value.what() +
                                              "; expected a value of its own, not another parameter");
      names.push_back(e.key);
      values.push_back(e);
    }
  for (Entry& entry : root.entries)
    if (entry.key != "parameters") replace(entry.value, values, names, diagnostics);
}

}  // namespace kerf
