// Loads plugins from shared libraries, after making sure that both sides mean the same by every byte.
#pragma once

#include <string>

#include "core/diagnostics.hpp"
#include "plugin/registry.hpp"

namespace kerf {

/// Loads the library and registers what it holds. Every refusal goes to `diagnostics`. The library stays loaded.
void load_plugin(const std::string& path, Registry& registry, Diagnostics& diagnostics);

/// Says what differs between the manifest of a library and this program's; empty where nothing does.
std::string manifest_difference(const Manifest& theirs, const Manifest& ours);

}  // namespace kerf
