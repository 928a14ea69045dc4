// The pages of the material library, from its files and from the declarations of the laws that they use.
#include "input/library_pages.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <filesystem>

#include "input/model_input.hpp"
#include "input/reference_writer.hpp"

namespace kerf {
namespace {

/// One number, text or list of a set.
struct Value {
  std::string path, text, meaning, source;
};

std::string text_of(const Node& node) {
  std::string text = yaml_text(node);
  while (!text.empty() && text.back() == '\n') text.pop_back();
  if (node.is_scalar()) return node.text;
  return text;
}

/// Lists the values of a block with what its description says about them.
class ValueLister {
 public:
  ValueLister(const MaterialSet& set, const Registry& registry) : set_(set), registry_(registry) {}

  std::vector<Value> list(const Node& block) {
    values_.clear();
    static const Description of_material = Schema<MaterialInput>::described<MaterialInput>();
    add(block, of_material, "");
    return values_;
  }

 private:
  void add(const Node& block, const Description& description, const std::string& path) {
    for (const Entry& entry : block.entries) {
      const auto p = std::find_if(description.parameters.begin(), description.parameters.end(),
                                  [&](const Parameter& each) { return each.name == entry.key; });
      const bool known = p != description.parameters.end();
      add_value(entry.value, known ? &*p : nullptr, path.empty() ? entry.key : path + "." + entry.key);
    }
  }
  void add_value(const Node& node, const Parameter* p, const std::string& path) {
    if (p && node.is_map() && !p->plugin_kind.empty()) return add_plugin(node, p->plugin_kind, path);
    if (p && node.is_map() && p->nested) return add(node, p->nested(), path);
    if (p && node.is_list() && !p->plugin_kind.empty()) {
      for (std::size_t i = 0; i < node.items.size(); ++i)
        add_plugin(node.items[i], p->plugin_kind, fmt::format("{}[{}]", path, i));
      return;
    }
    values_.push_back({path, text_of(node), p ? p->doc : "", set_.source_of(path)});
  }
  void add_plugin(const Node& node, const std::string& kind, const std::string& path) {
    const Entry* type = node.find("type");
    const Description* law = type ? registry_.find(kind, type->value.text) : nullptr;
    static const Description unknown;
    if (type) values_.push_back({path, type->value.text, law ? law->summary : "", ""});
    Node rest = node;
    std::erase_if(rest.entries, [](const Entry& e) { return e.key == "type"; });
    add(rest, law ? *law : unknown, path);
  }

