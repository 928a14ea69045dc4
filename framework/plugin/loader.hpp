// Loads plugins from shared libraries, after making sure that both sides mean the same by every byte.
//
// In three steps, so that several ranks can compare what they have after each: the bytes of the file, whether they fit
// this program, and the loading itself, which is the first to run code of the library.
#pragma once

#include <string>
#include <vector>

#include "core/diagnostics.hpp"
#include "plugin/library_file.hpp"
#include "plugin/registry.hpp"

namespace kerf {

/// The folders of KERF_PLUGIN_PATH, in its order.
std::vector<std::string> plugin_folders();

/// Where a plugin is.
struct PluginPlace {
  std::string path;
  std::string failure;  // half a sentence where there is none
};

/// `name` is what the user has written, `path` the file that this means by itself. A name without a slash that is no
/// file there is looked for in the folders, with .so behind it if need be.
PluginPlace find_plugin(const std::string& name, const std::string& path, const std::vector<std::string>& folders);

// These throw std::runtime_error with half a sentence about the file: what is wrong; what to do. One that stands still
// ends the program; see stall_watch.hpp.

LibraryFile read_plugin(const std::string& path);
/// Whether it is a whole library, and a plugin for this Kerf. Laws in Python are read when they are opened.
void require_fitting(const std::string& path, LibraryFile& file);
/// Loads the library and registers what it holds. The library stays loaded. Pre: require_fitting() did not throw.
void open_plugin(const std::string& path, const LibraryFile& file, Registry& registry);

/// All of the above, where there is one process only. Every refusal goes to `diagnostics`.
void load_plugin(const std::string& name, Registry& registry, Diagnostics& diagnostics);

}  // namespace kerf
