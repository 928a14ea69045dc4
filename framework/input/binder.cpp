// Walks a description and a node side by side: keys, types, units, ranges, defaults, plugins, rules.
#include "input/binder.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <utility>

#include "core/activity.hpp"
#include "core/expression.hpp"
#include "core/units.hpp"
#include "input/curve_table.hpp"
#include "input/number_list.hpp"
#include "input/parameter_text.hpp"
#include "input/substitute.hpp"
#include "plugin/stall_watch.hpp"

namespace kerf {
namespace {

std::string child(const std::string& path, const std::string& key) { return path.empty() ? key : path + "." + key; }

bool is_name(const std::string& text) {
  const auto letter = [](char c) { return (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || c == '_'; };
  const auto digit = [](char c) { return c >= '0' && c <= '9'; };
  return !text.empty() && letter(text.front()) &&
         std::all_of(text.begin(), text.end(), [&](char c) { return letter(c) || digit(c); });
}

// An empty block or list is written by leaving out what is in it.
bool may_be_nothing(ValueKind kind) {
  return kind == ValueKind::block || kind == ValueKind::block_list || kind == ValueKind::block_map ||
         kind == ValueKind::plugin_list || kind == ValueKind::plugin_map || kind == ValueKind::text_map;
}

// Holds a `$name` without a value, which has been reported.
bool is_unresolved(const Node& node) {
  return names_a_parameter(node) || std::any_of(node.items.begin(), node.items.end(), names_a_parameter);
}

// "key:value" without the space is one text to YAML.
std::string colon_hint(const std::string& text) {
  const std::size_t colon = text.find(':');
  return colon == std::string::npos || colon == 0 ? "" : "; a space must follow the colon";
}

}  // namespace

void Binder::bind_block(const Description& description, const Node& node, void* target, const std::string& path,
                        const Origin& where) {
  if (!path.empty()) origins_.add(path, where);
  if (!node.is_map() && !node.is_nothing()) {
    diagnostics_.error(node.origin, fmt::format("{} stands where a map of keys belongs", node.what()));
    return;
  }
  const std::size_t errors_before = diagnostics_.errors().size();
  const bool is_plugin = description.kind != "block";
  const std::vector<std::string> meant = check_keys(description, node, is_plugin);
  for (const Parameter& p : description.parameters) {
    if (const Entry* entry = node.find(p.name))
      bind_parameter(p, entry->value, target, child(path, p.name), entry->key_origin);
    else if (!p.default_text.empty())
      bind_default(p, target, child(path, p.name), where);
    else if (p.required && std::find(meant.begin(), meant.end(), p.name) == meant.end())
      diagnostics_.error(
          where, fmt::format("the required key `{}` is missing; expected {}: {}", p.name, expectation(p), p.doc));
  }
  if (diagnostics_.errors().size() == errors_before) check_rules(description, node, target, where);
}

std::vector<std::string> Binder::check_keys(const Description& description, const Node& node, bool is_plugin) {
  std::vector<std::string> keys, meant;
  if (is_plugin) keys.push_back("type");
  for (const Parameter& p : description.parameters) keys.push_back(p.name);
  for (const Entry& entry : node.entries) {
    if (std::find(keys.begin(), keys.end(), entry.key) != keys.end()) continue;
    meant.push_back(nearest_name(entry.key, keys));
    // {type:hex8} is one key without a value.
    std::string hint = colon_hint(entry.key);
    if (hint.empty()) hint = suggestion(entry.key, keys, "valid keys");
    diagnostics_.error(entry.key_origin, fmt::format("unknown key `{}`{}", entry.key, hint));
  }
  return meant;
}

void Binder::check_rules(const Description& description, const Node& node, const void* target, const Origin& where) {
  for (const Rule& rule : description.rules) {
    if (rule.holds(target)) continue;
    const Entry* entry = node.find(rule.key);
    diagnostics_.error(entry ? entry->key_origin : where, fmt::format("`{}`: {}", rule.key, rule.message));
  }
}

void Binder::bind_default(const Parameter& p, void* target, const std::string& path, const Origin& where) {
  bind_parameter(p, node_from_text(p.default_text, where, diagnostics_), target, path, where);
}

void Binder::bind_parameter(const Parameter& p, const Node& node, void* target, const std::string& path,
                            const Origin& where) {
  origins_.add(path, node.origin, node.is_scalar() ? node.text : std::string());
  if (node.is_nothing() && !may_be_nothing(p.kind)) {
    diagnostics_.error(where, fmt::format("`{}` has no value; expected {}", p.name, expectation(p)));
    return;
  }
  if (is_unresolved(node)) return;
  switch (p.kind) {
    case ValueKind::real:
      return bind_real(p, node, target);
    case ValueKind::integer:
      return bind_integer(p, node, target);
    case ValueKind::boolean:
      return bind_boolean(p, node, target);
    case ValueKind::text:
    case ValueKind::choice:
      return bind_text(p, node, target);
    case ValueKind::vector:
    case ValueKind::reals:
      return bind_reals(p, node, target);
    case ValueKind::integers:
      return bind_integers(p, node, target);
    case ValueKind::texts:
      return bind_texts(p, node, target, path);
    case ValueKind::text_map:
      return bind_text_map(p, node, target);
    case ValueKind::block:
      if (!node.is_map() && !node.is_nothing()) return mismatch(p, node);
      return bind_block(p.nested(), node, p.open_block(target, ""), path, where);
    case ValueKind::block_list:
    case ValueKind::plugin_list:
      return bind_list(p, node, target, path);
    case ValueKind::block_map:
    case ValueKind::plugin_map:
      return bind_map(p, node, target, path);
    case ValueKind::plugin:
      return bind_plugin(p, node, target, "", path, where);
    case ValueKind::curve:
      return bind_curve(p, node, target);
    case ValueKind::expression:
    case ValueKind::expressions:
      return bind_expressions(p, node, target);
  }
}

void Binder::mismatch(const Parameter& p, const Node& node) {
  const std::string hint = may_be_nothing(p.kind) && node.is_scalar() ? colon_hint(node.text) : "";
  diagnostics_.error(node.origin, fmt::format("`{}` is {}; expected {}{}", p.name, node.what(), expectation(p), hint));
}

bool Binder::is_scalar(const Parameter& p, const Node& node) {
  if (!node.is_scalar()) mismatch(p, node);
  return node.is_scalar();
}

// "Not contained" rather than "below or above": NaN is in no interval.
bool Binder::check_range(const Parameter& p, const Origin& where, double value) {
  if (p.range.contains(value)) {
    if (!p.usual.contains(value))
      diagnostics_.warning(
          where, fmt::format("`{}` = {} is not usual; expected {}{}", p.name, quantity_text(value, p.unit),
                             range_text(p.usual, p.unit),
                             p.required || p.default_text.empty() ? "" : ", or leave it out for " + p.default_text));
    return true;
  }
  diagnostics_.error(where, fmt::format("`{}` = {} is out of range; expected {}", p.name, quantity_text(value, p.unit),
                                        range_text(p.range, p.unit)));
  return false;
}

void Binder::bind_real(const Parameter& p, const Node& node, void* target) {
  if (!is_scalar(p, node)) return;
  const Quantity q = to_si(node.text, p.unit);
  if (!q.ok())
    diagnostics_.error(node.origin, fmt::format("`{}`: {}", p.name, q.error));
  else if (check_range(p, node.origin, q.value))
    p.set_real(target, q.value);
}

bool Binder::read_integer(const Parameter& p, const Node& node, std::int64_t& value) {
  long long number = 0;
  const std::string octal = octal_complaint(node.text);
  if (!octal.empty()) {
    diagnostics_.error(node.origin, fmt::format("`{}`: {}", p.name, octal));
    return false;
  }
  if (!parse_integer(node.text, number)) {
    diagnostics_.error(node.origin, fmt::format("`{}`: \"{}\" is not a whole number; expected one without unit or "
                                                "fraction, for example 10",
                                                p.name, node.text));
    return false;
  }
  value = number;
  return check_range(p, node.origin, static_cast<double>(number));
}

void Binder::bind_integer(const Parameter& p, const Node& node, void* target) {
  std::int64_t value = 0;
  if (is_scalar(p, node) && read_integer(p, node, value)) p.set_integer(target, value);
}

void Binder::bind_boolean(const Parameter& p, const Node& node, void* target) {
  if (!is_scalar(p, node)) return;
  if (node.text != "true" && node.text != "false") return mismatch(p, node);
  p.set_boolean(target, node.text == "true");
}

void Binder::bind_text(const Parameter& p, const Node& node, void* target) {
  if (!is_scalar(p, node)) return;
  if (p.kind == ValueKind::choice && std::find(p.choices.begin(), p.choices.end(), node.text) == p.choices.end()) {
    diagnostics_.error(node.origin, fmt::format("`{}`: \"{}\" is not a choice{}", p.name, node.text,
                                                suggestion(node.text, p.choices, "the choices")));
    return;
  }
  p.set_text(target, node.text);
}

void Binder::bind_reals(const Parameter& p, const Node& node, void* target) {
  QuantityList list;
  if (node.is_scalar()) {
    list = list_to_si(node.text, p.unit);
  } else if (node.is_list()) {
    std::vector<std::string> items;
    for (const Node& item : node.items) {
      if (!item.is_scalar()) return mismatch(p, item);
      items.push_back(item.text);
    }
    list = items_to_si(items, p.unit);
  } else {
    return mismatch(p, node);
  }
  if (!list.error.empty()) {
    diagnostics_.error(node.origin, fmt::format("`{}`: {}", p.name, list.error));
    return;
  }
  if (p.kind == ValueKind::vector && list.values.size() != 3) {
    const std::string example = p.unit == "-" ? "[1, 2, 3]" : "\"[1, 2, 3] " + p.unit + "\"";
    diagnostics_.error(node.origin, fmt::format("`{}` has {} number{}; expected three, for example {}", p.name,
                                                list.values.size(), list.values.size() == 1 ? "" : "s", example));
    return;
  }
  for (std::size_t i = 0; i < list.values.size(); ++i)
    if (!check_range(p, node.is_list() ? node.items[i].origin : node.origin, list.values[i])) return;
  p.set_reals(target, std::move(list.values));
}

void Binder::bind_integers(const Parameter& p, const Node& node, void* target) {
  if (!node.is_list()) return mismatch(p, node);
  std::vector<std::int64_t> values;
  for (const Node& item : node.items) {
    std::int64_t value = 0;
    if (!item.is_scalar()) return mismatch(p, item);
    if (!read_integer(p, item, value)) return;
    values.push_back(value);
  }
  p.set_integers(target, std::move(values));
}

void Binder::bind_texts(const Parameter& p, const Node& node, void* target, const std::string& path) {
  if (node.is_scalar()) return p.set_texts(target, {node.text});
  if (!node.is_list()) return mismatch(p, node);
  // Where the absence of the key means all there is, an empty list would mean the same.
  if (node.items.empty() && !p.required && p.default_text.empty()) {
    diagnostics_.error(node.origin,
                       fmt::format("`{}` is an empty list; expected at least one name, or no such key", p.name));
    return;
  }
  std::vector<std::string> values;
  for (const Node& item : node.items) {
    if (!item.is_scalar()) return mismatch(p, item);
    origins_.add(fmt::format("{}[{}]", path, values.size()), item.origin, item.text);
    values.push_back(item.text);
  }
  p.set_texts(target, std::move(values));
}

void Binder::bind_text_map(const Parameter& p, const Node& node, void* target) {
  if (!node.is_map() && !node.is_nothing()) return mismatch(p, node);
  for (const Entry& entry : node.entries) {
    check_name(entry);
    if (names_a_parameter(entry.value)) continue;
    if (entry.value.is_scalar())
      p.set_named_text(target, entry.key, entry.value.text);
    else
      diagnostics_.error(entry.value.origin,
                         fmt::format("`{}` is {}; expected a single value", entry.key, entry.value.what()));
  }
}

void Binder::check_name(const Entry& entry) {
  if (!is_name(entry.key))
    diagnostics_.error(entry.key_origin, fmt::format("`{}` is no name; expected letters, digits and underscores, "
                                                     "beginning with a letter",
                                                     entry.key));
}

void Binder::bind_list(const Parameter& p, const Node& node, void* target, const std::string& path) {
  if (!node.is_list() && !node.is_nothing()) return mismatch(p, node);
  for (std::size_t i = 0; i < node.items.size(); ++i) {
    const Node& item = node.items[i];
    const std::string item_path = fmt::format("{}[{}]", path, i);
    if (p.kind == ValueKind::plugin_list)
      bind_plugin(p, item, target, "", item_path, item.origin);
    else
      bind_block(p.nested(), item, p.open_block(target, ""), item_path, item.origin);
  }
}

void Binder::bind_map(const Parameter& p, const Node& node, void* target, const std::string& path) {
  if (!node.is_map() && !node.is_nothing()) return mismatch(p, node);
  for (const Entry& entry : node.entries) {
    check_name(entry);
    const std::string entry_path = child(path, entry.key);
    if (p.kind == ValueKind::plugin_map)
      bind_plugin(p, entry.value, target, entry.key, entry_path, entry.key_origin);
    else
      bind_block(p.nested(), entry.value, p.open_block(target, entry.key), entry_path, entry.key_origin);
  }
}

void Binder::bind_curve(const Parameter& p, const Node& node, void* target) {
  if (!is_scalar(p, node)) return;
  const Curve* curve = curves_ ? curves_->find(node.text) : nullptr;
  if (curve) return p.set_curve(target, curve);
  const std::vector<std::string> names = curves_ ? curves_->names() : std::vector<std::string>{};
  diagnostics_.error(node.origin, fmt::format("there is no curve \"{}\"{}", node.text,
                                              names.empty() ? "; declare it in the block `curves`"
                                                            : suggestion(node.text, names, "the curves")));
}

void Binder::bind_expressions(const Parameter& p, const Node& node, void* target) {
  const bool is_list = p.kind == ValueKind::expressions;
  if (is_list ? !node.is_list() : !node.is_scalar()) return mismatch(p, node);
  const ParameterText parameter = [this](const std::string& name) -> const std::string* {
    if (!parameters_) return nullptr;
    const Entry* entry = parameters_->find(name);
    return entry && entry->value.is_scalar() ? &entry->value.text : nullptr;
  };
  for (const Node& item : is_list ? node.items : std::vector<Node>{node}) {
    if (!item.is_scalar()) return mismatch(p, item);
    ReadExpression read = read_expression(item.text, p.choices, parameter);
    if (!read.ok()) return diagnostics_.error(item.origin, fmt::format("`{}`: {}", p.name, read.error));
    *static_cast<Expression*>(p.open_block(target, "")) = std::move(read.expression);
  }
}

const Description* Binder::plugin_type(const Parameter& p, const Node& node, const Origin& where) {
  const std::vector<std::string> names = registry_.names(p.plugin_kind);
  if (!node.is_map()) {
    const bool is_type = node.is_scalar() && std::find(names.begin(), names.end(), node.text) != names.end();
    diagnostics_.error(node.origin, fmt::format("`{}` is {}; expected a map such as {{type: {}}}", p.name, node.what(),
                                                is_type         ? node.text
                                                : names.empty() ? "NAME"
                                                                : names.front()));
    return nullptr;
  }
  const Entry* type = node.find("type");
  if (!type || !type->value.is_scalar()) {
    const bool no_space = std::any_of(node.entries.begin(), node.entries.end(),
                                      [](const Entry& e) { return e.key.rfind("type:", 0) == 0; });
    diagnostics_.error(where,
                       fmt::format("the required key `type` is missing{}; expected the name of one of `kerf list "
                                   "{}`",
                                   no_space ? " (a space must follow the colon)" : "", p.plugin_kind));
    return nullptr;
  }
  const std::string& name = type->value.text;
  if (names_a_parameter(type->value)) return nullptr;
  if (const Description* found = registry_.find(p.plugin_kind, name)) return found;
  diagnostics_.error(type->value.origin,
                     fmt::format("there is no {} of type \"{}\"{} (`kerf list {}` shows all)", p.plugin_kind, name,
                                 suggestion(name, names, "the types"), p.plugin_kind));
  return nullptr;
}

/// A new object of a type; nothing where its constructor has thrown, which is told where the input names the type.
std::optional<Made> Binder::make(const Description& type, const Origin& where) {
  const activity::Task task("making the " + type.kind + " " + type.name + " (" + type.origin + ")", load_limit());
  std::string thrown = "something that is not a std::exception";
  try {
    return registry_.make(type.kind, type.name);
  } catch (const std::exception& e) {
    thrown = e.what();
  } catch (...) {
  }
  diagnostics_.error(where, fmt::format("the constructor of the {} {} ({}) has thrown an exception: {}", type.kind,
                                        type.name, type.origin, thrown));
  return std::nullopt;
}

void Binder::bind_plugin(const Parameter& p, const Node& node, void* target, const std::string& key,
                         const std::string& path, const Origin& where) {
  origins_.add(path, where);
  const Description* description = plugin_type(p, node, where);
  if (!description) return;
  std::optional<Made> made_or_not = make(*description, node.find("type")->value.origin);
  if (!made_or_not) return;
  Made& made = *made_or_not;
  made.plugin->origin = where.text();
  made.plugin->label = key;
  const std::size_t errors_before = diagnostics_.errors().size();
  bind_block(*description, node, made.parameters, path, where);
  // A plugin with half its parameters would only make the checks that follow report consequences.
  if (diagnostics_.errors().size() == errors_before) p.set_plugin(target, key, std::move(made.plugin));
}

}  // namespace kerf
