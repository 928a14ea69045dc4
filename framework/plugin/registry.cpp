// The registry: one map from kind and name to description and maker.
#include "plugin/registry.hpp"

#include <fmt/format.h>

#include <stdexcept>
#include <utility>

namespace kerf {

void Registry::add(Description description, Made (*make)()) { add_made(std::move(description), make); }

void Registry::add_made(Description description, std::function<Made()> make) {
  const auto key = std::make_pair(description.kind, description.name);
  const auto found = entries_.find(key);
  if (found != entries_.end())
    throw std::runtime_error("two plugins of kind " + key.first + " are called \"" + key.second + "\": one in " +
                             found->second.description.origin + ", one in " + description.origin +
                             "; rename one of them");
  entries_.emplace(key, Entry{std::move(description), std::move(make)});
}

void Registry::note_file(const std::string& name, std::uint64_t checksum) {
  noted_.insert(fmt::format("{} {:016x}\n", name, checksum));
  files_.clear();
  for (const std::string& line : noted_) files_ += line;
}

const Description* Registry::find(const std::string& kind, const std::string& name) const {
  const auto found = entries_.find({kind, name});
  return found == entries_.end() ? nullptr : &found->second.description;
}

Made Registry::make(const std::string& kind, const std::string& name) const {
  const Entry& entry = entries_.at({kind, name});
  Made made = entry.make();
  made.plugin->type = name;
  made.plugin->description = &entry.description;
  return made;
}

std::vector<std::string> Registry::kinds() const {
  std::vector<std::string> kinds;
  for (const auto& [key, entry] : entries_)
    if (kinds.empty() || kinds.back() != key.first) kinds.push_back(key.first);
  return kinds;
}

std::vector<std::string> Registry::names(const std::string& kind) const {
  std::vector<std::string> names;
  for (const auto& [key, entry] : entries_)
    if (key.first == kind) names.push_back(key.second);
  return names;
}

}  // namespace kerf
