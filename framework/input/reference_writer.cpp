// The reference manual, generated from descriptions.
#include "input/reference_writer.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <filesystem>
#include <fstream>
#include <stdexcept>

#include "input/model_input.hpp"
#include "input/parameter_text.hpp"
#include "kerf/measure.hpp"
#include "plugin/kinds.hpp"

namespace kerf {
namespace {

bool has_unit(const std::string& unit) { return !unit.empty() && unit != "-"; }

bool is_block(const Parameter& p) { return static_cast<bool>(p.nested); }

// "number in Pa, greater than 0 Pa, required".
std::string facts(const Parameter& p) {
  std::string text = kind_text(p);
  if (has_unit(p.unit)) text += " in " + p.unit;
  const std::string range = range_text(p.range, p.unit);
  if (!range.empty()) text += ", " + range;
  if (p.required) return text + ", required";
  if (p.default_text.empty() || p.default_text == "{}") return text + ", optional";
  return text + ", by default " + p.default_text;
}

void add_parameters(std::string& text, const Description& d, const std::string& indent) {
  for (const Parameter& p : d.parameters) {
    text += fmt::format("{}{}: {}\n{}    {}\n", indent, p.name, facts(p), indent, p.doc);
    if (is_block(p)) add_parameters(text, p.nested(), indent + "    ");
  }
  for (const Rule& rule : d.rules) text += fmt::format("{}rule for {}: {}\n", indent, rule.key, rule.message);
}

// A bar would end a table cell.
std::string cell(std::string text) {
  for (std::size_t at = 0; (at = text.find('|', at)) != std::string::npos; at += 2) text.insert(at, "\\");
  return text;
}

std::string default_cell(const Parameter& p) {
  if (p.required) return "required";
  return p.default_text.empty() || p.default_text == "{}" ? "none" : "`" + cell(p.default_text) + "`";
}

std::string kind_cell(const Parameter& p) {
  if (p.plugin_kind.empty()) return cell(kind_text(p));
  return p.kind == ValueKind::plugin ? "a type of " + p.plugin_kind : kind_text(p);
}

void add_table(std::string& text, const Description& d, int level, const std::string& path) {
  if (!d.parameters.empty()) {
    text += "| key | takes | unit | default | allowed | meaning |\n|---|---|---|---|---|---|\n";
    for (const Parameter& p : d.parameters)
      text += fmt::format("| `{}` | {} | {} | {} | {} | {} |\n", p.name, kind_cell(p), has_unit(p.unit) ? p.unit : "",
                          default_cell(p), cell(range_text(p.range, p.unit)), cell(p.doc));
    text += "\n";
  }
  for (const Rule& rule : d.rules) text += fmt::format("- Rule for `{}`: {}.\n", rule.key, rule.message);
  if (!d.rules.empty()) text += "\n";
  for (const Parameter& p : d.parameters) {
    if (!is_block(p)) continue;
    const bool by_name = p.kind == ValueKind::block_map, in_list = p.kind == ValueKind::block_list;
    const std::string inner = path + p.name + (by_name ? ".NAME" : in_list ? "[i]" : "");
    text += fmt::format("{} `{}`\n\n{}.\n\n", std::string(static_cast<std::size_t>(level), '#'), inner, p.doc);
    add_table(text, p.nested(), std::min(level + 1, 6), inner + ".");
  }
}

/// How a variable that a law reads is called, between `quotes`.
std::string read_name(const ReadVariable& v, const char* quotes) {
  return v.name_of ? "named by the input" : quotes + v.name + quotes;
}
std::string absent_text(const ReadVariable& v) {
  return v.is_optional ? fmt::format("; {} where no law declares it", v.value) : "";
}

// What a user has to write at least.
std::string skeleton(const Description& d) {
  std::string text = "type: " + d.name + "\n";
  for (const Parameter& p : d.parameters)
    if (p.required) text += fmt::format("{}:  # {}\n", p.name, expectation(p));
  return text;
}

/// The theory page of a kind, empty where each type has a page of its own name.
std::string theory_page(const std::string& kind) {
  for (const PluginKind& k : plugin_kinds)
    if (kind == k.name && k.theory_page) return k.theory_page;
  return {};
}

bool has_section(const std::filesystem::path& page, const std::string& name) {
  std::ifstream file(page);
  for (std::string line; std::getline(file, line);)
    if (line == "## `" + name + "`") return true;
  return false;
}

// Where the equations of a type stand. Only what is there is linked: types of outside plugins have no page, and a
// reference that is written to another place has no theory beside it.
std::string theory_link(const std::filesystem::path& root, const Description& d) {
  const std::filesystem::path theory = root / ".." / "theory";
  std::string page = d.name;
  if (!std::filesystem::exists(theory / (page + ".md"))) page = theory_page(d.kind);
  if (page.empty() || !std::filesystem::exists(theory / (page + ".md"))) return {};
  const std::string section = has_section(theory / (page + ".md"), d.name) ? "#" + d.name : "";
  return fmt::format("\nEquations and sources: [theory/{0}](../../theory/{0}.md{1}).\n", page, section);
}

}  // namespace

const Description& input_description() {
  static const Description described = [] {
    Description d = Schema<ModelInput>::described<ModelInput>();
    d.name = "input";
    d.summary = "the whole input file";
    return d;
  }();
  return described;
}

std::string list_text(const Registry& registry, const std::string& kind) {
  std::string text;
  for (const std::string& k : registry.kinds()) {
    if (!kind.empty() && k != kind) continue;
    std::size_t width = 0;
    for (const std::string& name : registry.names(k)) width = std::max(width, name.size());
    text += (text.empty() ? "" : "\n") + k + "\n";
    for (const std::string& name : registry.names(k))
      text += fmt::format("  {:<{}}  {}\n", name, width, registry.find(k, name)->summary);
  }
  return text;
}

std::string describe_text(const Description& d) {
  const bool is_plugin = d.kind != "block";
  std::string text =
      is_plugin ? fmt::format("{} ({}): {}\n", d.name, d.kind, d.summary) : fmt::format("{}: {}\n", d.name, d.summary);
  if (!d.origin.empty()) text += "declared in " + d.origin + "\n";
  text += d.parameters.empty() ? "\nIt takes no parameters.\n" : "\nparameters\n";
  add_parameters(text, d, "  ");
  if (!d.state.empty()) text += "\nstate variables, kept for every point\n";
  for (const StateVariable& v : d.state)
    text += fmt::format("  {}: {}, at first {}\n      {}\n", v.name, has_unit(v.unit) ? "in " + v.unit : "without unit",
                        v.initial, v.doc);
  if (!d.reads.empty()) text += "\nreads state variables of other laws of the same material\n";
  for (const ReadVariable& v : d.reads) text += fmt::format("  {}: {}{}\n", read_name(v, ""), v.doc, absent_text(v));
  return text;
}

std::string describe_markdown(const Description& d) {
  const bool is_plugin = d.kind != "block";
  std::string text = fmt::format("# {}{}\n\n{}.\n\n", d.name, is_plugin ? " (" + d.kind + ")" : "", d.summary);
  if (is_plugin) text += "```yaml\n" + skeleton(d) + "```\n\n## Parameters\n\n";
  if (d.parameters.empty()) text += "It takes no parameters.\n\n";
  add_table(text, d, is_plugin ? 3 : 2, "");
  if (!d.state.empty()) text += "## State variables\n\n| name | unit | initial | meaning |\n|---|---|---|---|\n";
  for (const StateVariable& v : d.state)
    text += fmt::format("| `{}` | {} | {} | {} |\n", v.name, has_unit(v.unit) ? v.unit : "", v.initial, cell(v.doc));
  if (!d.state.empty()) text += "\n";
  if (!d.reads.empty())
    text +=
        "## Reads\n\nState variables that one other law of the same material must declare, unless a value is "
        "given.\n\n";
  for (const ReadVariable& v : d.reads) text += fmt::format("- {}: {}{}\n", read_name(v, "`"), v.doc, absent_text(v));
  while (text.size() > 1 && text[text.size() - 2] == '\n') text.pop_back();
  return text;
}

void write_page(const std::string& name, const std::string& text) {
  const std::filesystem::path path(name);
  std::filesystem::create_directories(path.parent_path());
  std::ofstream file(path);
  file << text;
  file.close();
  if (!file) throw std::runtime_error("cannot write " + path.string());
}

void write_reference(const Registry& registry, const std::string& folder, const std::string& output_page,
                     const std::string& drive_page) {
  const std::filesystem::path root = std::filesystem::absolute(folder).lexically_normal();
  std::string index =
      "# Reference\n\nEverything that an input file can name, one page per type: what it takes, units, defaults, "
      "allowed "
      "values, and the state variables it keeps. Generated from the declarations in the code by `kerf reference`; "
      "changes belong there. On the terminal, `kerf list` and `kerf describe NAME` show the same.\n\n"
      "- [input](input.md): the whole input file\n"
      "- [drive](drive.md): the whole file of `kerf drive`\n"
      "- [decks](decks.md): keywords and fields of keyword decks\n"
      "- [output](output.md): columns, keys, fields and timers that are written\n"
      "- [library](library/README.md): sets of constants of named materials\n";
  write_page((root / "input.md").string(), describe_markdown(input_description()));
  write_page((root / "drive.md").string(), drive_page);
  write_page((root / "output.md").string(), output_page);
  for (const std::string& kind : registry.kinds()) {
    index += fmt::format("\n## {}\n\n", kind);
    for (const std::string& name : registry.names(kind)) {
      const Description& d = *registry.find(kind, name);
      index += fmt::format("- [{}]({}/{}.md): {}\n", name, kind, name, d.summary);
      write_page((root / kind / (name + ".md")).string(), describe_markdown(d) + theory_link(root, d));
    }
  }
  write_page((root / "README.md").string(), index);
}

}  // namespace kerf
