// Finds, reads, compares and opens shared libraries, in this order.
#include "plugin/loader.hpp"

#include <dlfcn.h>
#include <fmt/format.h>

#include <cstdlib>
#include <exception>
#include <filesystem>
#include <sstream>
#include <stdexcept>

#include "core/activity.hpp"
#include "plugin/culprit.hpp"
#include "plugin/manifest.hpp"
#include "plugin/prototype.hpp"
#include "plugin/stall_watch.hpp"

namespace kerf {
namespace {

using RegisterFunction = void (*)(Registrar&);

constexpr const char *manifest_symbol = "kerf_plugin_manifest_text", *register_symbol = "kerf_plugin_register";
constexpr const char* manifest_of_interface_9 = "kerf_plugin_manifest";

// dlopen searches the system's folders for a name without a slash, but a user means the file.
std::string with_folder(const std::string& path) { return path.find('/') == std::string::npos ? "./" + path : path; }

/// What the system's loader says, with what to do about it.
std::string loading_failure(const std::string& said) {
  static const std::string no_symbol = "undefined symbol: ", no_library = ": cannot open shared object file";
  if (const std::size_t at = said.find(no_symbol); at != std::string::npos) {
    const std::string name = said.substr(at + no_symbol.size());
    return fmt::format(
        "cannot be loaded: it uses {}, which is defined nowhere; add the source file or the library that "
        "defines it (LINK of kerf_add_plugin())",
        demangled(name.substr(0, name.find(','))));
  }
  if (const std::size_t at = said.find(no_library); at != std::string::npos)
    return fmt::format(
        "cannot be loaded: it needs the library {}, which is not there; put it back, or name its folder in "
        "LD_LIBRARY_PATH",
        said.substr(0, at));
  return fmt::format("cannot be loaded: {}; rebuild it with kerf_add_plugin() of this Kerf", said);
}

}  // namespace

std::vector<std::string> plugin_folders() {
  std::vector<std::string> folders;
  const char* text = std::getenv("KERF_PLUGIN_PATH");
  std::istringstream list(text ? text : "");
  for (std::string folder; std::getline(list, folder, ':');)
    if (!folder.empty()) folders.push_back(folder);
  return folders;
}

PluginPlace find_plugin(const std::string& name, const std::string& path, const std::vector<std::string>& folders) {
  std::error_code unknown;
  if (std::filesystem::is_regular_file(path, unknown)) return {path, ""};
  std::vector<std::string> tried = {path};
  if (name.find('/') == std::string::npos)
    for (const std::string& folder : folders) {
      tried.push_back((std::filesystem::path(folder) / name).string());
      if (std::filesystem::path(name).extension() != ".so" && !is_prototype(name))
        tried.push_back(tried.back() + ".so");
    }
  for (const std::string& candidate : tried)
    if (std::filesystem::is_regular_file(candidate, unknown)) return {candidate, ""};
  if (std::filesystem::exists(path, unknown)) return {path, ""};  // no file, which is told when it is read
  return {path,
          fmt::format("there is no such plugin file; looked for {}; expected a shared library (.so), by its path or "
                      "by its name in a folder of KERF_PLUGIN_PATH",
                      fmt::join(tried, ", "))};
}

LibraryFile read_plugin(const std::string& path) {
  const activity::Task task("reading the plugin " + path, load_limit());
  return LibraryFile(path);
}

void require_fitting(const std::string& path, LibraryFile& file) {
  if (is_prototype(path)) return;
  const activity::Task task("reading the plugin " + path, load_limit());
  file.require_whole();
  const std::optional<std::string> manifest = file.text_of(manifest_symbol);
  if (!manifest && file.has_symbol(manifest_of_interface_9))
    throw std::runtime_error(
        "is a plugin for an older Kerf, of interface 9 or before; rebuild it with this Kerf's headers; "
        "doc/plugin-authors/interface_changes.md tells what has changed");
  if (!manifest || !file.has_symbol(register_symbol))
    throw std::runtime_error(
        "is a shared library but no Kerf plugin; build it with kerf_add_plugin(), and use KERF_REGISTER or one of the "
        "macros named after the kinds, such as KERF_MATERIAL");
  if (has_unknown_flags(*manifest))
    throw std::runtime_error(
        "was compiled without kerf_add_plugin(), so nobody knows with which flags; they decide what numbers mean; "
        "build it with kerf_add_plugin()");
  const std::string difference = manifest_difference(*manifest, own_manifest());
  if (!difference.empty())
    throw std::runtime_error("does not fit this Kerf: " + difference +
                             "; rebuild the plugin with kerf_add_plugin() of this Kerf and the same compiler");
}

void open_plugin(const std::string& path, const LibraryFile& file, Registry& registry) {
  const activity::Task task("loading the plugin " + path, load_limit());
  if (is_prototype(path)) return load_prototype(path, registry);
  const std::string opened = with_folder(path);
  remember_library(opened, file.functions());
  void* library = dlopen(opened.c_str(), RTLD_NOW | RTLD_LOCAL);
  if (!library) throw std::runtime_error(loading_failure(dlerror()));
  const auto register_types = reinterpret_cast<RegisterFunction>(dlsym(library, register_symbol));
  try {
    register_types(registry);
  } catch (const std::exception& e) {
    throw std::runtime_error(fmt::format("its types cannot be registered: {}", e.what()));
  } catch (...) {
    throw std::runtime_error("its types cannot be registered: something was thrown that is not a std::exception");
  }
}

void load_plugin(const std::string& name, Registry& registry, Diagnostics& diagnostics) {
  const PluginPlace place = find_plugin(name, name, plugin_folders());
  if (!place.failure.empty()) return diagnostics.error(name, place.failure);
  try {
    LibraryFile file = read_plugin(place.path);
    require_fitting(place.path, file);
    open_plugin(place.path, file, registry);
  } catch (const std::exception& e) {
    diagnostics.error(place.path, e.what());
  }
}

}  // namespace kerf
