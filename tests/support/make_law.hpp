// Makes plugins for tests the way a run makes them: from the built-in table, filled and checked by the input layer.
#pragma once

#include <memory>
#include <stdexcept>
#include <string>

#include "input/binder.hpp"
#include "input/curve_table.hpp"
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
/// rules among them, throw InputError. It may name the curves of a table, which must outlive it.
template <class Law>
std::unique_ptr<Law> make_law(const std::string& kind, const std::string& name, const std::string& parameters = "{}",
                              CurveTable* curves = nullptr, const Registry& plugins = builtin_plugins()) {
  const Description* description = plugins.find(kind, name);
  if (description == nullptr) throw std::runtime_error("no " + kind + " is called " + name);
  Made made = plugins.make(kind, name);
  Diagnostics diagnostics;
  OriginMap origins;
  const Node node = node_from_text(parameters, Origin{}, diagnostics);
  Binder(plugins, diagnostics, origins, curves).bind_block(*description, node, made.parameters, name, Origin{});
  diagnostics.throw_if_errors();
  return std::unique_ptr<Law>(dynamic_cast<Law*>(made.plugin.release()));
}

/// The messages with which the parameters are refused, one per line; empty where they are taken.
inline std::string refusal(const std::string& kind, const std::string& name, const std::string& parameters,
                           CurveTable* curves = nullptr) {
  try {
    make_law<Plugin>(kind, name, parameters, curves);
  } catch (const InputError& error) {
    std::string text;
    for (const std::string& line : error.lines()) text += line + "\n";
    return text;
  }
  return {};
}

/// A table with one curve, "ramp": 0 until 1 s, then rising by 2 per second up to 2 s.
class RampTable {
 public:
  RampTable() : table_(inputs_, "", read_text_file, origins_, diagnostics_) {
    inputs_.push_back(std::make_unique<CurveInput>());
    inputs_.back()->name = "ramp";
    inputs_.back()->times = {1.0, 2.0};
    inputs_.back()->values = {0.0, 2.0};
  }
  CurveTable* table() { return &table_; }

 private:
  CurveTable::Inputs inputs_;
  OriginMap origins_;
  Diagnostics diagnostics_;
  CurveTable table_;
};

}  // namespace kerf::test
