// `kerf new-plugin`: a folder with a plugin to start from, made of the templates that come with Kerf.
//
// The files of templates/common/ and then those of templates/KIND/ are copied; a file of the kind replaces a common one
// of the same name. NAME in names of files, and @NAME@ and its like in their text, are replaced.
#include <fmt/format.h>

#include <algorithm>
#include <cctype>
#include <cerrno>
#include <cstring>
#include <ctime>
#include <filesystem>
#include <fstream>
#include <map>
#include <regex>
#include <set>
#include <sstream>
#include <stdexcept>

#include "app/commands.hpp"
#include "app/skeleton.hpp"
#include "core/diagnostics.hpp"
#include "core/shared_folder.hpp"
#include "input/parameter_text.hpp"
#include "plugin/loader.hpp"

namespace kerf {
namespace {

namespace fs = std::filesystem;

/// Text of a file by its place in the new folder.
using Files = std::map<std::string, std::string>;

int refuse(const std::string& message) {
  fmt::print(stderr, "error: {}\n", message);
  return exit_other;
}

/// Names of targets that CMake keeps for itself.
const std::set<std::string> names_of_cmake = {"all",  "clean",         "depend",       "edit_cache", "help", "install",
                                              "none", "rebuild_cache", "list_targets", "package",    "test"};

/// "swift_steel" becomes "SwiftSteel".
std::string pascal_case(const std::string& name) {
  std::string type;
  bool starts = true;
  for (const char c : name) {
    if (c != '_') type += starts ? static_cast<char>(std::toupper(static_cast<unsigned char>(c))) : c;
    starts = c == '_';
  }
  return type;
}

/// Throws std::runtime_error.
std::string text_of(const fs::path& path) {
  std::ifstream stream(path, std::ios::binary);
  std::ostringstream text;
  if (!stream || !(text << stream.rdbuf()))
    throw std::runtime_error(fmt::format("{}: this template cannot be read: {}", path.string(), std::strerror(errno)));
  return text.str();
}

/// The templates of a kind as they stand.
Files templates_of(const fs::path& templates, const std::string& kind) {
  Files files;
  for (const std::string& folder : {std::string("common"), kind})
    for (const fs::directory_entry& entry : fs::recursive_directory_iterator(templates / folder))
      if (entry.is_regular_file())
        files[entry.path().lexically_relative(templates / folder).string()] = text_of(entry.path());
  return files;
}

void replace_all(std::string& text, const std::string& what, const std::string& by) {
  for (std::size_t at = text.find(what); at != std::string::npos; at = text.find(what, at + by.size()))
    text.replace(at, what.size(), by);
}

int this_year() {
  const std::time_t now = std::time(nullptr);
  std::tm utc{};
  gmtime_r(&now, &utc);
  return utc.tm_year + 1900;
}

/// What plugins of a kind need beside Kerf, in CMake: packages to find, and targets to link.
struct Needs {
  std::string packages, link;
};

Needs needs_of(const std::string& kind) {
  if (kind == "partitioner") return {"find_package(MPI REQUIRED COMPONENTS CXX)\n", " LINK MPI::MPI_CXX"};
  return {};
}

Files filled_in(const Files& templates, const std::string& kind, const std::string& name) {
  const bool is_law = templates.contains("tests/point.yaml");
  const std::map<std::string, std::string> values = {
      {"@NAME@", name},
      {"@TYPE@", pascal_case(name)},
      {"@KIND@", kind},
      {"@PACKAGES@", needs_of(kind).packages},
      {"@LINK@", needs_of(kind).link},
      {"@VERSION@", KERF_VERSION},
      {"@DATE_YEAR@", std::to_string(this_year())},
      {"@POINT_FILES@",
       is_law
           ? "| `tests/point.yaml` | paths of one element whose answer is known, for `kerf drive --check` |\n"
             "| `tests/point_reference.py` | writes these answers, the files `tests/point*.csv`, without the plugin |\n"
           : ""}};
  Files files;
  for (const auto& [place, text] : templates) {
    std::string to = place, filled = text;
    if (to.starts_with("NAME.")) to.replace(0, 4, name);
    for (const auto& [what, by] : values) replace_all(filled, what, by);
    files[to] = filled;
  }
  return files;
}

/// Whether a file declares a type of this name: it would be ambiguous where the plugin is registered.
bool declares(const std::string& source, const std::string& type) {
  const std::regex declaration("\\b(class|struct|enum|using|concept)\\s+" + type + "\\b");
  return std::regex_search(source, declaration);
}

bool is_type_of_interface(const Files& templates, const std::string& type) {
  for (const auto& [place, text] : templates)
    if (place.ends_with(".cpp") && declares(text, type)) return true;
  for (const fs::directory_entry& header :
       fs::directory_iterator(shared_folder("include/kerf", KERF_HEADERS_OF_SOURCES)))
    if (header.is_regular_file() && declares(text_of(header.path()), type)) return true;
  return false;
}

/// What is wrong with the name; empty where nothing is.
std::string complaint_about(const std::string& name, const std::string& kind, const Registry& registry) {
  static const std::regex snake_case("[a-z][a-z0-9]*(_[a-z0-9]+)*");
  if (!std::regex_match(name, snake_case))
    return fmt::format(
        "\"{}\" is no name for a type; expected lower-case words of letters and digits joined by _, such "
        "as swift_hardening",
        name);
  if (registry.find(kind, name) != nullptr)
    return fmt::format(
        "there is a type {} of kind {} already; expected another name (`kerf describe {} {}` shows that one)", name,
        kind, kind, name);
  if (names_of_cmake.contains(name))
    return fmt::format("CMake keeps the name \"{}\" for itself; expected another name", name);
  return {};
}

/// Throws std::filesystem::filesystem_error or std::runtime_error; the caller removes what was written.
void write(const Files& files, const fs::path& folder) {
  for (const auto& [place, text] : files) {
    const fs::path path = folder / place;
    fs::create_directories(path.parent_path());
    std::ofstream stream(path, std::ios::binary);
    stream << text;
    stream.close();
    if (!stream) throw std::runtime_error(fmt::format("{}: {}", path.string(), std::strerror(errno)));
  }
}

/// What find_package(Kerf) has to be told to find the Kerf that is running.
std::string folder_of_package() {
  std::error_code none;
  const fs::path root = fs::weakly_canonical(folder_of_program() / "..", none);
  const fs::path installed = root / "lib" / "cmake" / "Kerf";
  return (fs::exists(installed / "KerfConfig.cmake", none) ? installed : root).string();
}

void print_what_is_next(const Files& files, const fs::path& folder) {
  const auto lines = [](const std::string& text) { return std::count(text.begin(), text.end(), '\n'); };
  for (const auto& [place, text] : files) fmt::print("{:>6} lines  {}\n", lines(text), (folder / place).string());
  const std::string source = folder.string(), build = (folder / "build").string();
  fmt::print(
      "\nnext, build it and run its tests:\n"
      "  cmake -G Ninja -S {} -B {} -DKerf_DIR={}\n"
      "  cmake --build {}\n"
      "  ctest --test-dir {} --output-on-failure\n",
      source, build, folder_of_package(), build, build);
}

std::vector<std::string> kinds_with_templates(const fs::path& templates) {
  std::vector<std::string> kinds;
  for (const fs::directory_entry& entry : fs::directory_iterator(templates))
    if (entry.is_directory() && entry.path().filename() != "common") kinds.push_back(entry.path().filename());
  std::sort(kinds.begin(), kinds.end());
  return kinds;
}

/// The folder of a law that was tried in Python: what all kinds share, without the tests of a template's law. Throws
/// std::runtime_error or InputError.
Files files_from_python(Files templates, const std::string& kind, const std::string& name, const std::string& python) {
  Diagnostics diagnostics;
  Registry laws;
  load_plugin(python, laws, diagnostics);
  diagnostics.throw_if_errors();
  const std::string text = text_of(python);
  const Skeleton skeleton = skeleton_of(laws, kind, name, pascal_case(name), text);
  std::erase_if(templates, [](const auto& file) {
    return file.first.starts_with("tests/point") || file.first == "tests/expected.json" || file.first == "case.yaml";
  });
  Files files = filled_in(templates, kind, name);
  std::istringstream readme(files["README.md"]);
  std::string kept;
  for (std::string line; std::getline(readme, line);)
    if (line.find("case.yaml") == std::string::npos && line.find("expected.json") == std::string::npos)
      kept += line + "\n";
  files["README.md"] = kept;
  files[name + ".cpp"] = skeleton.source;
  files[name + ".md"] = skeleton.page;
  files["tests/samples.yaml"] = skeleton.samples;
  files[name + ".py"] = text;
  return files;
}

}  // namespace

int new_plugin_command(const Registry& registry, const std::string& kind, const std::string& name,
                       const std::string& parent, const std::string& python) {
  const fs::path templates = shared_folder("share/kerf/templates", KERF_TEMPLATES_OF_SOURCES);
  const fs::path folder = fs::path(parent) / name;
  std::error_code status;
  if (!fs::is_directory(templates / "common", status))
    return refuse(
        fmt::format("the templates are not where they belong, in {}; install Kerf again", templates.string()));
  const std::vector<std::string> kinds = kinds_with_templates(templates);
  if (std::find(kinds.begin(), kinds.end(), kind) == kinds.end())
    return refuse(fmt::format("there is no kind \"{}\"{}", kind, suggestion(kind, kinds, "the kinds")));
  if (const std::string wrong = complaint_about(name, kind, registry); !wrong.empty()) return refuse(wrong);
  const Files raw = templates_of(templates, kind);
  if (is_type_of_interface(raw, pascal_case(name)))
    return refuse(
        fmt::format("the type of the new plugin would be called {}, which Kerf's interface has already; expected "
                    "another name",
                    pascal_case(name)));
  if (fs::exists(fs::symlink_status(folder, status)))
    return refuse(fmt::format("{} exists already; remove it, or name another folder with --output", folder.string()));
  Files files;
  try {
    files = python.empty() ? filled_in(raw, kind, name) : files_from_python(raw, kind, name, python);
  } catch (const std::runtime_error& e) {
    if (dynamic_cast<const InputError*>(&e) != nullptr) throw;
    return refuse(fmt::format("--from {}: {}", python, e.what()));
  }
  fs::create_directories(folder, status);
  if (status)
    return refuse(
        fmt::format("the folder {} cannot be made: {}; name another with --output", folder.string(), status.message()));
  try {
    write(files, folder);
  } catch (const std::exception& e) {
    fs::remove_all(folder, status);
    return refuse(fmt::format("the plugin could not be written, and nothing is left of it: {}", e.what()));
  }
  print_what_is_next(files, folder);
  return exit_done;
}

}  // namespace kerf