  const MaterialSet& set_;
  const Registry& registry_;
  std::vector<Value> values_;
};

/// "johnson_cook + mie_gruneisen".
std::string laws_of(const MaterialSet& set) {
  std::string laws;
  for (const Entry& entry : set.material.entries)
    if (const Entry* type = entry.value.find("type")) laws += (laws.empty() ? "" : " + ") + type->value.text;
  return laws;
}

/// "[1]" of "[1] from the paper"; empty where a source has no such tag.
std::string tag_of(const std::string& source) {
  const std::size_t end = source.empty() || source[0] != '[' ? std::string::npos : source.find(']');
  return end == std::string::npos ? "" : source.substr(0, end + 1);
}

std::string verdict(const MaterialSet& set) { return set.verified ? "verified" : "not verified"; }

// A bar would end a table cell.
std::string cell(std::string text) {
  for (std::size_t at = 0; (at = text.find('|', at)) != std::string::npos; at += 2) text.insert(at, "\\");
  return text;
}

/// What an input has to hold to use the set.
std::string use_of(const MaterialSet& set) {
  std::string text = "materials:\n  NAME:\n    library: " + set.name + "\n";
  if (set.to_give.is_map()) text += yaml_text(set.to_give, 4);
  for (const Entry& block : set.suggested.entries) text += "    " + block.key + ": suggested\n";
  return text;
}

std::string table_of_sets(const MaterialLibrary& library, const std::string& page_of_set) {
  std::string text = "| set | laws | verified | what |\n|---|---|---|---|\n";
  for (const MaterialSet& set : library.sets()) {
    const std::string page = std::filesystem::path(set.file).stem().string() + ".md#" + set.name;
    text += fmt::format("| [{}]({}{}) | {} | {} | {} |\n", set.name, page_of_set, page, laws_of(set),
                        set.verified ? "yes" : "no", cell(set.description));
  }
  return text;
}

std::string values_markdown(const std::vector<Value>& values) {
  std::string text = "| key | value | source | meaning |\n|---|---|---|---|\n";
  for (const Value& v : values)
    text += fmt::format("| `{}` | {} | {} | {} |\n", v.path, cell(v.text), tag_of(v.source), cell(v.meaning));
  return text + "\n";
}

}  // namespace

std::string library_text(const MaterialLibrary& library) {
  std::size_t name_width = 0, laws_width = 0;
  for (const MaterialSet& set : library.sets()) {
    name_width = std::max(name_width, set.name.size());
    laws_width = std::max(laws_width, laws_of(set).size());
  }
  std::string text, family;
  for (const MaterialSet& set : library.sets()) {
    if (set.family != family) text += (text.empty() ? "" : "\n") + set.family + "\n";
    family = set.family;
    text += fmt::format("  {:<{}}  {:<{}}  {:<12}  {}\n", set.name, name_width, laws_of(set), laws_width, verdict(set),
                        set.description);
  }
  return text;
}

std::string set_text(const MaterialSet& set, const Registry& registry) {
  std::string text = fmt::format("{} (material set, {}): {}\nwritten in {}, hash {}\ncitation: {}\n", set.name,
                                 verdict(set), set.description, set.origin.text(), set.hash(), set.citation);
  if (!set.notes.empty()) text += "notes: " + set.notes + "\n";
  ValueLister lister(set, registry);
  const auto add = [&](const char* title, const Node& block) {
    if (!block.is_map()) return;
    const std::vector<Value> values = lister.list(block);
    std::size_t path_width = 0, text_width = 0;
    for (const Value& v : values) {
      path_width = std::max(path_width, v.path.size());
      text_width = std::max(text_width, v.text.size());
    }
    text += fmt::format("\n{}\n", title);
    for (const Value& v : values)
      text += fmt::format("  {:<{}}  {:<{}}  {:<3}  {}\n", v.path, path_width, v.text, text_width, tag_of(v.source),
                          v.meaning);
  };
  add("numbers", set.material);
  add("suggested, where the input asks for it", set.suggested);
  text += "\nsources ([2] two independent ones, [1] one, [M] memory of the paper, [C] computed or chosen)\n";
  for (const auto& [path, source] : set.provenance) text += fmt::format("  {}: {}\n", path, source);
  return text + "\nto use it\n\n" + use_of(set);
}

std::string set_markdown(const MaterialSet& set, const Registry& registry) {
  std::string text = fmt::format("## {}\n\n{}; {}. Hash of the numbers `{}`.\n\n{}.\n\n", set.name, set.description,
                                 set.verified ? "verified" : "**not verified**", set.hash(), set.citation);
  if (!set.notes.empty()) text += set.notes + "\n\n";
  text += "```yaml\n" + use_of(set) + "```\n\n";
  ValueLister lister(set, registry);
  text += values_markdown(lister.list(set.material));
  if (set.suggested.is_map()) text += "Suggested:\n\n" + values_markdown(lister.list(set.suggested));
  for (const auto& [path, source] : set.provenance) text += fmt::format("- `{}`: {}\n", path, source);
  return text;
}

void write_library_reference(const MaterialLibrary& library, const Registry& registry, const std::string& folder) {
  const std::filesystem::path root = std::filesystem::path(folder) / "library";
  std::string index = fmt::format(
      "# Material library\n\nSets of constants that an input names as `library: NAME`. How to use them, and what the "
      "marks "
      "of sources mean: [users/library.md](../../users/library.md). Generated from the files in physics/library by "
      "`kerf reference`; on the terminal, `kerf list library` and `kerf describe NAME` show the same.\n\n{}",
      table_of_sets(library, ""));
  std::string page, file;
  const auto finish = [&] {
    if (!file.empty()) write_page((root / (std::filesystem::path(file).stem().string() + ".md")).string(), page);
  };
  for (const MaterialSet& set : library.sets()) {
    if (set.file != file) {
      finish();
      file = set.file;
      page = fmt::format(
          "# {}\n\nFrom physics/library/{}. Marks of sources: [2] found in two independent ones, [1] in "
          "one, [M] from memory of the paper, [C] computed or chosen.\n",
          set.family, set.file_name());
    }
    page += "\n" + set_markdown(set, registry);
  }
  finish();
  write_page((root / "README.md").string(), index);
}

}  // namespace kerf
