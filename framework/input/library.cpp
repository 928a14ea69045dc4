// Reads the files of the material library.
#include "input/library.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cstdlib>
#include <filesystem>
#include <sstream>

#include "core/shared_folder.hpp"
#include "input/parameter_text.hpp"
#include "input/yaml_reader.hpp"

namespace kerf {
namespace {

const std::vector<std::string> keys_of_a_set = {"description", "citation",  "verified", "notes",
                                                "material",    "suggested", "to_give",  "provenance"};

/// Fills one set from its block and reports what does not fit.
class SetReader {
 public:
  SetReader(const Entry& entry, Diagnostics& diagnostics) : entry_(entry), diagnostics_(diagnostics) {}

  MaterialSet read(const std::string& family, const std::string& path) {
    set_.name = entry_.key;
    set_.family = family;
    set_.file = path;
    set_.origin = entry_.key_origin;
    if (!entry_.value.is_map()) {
      error(entry_.value.origin,
            fmt::format("`{}` is {}; expected a map with the key `material`", entry_.key, entry_.value.what()));
      return set_;
    }
    for (const Entry& e : entry_.value.entries)
      if (std::find(keys_of_a_set.begin(), keys_of_a_set.end(), e.key) == keys_of_a_set.end())
        error(e.key_origin, fmt::format("unknown key `{}`{}", e.key, suggestion(e.key, keys_of_a_set, "valid keys")));
    set_.description = text("description", true);
    set_.citation = text("citation", true);
    set_.notes = text("notes", false);
    set_.verified = read_verified();
    set_.material = map("material", true);
    set_.suggested = map("suggested", false);
    set_.to_give = map("to_give", false);
    read_provenance();
    return set_;
  }

 private:
  void error(const Origin& where, const std::string& message) { diagnostics_.error(where, message); }

  const Entry* find(const std::string& key, bool required, const char* expected) {
    const Entry* e = entry_.value.find(key);
    if (!e && required)
      error(entry_.key_origin, fmt::format("the set `{}` has no key `{}`; expected {}", entry_.key, key, expected));
    return e;
  }
  std::string text(const std::string& key, bool required) {
    const Entry* e = find(key, required, "a text");
    if (!e) return {};
    if (!e->value.is_scalar()) error(e->value.origin, fmt::format("`{}` is {}; expected a text", key, e->value.what()));
    return e->value.text;
  }
  bool read_verified() {
    const Entry* e = find("verified", true, "yes or no");
    if (e && e->value.text != "yes" && e->value.text != "no")
      error(e->value.origin, fmt::format("`verified` is {}; expected yes or no", e->value.what()));
    return e && e->value.text == "yes";
  }
  Node map(const std::string& key, bool required) {
    const Entry* e = find(key, required, "a map with the blocks of a material");
    if (!e) return {};
    if (!e->value.is_map())
      error(e->value.origin,
            fmt::format("`{}` is {}; expected a map with the blocks of a material", key, e->value.what()));
    return e->value;
  }
  void read_provenance() {
    const Entry* e = find("provenance", true, "a map from keys of the material to the sources of their numbers");
    if (!e) return;
    if (!e->value.is_map())
      error(e->value.origin, fmt::format("`provenance` is {}; expected a map from keys of the material, such as "
                                         "strength or strength.C, to texts",
                                         e->value.what()));
    for (const Entry& source : e->value.entries) {
      if (!source.value.is_scalar())
        error(source.value.origin, fmt::format("`{}` is {}; expected a text", source.key, source.value.what()));
      else if (!has_path(source.key))
        error(source.key_origin,
              fmt::format("`{}` is no key of this set; expected a path such as strength.C", source.key));
      set_.provenance.emplace_back(source.key, source.value.text);
    }
  }
  bool has_path(const std::string& path) const {
    for (const Node* node : {&set_.material, &set_.suggested}) {
      std::istringstream keys(path);
      const Node* at = node;
      for (std::string key; at && std::getline(keys, key, '.');) {
        const Entry* e = at->find(key);
        at = e ? &e->value : nullptr;
      }
      if (at) return true;
    }
    return false;
  }

