// The input as a tree of values that know where they were written; free of any YAML library.
#pragma once

#include <cstdint>
#include <map>
#include <string>
#include <string_view>
#include <vector>

#include "core/diagnostics.hpp"

namespace kerf {

struct Entry;

/// A value of the input: a text, a list, a map in the order of writing, or nothing after a key.
struct Node {
  enum class Kind { nothing, scalar, list, map };

  Kind kind = Kind::nothing;
  Origin origin;
  std::string text;  // of a scalar
  std::vector<Node> items;  // of a list
  std::vector<Entry> entries;  // of a map

  bool is_nothing() const { return kind == Kind::nothing; }
  bool is_scalar() const { return kind == Kind::scalar; }
  bool is_list() const { return kind == Kind::list; }
  bool is_map() const { return kind == Kind::map; }
  const Entry* find(std::string_view key) const;  // null where absent
  Entry* find(std::string_view key);
  /// What it is, for messages: `the text "abc"`, "a list", "a map", "nothing".
  std::string what() const;
};

struct Entry {
  std::string key;
  Origin key_origin;
  Node value;
};

/// Replaces (or adds) the value at the path of "key.path=value". Path elements are keys of maps or positions in
/// lists, counted from zero; missing keys are created. The value is read as YAML.
void apply_override(Node& root, const std::string& override_text, Diagnostics& diagnostics);

/// Reads a default or an override as a user's text; every node gets the same origin.
Node node_from_text(const std::string& text, const Origin& origin, Diagnostics& diagnostics);

/// Fingerprint of texts and nodes, in the order in which they are added (FNV-1a).
class Digest {
 public:
  void add(const std::string& text);
  /// Keys and texts, in the order of writing; not where they stand.
  void add(const Node& node);
  std::uint64_t value() const { return value_; }

 private:
  std::uint64_t value_ = 0xcbf29ce484222325ULL;
};

/// A node as YAML that reads back as the same tree: a block of maps, one key a line. Lists stand in one line,
/// lists of maps in one line for each map.
std::string yaml_text(const Node& node, int indent = 0);

/// Remembers where the values of a model were written, by path: "parts.rod.material", "contacts[0].master".
class OriginMap {
 public:
  void add(const std::string& path, const Origin& origin, std::string text = {});
  /// Origin of the path or, where it was not written, of the innermost enclosing block that was.
  Origin find(std::string path) const;
  /// Whether the path itself was written.
  bool has(const std::string& path) const { return written_.contains(path); }
  /// Origin of the scalar `text` inside the block that starts at `block` (Plugin::origin), else `block` itself.
  std::string find_text(const std::string& block, const std::string& text) const;

 private:
  struct Written {
    Origin origin;
    std::string text;
  };
  std::map<std::string, Written> written_;
};

}  // namespace kerf
