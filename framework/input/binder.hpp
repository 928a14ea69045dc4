// Fills objects from nodes as their descriptions say, and reports everything that does not fit.
#pragma once

#include <optional>
#include <string>

#include "core/diagnostics.hpp"
#include "input/document.hpp"
#include "plugin/registry.hpp"

namespace kerf {

class CurveTable;

class Binder {
 public:
  /// `curves` has the curves that the input may name, `parameters` the block of the parameters that its formulas may
  /// name; null where it has none.
  Binder(const Registry& registry, Diagnostics& diagnostics, OriginMap& origins, CurveTable* curves = nullptr,
         const Node* parameters = nullptr)
      : registry_(registry), diagnostics_(diagnostics), origins_(origins), curves_(curves), parameters_(parameters) {}

  /// Fills `target`, which `description` describes, from a map. `path` is what the block is called in the input
  /// ("parts.rod"), empty for the whole; `where` is the place of its key.
  void bind_block(const Description& description, const Node& node, void* target, const std::string& path,
                  const Origin& where);

 private:
  void bind_parameter(const Parameter& p, const Node& node, void* target, const std::string& path, const Origin& where);
  void bind_default(const Parameter& p, void* target, const std::string& path, const Origin& where);
  void bind_real(const Parameter& p, const Node& node, void* target);
  void bind_integer(const Parameter& p, const Node& node, void* target);
  void bind_boolean(const Parameter& p, const Node& node, void* target);
  void bind_text(const Parameter& p, const Node& node, void* target);
  void bind_reals(const Parameter& p, const Node& node, void* target);
  void bind_integers(const Parameter& p, const Node& node, void* target);
  void bind_texts(const Parameter& p, const Node& node, void* target, const std::string& path);
  void bind_text_map(const Parameter& p, const Node& node, void* target);
  void bind_list(const Parameter& p, const Node& node, void* target, const std::string& path);
  void bind_map(const Parameter& p, const Node& node, void* target, const std::string& path);
  std::optional<Made> make(const Description& type, const Origin& where);
  void bind_plugin(const Parameter& p, const Node& node, void* target, const std::string& key, const std::string& path,
                   const Origin& where);
  void bind_curve(const Parameter& p, const Node& node, void* target);
  void bind_expressions(const Parameter& p, const Node& node, void* target);
  const Description* plugin_type(const Parameter& p, const Node& node, const Origin& where);
  /// Returns the names that unknown keys were probably meant to be.
  std::vector<std::string> check_keys(const Description& description, const Node& node, bool is_plugin);
  void check_rules(const Description& description, const Node& node, const void* target, const Origin& where);
  void check_name(const Entry& entry);
  bool is_scalar(const Parameter& p, const Node& node);
  bool read_integer(const Parameter& p, const Node& node, std::int64_t& value);
  bool check_range(const Parameter& p, const Origin& where, double value);
  void mismatch(const Parameter& p, const Node& node);

  const Registry& registry_;
  Diagnostics& diagnostics_;
  OriginMap& origins_;
  CurveTable* curves_;
  const Node* parameters_;
};

}  // namespace kerf
