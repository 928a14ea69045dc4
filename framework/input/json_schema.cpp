// The JSON schema of the input file, made from the same descriptions that the input is read by.
#include "input/json_schema.hpp"

#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>

#include "input/parameter_text.hpp"
#include "input/reference_writer.hpp"
#include "plugin/kinds.hpp"

namespace kerf {
namespace {

using Json = nlohmann::ordered_json;

const std::string number_pattern = R"([+-]?([0-9]+\.?[0-9]*|\.[0-9]+)([eE][+-]?[0-9]+)?)";
const std::string name = "[A-Za-z_][A-Za-z0-9_]*";
const std::string name_pattern = "^" + name + "$";

Json block_schema(const Description& d);

// `$name` may stand in the place of any single value.
Json or_parameter(Json value) {
  return {{"anyOf", {std::move(value), Json{{"type", "string"}, {"pattern", "^\\$" + name + "$"}}}}};
}

void add_range(Json& schema, const Range& range) {
  if (std::isfinite(range.low)) schema[range.low_open ? "exclusiveMinimum" : "minimum"] = range.low;
  if (std::isfinite(range.high)) schema[range.high_open ? "exclusiveMaximum" : "maximum"] = range.high;
}

// Numbers with a unit are texts to YAML; so is 1e-7 to many of its readers.
Json number_schema(const Parameter& p) {
  Json number = {{"type", "number"}};
  add_range(number, p.range);
  const bool has_unit = p.unit != "-" && !p.unit.empty();
  const Json text = {{"type", "string"},
                     {"pattern", "^" + number_pattern + (has_unit ? "( *[^ 0-9.].*| +1/.*)?$" : "$")}};
  return or_parameter({{"anyOf", {number, text}}});
}

Json whole_number_schema(const Parameter& p) {
  Json number = {{"type", "integer"}};
  add_range(number, p.range);
  return or_parameter(std::move(number));
}

Json list_of(Json items) { return {{"type", "array"}, {"items", std::move(items)}}; }

Json map_of(Json values) {
  return {
      {"type", "object"}, {"patternProperties", {{name_pattern, std::move(values)}}}, {"additionalProperties", false}};
}

Json plugin_reference(const Parameter& p) { return {{"$ref", "#/$defs/" + p.plugin_kind}}; }

Json value_schema(const Parameter& p) {
  switch (p.kind) {
    case ValueKind::real:
      return number_schema(p);
    case ValueKind::integer:
      return whole_number_schema(p);
    case ValueKind::boolean:
      return or_parameter({{"type", "boolean"}});
    case ValueKind::text:
      return {{"type", {"string", "number", "boolean"}}};
    case ValueKind::choice:
      return or_parameter({{"enum", p.choices}});
    case ValueKind::vector:
    case ValueKind::reals: {
      Json list = list_of(number_schema(p));
      if (p.kind == ValueKind::vector) list["minItems"] = list["maxItems"] = 3;
      return {{"anyOf", {list, Json{{"type", {"string", "number"}}}}}};
    }
    case ValueKind::integers:
      return list_of(whole_number_schema(p));
    case ValueKind::texts:
      return {{"anyOf", {Json{{"type", "string"}}, list_of({{"type", "string"}})}}};
    case ValueKind::text_map:
      return map_of({{"type", {"string", "number", "boolean"}}});
    case ValueKind::block:
      return block_schema(p.nested());
    case ValueKind::block_list:
      return list_of(block_schema(p.nested()));
    case ValueKind::block_map:
      return map_of(block_schema(p.nested()));
    case ValueKind::plugin:
      return plugin_reference(p);
    case ValueKind::plugin_list:
      return list_of(plugin_reference(p));
    case ValueKind::plugin_map:
      return map_of(plugin_reference(p));
    case ValueKind::curve:
      return or_parameter({{"type", "string"}, {"pattern", name_pattern}});
    case ValueKind::expression:
      return {{"type", {"string", "number"}}};
    case ValueKind::expressions:
      return list_of({{"type", {"string", "number"}}});
  }
  return {};
}

std::string description_of(const Parameter& p) {
  std::string text = p.doc;
  if (p.unit != "-" && !p.unit.empty()) text += " [" + p.unit + "]";
  const std::string range = range_text(p.range, p.unit);
  if (!range.empty()) text += "; " + range;
  if (!p.default_text.empty() && p.default_text != "{}") text += "; by default " + p.default_text;
  return text;
}

void add_keys(Json& schema, const Description& d) {
  for (const Parameter& p : d.parameters) {
    Json value = value_schema(p);
    value["description"] = description_of(p);
    schema["properties"][p.name] = std::move(value);
    if (p.required) schema["required"].push_back(p.name);
  }
  schema["additionalProperties"] = false;
}

/// Of a block whose key `library` stands for a set: the set has what is required, and what the input gives beside it
/// replaces single keys, so that blocks may be incomplete.
Json schema_beside_library(const Description& d) {
  Json schema = {{"type", "object"}, {"properties", Json::object()}, {"additionalProperties", false}};
  for (const Parameter& p : d.parameters) {
    const bool is_part = !p.plugin_kind.empty() || p.nested;
    Json value = is_part ? Json{{"anyOf", {Json{{"type", "object"}}, Json{{"const", "suggested"}}}}} : value_schema(p);
    value["description"] = description_of(p);
    schema["properties"][p.name] = std::move(value);
  }
  return schema;
}

Json block_schema(const Description& d) {
  Json schema = {{"type", "object"}, {"properties", Json::object()}};
  add_keys(schema, d);
  const bool takes_sets = std::any_of(d.parameters.begin(), d.parameters.end(), [](const Parameter& p) {
    return p.name == "library" && p.kind == ValueKind::text;
  });
  if (!takes_sets) return schema;
  return {{"if", {{"type", "object"}, {"required", {"library"}}}},
          {"then", schema_beside_library(d)},
          {"else", std::move(schema)}};
}

Json plugin_schema(const Description& d) {
  Json schema = {{"type", "object"}, {"description", d.summary}};
  schema["properties"]["type"] = {{"const", d.name}};
  schema["required"] = {"type"};
  add_keys(schema, d);
  return schema;
}

// One branch per type, chosen by `type`, so that messages speak of the type that was meant and not of all others.
Json kind_schema(const Registry& registry, const std::string& kind) {
  Json schema = {{"type", "object"}, {"required", {"type"}}};
  const std::vector<std::string> names = registry.names(kind);
  if (names.empty()) return schema;  // the standard wants no empty lists
  schema["properties"]["type"]["enum"] = names;
  for (const std::string& name : names) {
    Json branch;
    branch["if"]["properties"]["type"]["const"] = name;
    branch["if"]["required"] = {"type"};
    branch["then"]["$ref"] = "#/$defs/" + kind + "." + name;
    schema["allOf"].push_back(std::move(branch));
  }
  return schema;
}

}  // namespace

std::string json_schema(const Registry& registry) {
  Json schema = {{"$schema", "https://json-schema.org/draft/2020-12/schema"}, {"title", "Kerf input file"}};
  schema.update(block_schema(input_description()));
  Json definitions = Json::object();
  // Every kind that the input mentions must resolve, also one of which nothing is registered.
  for (const PluginKind& kind : plugin_kinds) definitions[kind.name] = kind_schema(registry, kind.name);
  for (const std::string& kind : registry.kinds())
    for (const std::string& name : registry.names(kind))
      definitions[kind + "." + name] = plugin_schema(*registry.find(kind, name));
  schema["$defs"] = std::move(definitions);
  return schema.dump(2) + "\n";
}

}  // namespace kerf
