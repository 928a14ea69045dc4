// Laws that are written in Python, to try an idea before it is compiled.
#pragma once

#include <string>

#include "plugin/registry.hpp"

namespace kerf {

/// Whether a plugin's path names a file of laws in Python.
bool is_prototype(const std::string& path);

/// Registers the laws of a Python file. Throws std::exception with what is wrong with it. Its process lives as long as
/// the registry or an object of it.
void load_prototype(const std::string& path, Registry& registry);

}  // namespace kerf
