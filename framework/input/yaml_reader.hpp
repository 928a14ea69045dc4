// Reads YAML text into nodes. The only room that knows a YAML library.
#pragma once

#include <optional>
#include <string>

#include "input/document.hpp"

namespace kerf {

/// The tree of `text`; `file_name` is what messages call it. Nothing, and an error, where the text is not YAML.
/// Keys that are written twice are errors too. Anchors and aliases are resolved; tags are refused.
std::optional<Node> read_yaml(const std::string& file_name, const std::string& text, Diagnostics& diagnostics);

}  // namespace kerf
