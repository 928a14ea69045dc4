// Finds the plugins that an input names, which have to be loaded before it can be understood.
#pragma once

#include <string>
#include <vector>

#include "core/diagnostics.hpp"

namespace kerf {

struct NamedPlugin {
  std::string name;  // as it is written
  std::string path;  // as seen from the present folder
  Origin origin;
};

/// What the key `plugins` of an input lists. Paths are relative to the folder of the file. What is wrong with the text
/// is left to read_model_input(), which reads it again.
std::vector<NamedPlugin> named_plugins(const std::string& file_name, const std::string& bytes,
                                       const std::vector<std::string>& overrides);

}  // namespace kerf
