// Reads as much of an input as tells its plugins.
#include "input/named_plugins.hpp"

#include <filesystem>
#include <optional>
#include <utility>

#include "input/substitute.hpp"
#include "input/yaml_reader.hpp"

namespace kerf {

std::vector<NamedPlugin> named_plugins(const std::string& file_name, const std::string& bytes,
                                       const std::vector<std::string>& overrides) {
  Diagnostics told_later;
  std::optional<Node> root = read_yaml(file_name, bytes, told_later);
  if (!root) return {};
  for (const std::string& text : overrides) apply_override(*root, text, told_later);
  substitute_parameters(*root, told_later);
  const Entry* key = std::as_const(*root).find("plugins");
  if (!key) return {};
  const std::filesystem::path folder = std::filesystem::path(file_name).parent_path();
  std::vector<NamedPlugin> all;
  const auto add = [&](const Node& node) {
    if (node.is_scalar() && !node.text.empty()) all.push_back({node.text, (folder / node.text).string(), node.origin});
  };
  add(key->value);
  for (const Node& item : key->value.items) add(item);
  return all;
}

}  // namespace kerf
