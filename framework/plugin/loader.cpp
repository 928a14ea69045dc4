// Opens shared libraries and compares their manifest before any other call into them.
#include "plugin/loader.hpp"

#include <dlfcn.h>
#include <fmt/format.h>

#include <cstring>
#include <exception>
#include <filesystem>

#include "plugin/prototype.hpp"

namespace kerf {
namespace {

using ManifestFunction = Manifest (*)();
using RegisterFunction = void (*)(Registrar&);

template <class Function>
Function symbol(void* library, const char* name) {
  return reinterpret_cast<Function>(dlsym(library, name));
}

std::string number_difference(const char* what, int theirs, int ours) {
  return theirs == ours ? "" : fmt::format("{} is {} in the plugin and {} here", what, theirs, ours);
}

template <std::size_t N>
std::string text_difference(const char* what, const char (&theirs)[N], const char (&ours)[N]) {
  const std::string a(theirs, strnlen(theirs, N)), b(ours, strnlen(ours, N));
  return a == b ? "" : fmt::format("{} is \"{}\" in the plugin and \"{}\" here", what, a, b);
}

// dlopen searches the system's folders for a name without a slash, but a user means the file.
std::string with_folder(const std::string& path) { return path.find('/') == std::string::npos ? "./" + path : path; }

}  // namespace

std::string manifest_difference(const Manifest& theirs, const Manifest& ours) {
  std::string text;
  for (const std::string& difference :
       {number_difference("the interface version", theirs.interface, ours.interface),
        text_difference("Kerf's version", theirs.kerf_version, ours.kerf_version),
        text_difference("the compiler", theirs.compiler, ours.compiler),
        number_difference("the lane width", theirs.lane_width, ours.lane_width),
        number_difference("the size of Description", theirs.size_of_description, ours.size_of_description),
        number_difference("the size of Parameter", theirs.size_of_parameter, ours.size_of_parameter),
        number_difference("the size of Plugin", theirs.size_of_plugin, ours.size_of_plugin)})
    if (!difference.empty()) text += (text.empty() ? "" : "; ") + difference;
  return text;
}

void load_plugin(const std::string& path, Registry& registry, Diagnostics& diagnostics) {
  std::error_code ignored;
  if (!std::filesystem::is_regular_file(path, ignored))
    return diagnostics.error(path, "there is no such plugin file; expected the path of a shared library (.so)");
  if (is_prototype(path)) return load_prototype(path, registry, diagnostics);
  void* library = dlopen(with_folder(path).c_str(), RTLD_NOW | RTLD_LOCAL);
  if (!library)
    return diagnostics.error(path, fmt::format("cannot be loaded as a plugin: {}; rebuild it with this Kerf's headers "
                                               "and libraries",
                                               dlerror()));
  const auto manifest = symbol<ManifestFunction>(library, "kerf_plugin_manifest");
  const auto register_types = symbol<RegisterFunction>(library, "kerf_plugin_register");
  if (!manifest || !register_types)
    return diagnostics.error(path,
                             "is a shared library but no Kerf plugin; build it with kerf_add_plugin(), and use "
                             "KERF_REGISTER or one of the macros named after the kinds, such as KERF_MATERIAL");
  const std::string difference = manifest_difference(manifest(), this_manifest());
  if (!difference.empty())
    return diagnostics.error(path, "does not fit this Kerf: " + difference +
                                       "; rebuild the plugin with this Kerf's headers and the same compiler");
  try {
    register_types(registry);
  } catch (const std::exception& e) {
    diagnostics.error(path, e.what());
  }
}

}  // namespace kerf
