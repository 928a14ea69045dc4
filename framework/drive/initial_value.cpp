// Finds the law that keeps a variable, and reads its value.
#include "drive/initial_value.hpp"

#include <fmt/format.h>

#include <stdexcept>

#include "core/units.hpp"
#include "input/parameter_text.hpp"

namespace kerf {

double initial_value(const std::vector<const Law*>& laws, const std::string& owner, const std::string& name,
                     const std::string& text, std::vector<std::string> others) {
  const StateVariable* variable = nullptr;
  for (const Law* law : laws)
    for (const StateVariable& v : law->state_variables()) {
      others.push_back(v.name);
      if (v.name == name) variable = &v;
    }
  if (variable == nullptr)
    throw std::runtime_error(fmt::format("initial_state: no law of {} keeps \"{}\"{}", owner, name,
                                         suggestion(name, others, "the variables")));
  const Quantity value = to_si(text, variable->unit);
  if (!value.ok()) throw std::runtime_error(fmt::format("initial_state: `{}`: {}", name, value.error));
  if (!variable->range.contains(value.value))
    throw std::runtime_error(fmt::format("initial_state: `{}` = {} is outside of what the law takes: {}", name, text,
                                         range_text(variable->range, variable->unit)));
  return value.value;
}

}  // namespace kerf
