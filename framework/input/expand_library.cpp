// Puts sets of the material library in the place of `library: NAME`.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <memory>
#include <utility>

#include "core/units.hpp"
#include "input/library.hpp"
#include "input/substitute.hpp"

namespace kerf {
namespace {

/// Whether a block chooses another type than the one it overrides: none of the other keys would fit then.
bool is_other_type(const Node& of_set, const Node& of_input) {
  const Entry* theirs = of_set.find("type");
  const Entry* ours = of_input.find("type");
  return theirs && ours && theirs->value.text != ours->value.text;
}

/// Puts what the input gives in the place of what the set gives, key by key. Collects the paths that have changed.
void override_with(Node& of_set, const Node& of_input, const std::string& path, std::vector<std::string>& changed) {
  if (!of_set.is_map() || !of_input.is_map() || is_other_type(of_set, of_input)) {
    of_set = of_input;
    changed.push_back(path);
    return;
  }
  for (const Entry& given : of_input.entries) {
    const std::string inner = path.empty() ? given.key : path + "." + given.key;
    if (Entry* known = of_set.find(given.key)) {
      known->key_origin = given.key_origin;
      override_with(known->value, given.value, inner, changed);
    } else {
      of_set.entries.push_back(given);
      if (!path.empty()) changed.push_back(inner);  // a block beside those of the set overrides nothing
    }
  }
}

/// Replaces `erosion: suggested` by what the set suggests.
void take_suggestions(Node& given, const MaterialSet& set, Diagnostics& diagnostics) {
  for (Entry& block : given.entries) {
    if (!block.value.is_scalar() || block.value.text != "suggested") continue;
    if (const Entry* suggested = set.suggested.find(block.key))
      block.value = suggested->value;
    else
      diagnostics.error(block.value.origin, fmt::format("the set `{}` suggests no `{}`; expected a block of your own",
                                                        set.name, block.key));
  }
}

/// The key `library` of a material, taken out of it; null where there is none.
std::unique_ptr<Entry> take_library_key(Node& material) {
  for (std::size_t i = 0; i < material.entries.size(); ++i)
    if (material.entries[i].key == "library") {
      auto taken = std::make_unique<Entry>(std::move(material.entries[i]));
      material.entries.erase(material.entries.begin() + static_cast<std::ptrdiff_t>(i));
      return taken;
    }
  return nullptr;
}

bool names_a_set(const Entry& material) { return material.value.is_map() && material.value.find("library"); }

/// The constants of a set belong to its density.
void warn_of_density(const MaterialSet& set, const Node& given, Diagnostics& diagnostics) {
  constexpr double much = 0.1;
  const Entry *ours = given.find("density"), *theirs = set.material.find("density");
  if (!ours || !theirs || !ours->value.is_scalar() || !theirs->value.is_scalar()) return;
  const Quantity own = to_si(ours->value.text, "kg/m3"), usual = to_si(theirs->value.text, "kg/m3");
  if (!own.ok() || !usual.ok() || std::fabs(own.value / usual.value - 1.0) <= much) return;
  diagnostics.warning(ours->value.origin,
                      fmt::format("the density of {} is not that of the set `{}`, {}, to which its other constants "
                                  "belong; leave it out, or give all of them",
                                  quantity_text(own.value, "kg/m3"), set.name, quantity_text(usual.value, "kg/m3")));
}

void warn_of(const MaterialSet& set, const Entry& key, Diagnostics& diagnostics) {
  if (!set.verified)
    diagnostics.warning(key.value.origin,
                        fmt::format("the set `{}` of the material library is not verified: not all of its numbers were "
                                    "found in two independent sources (`kerf describe {}` shows them)",
                                    set.name, set.name));
}

/// The set that the key names; null, with an error, where there is none.
const MaterialSet* find_set(const Entry& key, const MaterialLibrary& library, Diagnostics& diagnostics) {
  if (names_a_parameter(key.value)) return nullptr;  // one without a value, which has been reported
  if (!key.value.is_scalar()) {
    diagnostics.error(
        key.value.is_nothing() ? key.key_origin : key.value.origin,
        fmt::format("`library` is {}; expected the name of a set (`kerf list library` shows all)", key.value.what()));
    return nullptr;
  }
  const MaterialSet* set = library.find(key.value.text);
  if (!set)
    diagnostics.error(key.value.origin, fmt::format("there is no set \"{}\" in the material library{}", key.value.text,
                                                    library.suggestion_for(key.value.text)));
  return set;
}

/// The folders that the key `library` at the top adds; the key itself stays for the binder.
void add_folders(const Node& root, const std::string& input_folder, std::vector<std::string>& folders) {
  const Entry* key = root.find("library");
  if (!key) return;
  const auto add = [&](const Node& node) {
    if (node.is_scalar()) folders.push_back((std::filesystem::path(input_folder) / node.text).string());
  };
  add(key->value);
  for (const Node& item : key->value.items) add(item);
}

}  // namespace

std::vector<LibraryUse> expand_library(Node& root, const std::string& input_folder, std::vector<std::string> folders,
                                       const FileReader& read, Diagnostics& diagnostics) {
  std::vector<LibraryUse> uses;
  Entry* materials = root.find("materials");
  if (!materials) return uses;
  std::vector<Entry>& all = materials->value.entries;
  if (std::none_of(all.begin(), all.end(), names_a_set)) return uses;
  add_folders(root, input_folder, folders);
  const MaterialLibrary library(folders, read, diagnostics);
  bool all_found = true;
  for (Entry& material : all) {
    if (!names_a_set(material)) continue;
    const std::unique_ptr<Entry> key = take_library_key(material.value);
    const MaterialSet* set = find_set(*key, library, diagnostics);
    if (!set) {
      all_found = false;
      continue;
    }
    warn_of(*set, *key, diagnostics);
    warn_of_density(*set, material.value, diagnostics);
    take_suggestions(material.value, *set, diagnostics);
    LibraryUse use{material.key, set->name, set->file, set->hash(), set->verified, {}};
    Node expanded = set->material;
    override_with(expanded, material.value, "", use.overridden);
    material.value = std::move(expanded);
    uses.push_back(std::move(use));
  }
  // Without its material the rest of the input would give rise to messages that lead astray.
  if (!all_found) diagnostics.throw_if_errors();
  return uses;
}

}  // namespace kerf
