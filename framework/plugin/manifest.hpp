// What this program expects of a plugin, and how a plugin's manifest differs from it.
#pragma once

#include <string>

namespace kerf {

/// This program's manifest, with the sizes of all types of the interface: lines "key=value".
std::string own_manifest();

/// Says what differs between the manifest of a library and this program's, in sentences with both values that are
/// joined by "; "; empty where nothing does. A library tells the sizes of the headers that it includes: others are not
/// compared.
std::string manifest_difference(const std::string& theirs, const std::string& ours);

/// Whether nobody knows what a library was compiled with: kerf_add_plugin() has not made it.
bool has_unknown_flags(const std::string& manifest);

}  // namespace kerf
