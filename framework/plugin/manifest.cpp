// Reads manifests and tells them apart. Includes every header that lists sizes, so that this program's list is whole.
#include "plugin/manifest.hpp"

#include <fmt/format.h>

#include <map>
#include <sstream>
#include <vector>

#include "kerf/balance_policy.hpp"
#include "kerf/boundary.hpp"
#include "kerf/collapsed_cell.hpp"
#include "kerf/contact.hpp"
#include "kerf/curve.hpp"
#include "kerf/element.hpp"
#include "kerf/expression.hpp"
#include "kerf/file_mesh.hpp"
#include "kerf/input_files.hpp"
#include "kerf/law_use.hpp"
#include "kerf/load.hpp"
#include "kerf/manifest.hpp"
#include "kerf/measure.hpp"
#include "kerf/mesh.hpp"
#include "kerf/observer.hpp"
#include "kerf/partitioner.hpp"
#include "kerf/plugin.hpp"

namespace kerf {
namespace {

using Lines = std::map<std::string, std::string>;

constexpr const char* of_sizes = "size.";
constexpr const char* unknown_flags = "unknown";

template <std::size_t... header>
constexpr bool all_included(std::index_sequence<header...>) {
  return ((detail::SizesIn<static_cast<ApiHeader>(header)>::n > 0) && ...);
}
static_assert(all_included(std::make_index_sequence<static_cast<std::size_t>(ApiHeader::count)>()),
              "this file includes every header of ApiHeader");

Lines lines_of(const std::string& manifest) {
  Lines lines;
  std::istringstream text(manifest);
  for (std::string line; std::getline(text, line);)
    if (const std::size_t at = line.find('='); at != std::string::npos) lines[line.substr(0, at)] = line.substr(at + 1);
  return lines;
}

/// How a key is called in a sentence.
std::string name_of(const std::string& key) {
  static const Lines names = {{"interface", "the interface version"},
                              {"kerf", "Kerf's version"},
                              {"compiler", "the compiler"},
                              {"lane_width", "the lane width"},
                              {"instructions", "the instruction set"},
                              {"arithmetic", "the arithmetic"},
                              {"standard_library", "the C++ library"}};
  if (const auto found = names.find(key); found != names.end()) return found->second;
  if (key.rfind(of_sizes, 0) != 0) return "`" + key + "`";
  return "the size of " + key.substr(key.find('.', 5) + 1);
}

/// What a flag decides: of several flags for one thing the last holds.
std::string what_it_decides(std::string flag) {
  if (flag.rfind("-fno-", 0) == 0) flag = "-f" + flag.substr(5);
  return flag.substr(0, flag.find('='));
}

Lines flags_of(const std::string& text) {
  Lines flags;
  std::istringstream words(text);
  for (std::string flag; words >> flag;) flags[what_it_decides(flag)] = flag;
  return flags;
}

/// The flags of `some` that `others` lacks or decides in another way.
std::vector<std::string> only_in(const Lines& some, const Lines& others) {
  std::vector<std::string> flags;
  for (const auto& [what, flag] : some)
    if (const auto found = others.find(what); found == others.end() || found->second != flag) flags.push_back(flag);
  return flags;
}

std::string flags_difference(const std::string& theirs, const std::string& ours) {
  const std::vector<std::string> theirs_only = only_in(flags_of(theirs), flags_of(ours)),
                                 ours_only = only_in(flags_of(ours), flags_of(theirs));
  if (theirs_only.empty() && ours_only.empty()) return "";
  const auto list = [](const std::vector<std::string>& flags) {
    return flags.empty() ? "none" : fmt::format("{}", fmt::join(flags, " "));
  };
  return fmt::format("the compile flags that differ are \"{}\" in the plugin and \"{}\" here", list(theirs_only),
                     list(ours_only));
}

/// Whether the library includes the header of a size.
bool tells_header_of(const Lines& theirs, const std::string& key) {
  const std::string header = key.substr(0, key.find('.', 5) + 1);
  const auto next = theirs.lower_bound(header);
  return next != theirs.end() && next->first.rfind(header, 0) == 0;
}

std::string difference_in(const std::string& key, const Lines& theirs, const Lines& ours) {
  const auto a = theirs.find(key), b = ours.find(key);
  const bool is_size = key.rfind(of_sizes, 0) == 0;
  if (a == theirs.end() && is_size && !tells_header_of(theirs, key)) return "";
  const auto value = [is_size](const Lines& lines, Lines::const_iterator at) {
    const bool quoted = !is_size && at != lines.end() && at->second.find_first_not_of("0123456789") < at->second.size();
    return at == lines.end() ? "not told" : quoted ? "\"" + at->second + "\"" : at->second;
  };
  const std::string in_plugin = value(theirs, a), here = value(ours, b);
  if (in_plugin == here) return "";
  if (key == "flags" && a != theirs.end() && b != ours.end()) return flags_difference(a->second, b->second);
  return fmt::format("{} is {} in the plugin and {} here", name_of(key), in_plugin, here);
}

}  // namespace

std::string own_manifest() {
  static constexpr auto manifest = detail::manifest_text<struct ManifestOfTheEngine, interface_version>();
  return manifest.text;
}

std::string manifest_difference(const std::string& theirs, const std::string& ours) {
  const Lines a = lines_of(theirs), b = lines_of(ours);
  // What says most comes first; then every other key that one of the two has, in the order of the alphabet.
  std::vector<std::string> keys = {"interface",    "compiler",   "flags",           "arithmetic",
                                   "instructions", "lane_width", "standard_library"};
  Lines others = a;
  others.insert(b.begin(), b.end());
  others.erase("kerf");
  for (const std::string& key : keys) others.erase(key);
  for (const auto& [key, value] : others) keys.push_back(key);
  std::string text;
  for (const std::string& key : keys)
    if (const std::string difference = difference_in(key, a, b); !difference.empty())
      text += (text.empty() ? "" : "; ") + difference;
  // Versions differ and the interface stays: that is the promise of doc/plugin-authors/versions.md. They only explain
  // another difference.
  if (const std::string version = difference_in("kerf", a, b); !text.empty() && !version.empty())
    text += "; " + version;
  return text;
}

bool has_unknown_flags(const std::string& manifest) {
  const Lines lines = lines_of(manifest);
  const auto flags = lines.find("flags");
  return flags == lines.end() || flags->second == unknown_flags;
}

}  // namespace kerf