  const Entry& entry_;
  Diagnostics& diagnostics_;
  MaterialSet set_;
};

/// Words of a name: "copper_ofhc" has two.
std::vector<std::string> words_of(const std::string& name) {
  std::vector<std::string> words(1);
  for (const char c : name)
    if (c == '_')
      words.emplace_back();
    else
      words.back() += c;
  return words;
}

int n_common_words(const std::string& a, const std::string& b) {
  int n = 0;
  const std::vector<std::string> of_b = words_of(b);
  for (const std::string& word : words_of(a))
    if (word.size() > 1 && std::find(of_b.begin(), of_b.end(), word) != of_b.end()) ++n;
  return n;
}

}  // namespace

std::string MaterialSet::hash() const {
  Digest digest;
  digest.add(material);
  digest.add(suggested);
  return fmt::format("{:016x}", digest.value());
}

std::string MaterialSet::source_of(std::string path) const {
  while (!path.empty()) {
    for (const auto& [of, text] : provenance)
      if (of == path) return text;
    const std::size_t cut = path.find_last_of(".[");
    path.resize(cut == std::string::npos ? 0 : cut);
  }
  return {};
}

std::string MaterialSet::file_name() const { return std::filesystem::path(file).filename().string(); }

MaterialLibrary::MaterialLibrary(const std::vector<std::string>& folders, const FileReader& read,
                                 Diagnostics& diagnostics) {
  for (const std::string& folder : folders) {
    const std::string path = folder + "/";
    std::string failure;
    const std::string listing = read(path, failure);
    if (!failure.empty()) {
      diagnostics.error(folder, "the folder of a material library cannot be read: " + failure);
      continue;
    }
    std::istringstream names(listing);
    for (std::string name; std::getline(names, name);) {
      const std::string text = read(path + name, failure);
      if (!failure.empty())
        diagnostics.error(path + name, "this file of a material library cannot be read: " + failure);
      else
        read_file(path + name, text, diagnostics);
      failure.clear();
    }
  }
}

void MaterialLibrary::read_file(const std::string& path, const std::string& text, Diagnostics& diagnostics) {
  const std::optional<Node> root = read_yaml(path, text, diagnostics);
  if (!root) return;
  if (!root->is_map()) {
    diagnostics.error(path, "the file of a material library holds " + root->what() + "; expected a map of sets");
    return;
  }
  std::string family = std::filesystem::path(path).stem().string();
  for (const Entry& entry : root->entries) {
    if (entry.key == "family") {
      family = entry.value.text;
      continue;
    }
    if (const MaterialSet* first = find(entry.key)) {
      diagnostics.error(entry.key_origin, fmt::format("the set `{}` is there already, at {}; expected another name",
                                                      entry.key, first->origin.text()));
      continue;
    }
    sets_.push_back(SetReader(entry, diagnostics).read(family, path));
  }
}

const MaterialSet* MaterialLibrary::find(const std::string& name) const {
  for (const MaterialSet& set : sets_)
    if (set.name == name) return &set;
  return nullptr;
}

std::vector<std::string> MaterialLibrary::names() const {
  std::vector<std::string> all;
  for (const MaterialSet& set : sets_) all.push_back(set.name);
  return all;
}

std::string MaterialLibrary::suggestion_for(const std::string& name) const {
  constexpr std::size_t most = 4;
  std::vector<std::string> near = {nearest_name(name, names())};
  if (near.front().empty()) {  // then those that have most words in common with it
    near = names();
    std::erase_if(near, [&](const std::string& other) { return n_common_words(name, other) == 0; });
    std::stable_sort(near.begin(), near.end(), [&](const std::string& a, const std::string& b) {
      return n_common_words(name, a) > n_common_words(name, b);
    });
    near.resize(std::min(near.size(), most));
  }
  if (near.empty()) return "; `kerf list library` shows all";
  for (std::string& one : near) one = "`" + one + "`";
  return "; did you mean " + listed(near, " or ") + "? (`kerf list library` shows all)";
}

std::vector<std::string> library_folders() {
  std::vector<std::string> folders = {shared_folder("share/kerf/library", KERF_LIBRARY_OF_SOURCES)};
  if (const char* own = std::getenv("KERF_LIBRARY")) {
    std::istringstream list(own);
    for (std::string folder; std::getline(list, folder, ':');)
      if (!folder.empty()) folders.push_back(folder);
  }
  return folders;
}

}  // namespace kerf
