// The node tree: look-up, overrides from the command line, and the map from paths to origins.
#include "input/document.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <charconv>
#include <utility>

#include "core/units.hpp"
#include "input/yaml_reader.hpp"

namespace kerf {
namespace {

void set_origin(Node& node, const Origin& origin) {
  node.origin = origin;
  for (Node& item : node.items) set_origin(item, origin);
  for (Entry& entry : node.entries) {
    entry.key_origin = origin;
    set_origin(entry.value, origin);
  }
}

// "contacts[0].type" and "contacts.0.type" mean the same.
std::vector<std::string> split_path(std::string_view path) {
  std::vector<std::string> elements(1);
  for (const char c : path) {
    if (c == '.' || c == '[')
      elements.emplace_back();
    else if (c != ']')
      elements.back() += c;
  }
  return elements;
}

// The child of `node` that a path element names; null, with an error, where it cannot exist.
Node* step_into(Node& node, const std::string& element, const Origin& origin, Diagnostics& diagnostics) {
  if (node.is_list()) {
    std::size_t index = 0;
    const auto [end, status] = std::from_chars(element.data(), element.data() + element.size(), index);
    if (status == std::errc() && end == element.data() + element.size() && index < node.items.size())
      return &node.items[index];
    diagnostics.error(origin, fmt::format("\"{}\" is no position in a list of {}; expected a number from 0 to {}",
                                          element, node.items.size(), std::max<std::size_t>(node.items.size(), 1) - 1));
    return nullptr;
  }
  if (node.is_scalar()) {
    diagnostics.error(origin,
                      fmt::format("\"{}\" leads into {}; expected a map or a list there", element, node.what()));
    return nullptr;
  }
  node.kind = Node::Kind::map;
  if (Entry* entry = node.find(element)) return &entry->value;
  node.entries.push_back({element, origin, {}});
  node.entries.back().value.origin = origin;
  return &node.entries.back().value;
}

/// A text as YAML, in quotes where it could be read as something else.
std::string quoted(const std::string& text) {
  const auto plain = [](char c) {
    return (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || (c >= '0' && c <= '9') || c == '_' || c == '.' ||
           c == '+' || c == '-' || c == '/' || c == '(' || c == ')' || c == ' ';
  };
  if (!text.empty() && std::all_of(text.begin(), text.end(), plain) && text.front() != ' ' && text.back() != ' ' &&
      text.front() != '-' && text != "null")
    return text;
  std::string out = "\"";
  for (const char c : text) {
    if (c == '"' || c == '\\') out += '\\';
    out += c == '\n' ? std::string("\\n") : std::string(1, c);
  }
  return out + "\"";
}

std::string inline_yaml(const Node& node) {
  if (node.is_scalar()) return quoted(node.text);
  if (node.is_nothing()) return "";
  std::string text;
  for (const Node& item : node.items) text += (text.empty() ? "" : ", ") + inline_yaml(item);
  for (const Entry& entry : node.entries)
    text += (text.empty() ? "" : ", ") + quoted(entry.key) + ": " + inline_yaml(entry.value);
  return node.is_list() ? "[" + text + "]" : "{" + text + "}";
}

}  // namespace

const Entry* Node::find(std::string_view key) const {
  for (const Entry& entry : entries)
    if (entry.key == key) return &entry;
  return nullptr;
}

Entry* Node::find(std::string_view key) { return const_cast<Entry*>(std::as_const(*this).find(key)); }

std::string Node::what() const {
  switch (kind) {
    case Kind::scalar:
      return "the text \"" + text + "\"";
    case Kind::list:
      return "a list";
    case Kind::map:
      return "a map";
    case Kind::nothing:
      break;
  }
  return "nothing";
}

Node node_from_text(const std::string& text, const Origin& origin, Diagnostics& diagnostics) {
  Node node;
  const std::string_view value = trimmed(text);
  // "[1, 2, 3] mm" is a value of ours, but not YAML.
  if (!value.empty() && value.front() == '[' && value.back() != ']') {
    node.kind = Node::Kind::scalar;
    node.text = value;
  } else {
    node = read_yaml(origin.text(), text, diagnostics).value_or(Node{});
  }
  set_origin(node, origin);
  return node;
}

void apply_override(Node& root, const std::string& override_text, Diagnostics& diagnostics) {
  const Origin origin{std::make_shared<const std::string>("--set " + override_text), 0, 0};
  const std::size_t equals = override_text.find('=');
  const std::string_view path = trimmed(std::string_view(override_text).substr(0, equals));
  if (equals == std::string::npos || path.empty()) {
    diagnostics.error(origin, "there is nothing to set; expected key.path=value, for example time.end=50e-6");
    return;
  }
  Node* node = &root;
  Entry* last = nullptr;
  for (const std::string& element : split_path(path)) {
    if (element.empty()) {
      diagnostics.error(origin,
                        fmt::format("\"{}\" has an empty element; expected keys with single dots between", path));
      return;
    }
    Node* parent = node;
    node = step_into(*parent, element, origin, diagnostics);
    if (!node) return;
    last = parent->is_map() ? parent->find(element) : nullptr;
  }
  *node = node_from_text(override_text.substr(equals + 1), origin, diagnostics);
  if (last) last->key_origin = origin;
}

void Digest::add(const std::string& text) {
  for (const char c : text + '\n') value_ = (value_ ^ static_cast<unsigned char>(c)) * 0x100000001b3ULL;
}

void Digest::add(const Node& node) {
  add(node.text);
  for (const Node& item : node.items) add(item);
  for (const Entry& entry : node.entries) {
    add(entry.key);
    add(entry.value);
  }
}

std::string yaml_text(const Node& node, int indent) {
  const std::string margin(static_cast<std::size_t>(indent), ' ');
  std::string text;
  if (node.is_list() && std::any_of(node.items.begin(), node.items.end(), [](const Node& i) { return i.is_map(); })) {
    for (const Node& item : node.items) text += margin + "- " + inline_yaml(item) + "\n";
    return text;
  }
  if (!node.is_map()) return inline_yaml(node) + "\n";
  for (const Entry& entry : node.entries) {
    text += margin + quoted(entry.key) + ":";
    const Node& value = entry.value;
    const bool is_block = (value.is_map() && !value.entries.empty()) ||
                          (value.is_list() && !value.items.empty() && value.items.front().is_map());
    text += is_block ? "\n" + yaml_text(value, indent + 2) : " " + inline_yaml(value) + "\n";
  }
  return text;
}

void OriginMap::add(const std::string& path, const Origin& origin, std::string text) {
  written_[path] = {origin, std::move(text)};
}

Origin OriginMap::find(std::string path) const {
  while (true) {
    const auto found = written_.find(path);
    if (found != written_.end()) return found->second.origin;
    if (path.empty()) return {};
    const std::size_t cut = path.find_last_of(".[");
    path.resize(cut == std::string::npos ? 0 : cut);
  }
}

std::string OriginMap::find_text(const std::string& block, const std::string& text) const {
  for (const auto& [path, written] : written_) {
    if (written.origin.text() != block) continue;
    for (const auto& [inner, candidate] : written_) {
      const bool inside = inner.size() > path.size() && inner.compare(0, path.size(), path) == 0 &&
                          (inner[path.size()] == '.' || inner[path.size()] == '[');
      if (inside && candidate.text == text) return candidate.origin.text();
    }
  }
  return block;
}

}  // namespace kerf
