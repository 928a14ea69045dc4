// Makes plugins for tests the way a run makes them: from the built-in table, filled and checked by the input layer.
#pragma once

#include <memory>
#include <stdexcept>
#include <string>

#include "input/binder.hpp"
#include "plugin/registry.hpp"

namespace kerf::test {

inline const Registry& builtin_plugins() {
  static const Registry registry = [] {
    Registry r;
    register_builtin_plugins(r);
    return r;
  }();
  return registry;
}

/// The plugin `name` with parameters as a user would write them, "{shear_modulus: 80.19 GPa}". Mistakes, broken
/// rules among them, throw InputError.
template <class Law>
std::unique_ptr<Law> make_law(const std::string& kind, const std::string& name, const std::string& parameters = "{}",
                              const Registry& plugins = builtin_plugins()) {
  const Description* description = plugins.find(kind, name);
  if (description == nullptr) throw std::runtime_error("no " + kind + " is called " + name);
  Made made = plugins.make(kind, name);
  Diagnostics diagnostics;
  OriginMap origins;
  const Node node = node_from_text(parameters, Origin{}, diagnostics);
  Binder(plugins, diagnostics, origins).bind_block(*description, node, made.parameters, name, Origin{});
  diagnostics.throw_if_errors();
  return std::unique_ptr<Law>(dynamic_cast<Law*>(made.plugin.release()));
}

/// The messages with which the parameters are refused, one per line; empty where they are taken.
inline std::string refusal(const std::string& kind, const std::string& name, const std::string& parameters) {
  try {
    make_law<Plugin>(kind, name, parameters);
  } catch (const InputError& error) {
    std::string text;
    for (const std::string& line : error.lines()) text += line + "\n";
    return text;
  }
  return {};
}

}  // namespace kerf::test
