// The commands that show what can stand in an input: list, describe, schema, reference.
#include <fmt/format.h>

#include <cstdio>
#include <filesystem>

#include "app/commands.hpp"
#include "core/diagnostics.hpp"
#include "drive/drive_input.hpp"
#include "input/json_schema.hpp"
#include "input/library.hpp"
#include "input/library_pages.hpp"
#include "input/parameter_text.hpp"
#include "input/reference_writer.hpp"
#include "lowering/handled_fields.hpp"
#include "report/output_reference.hpp"

namespace kerf {
namespace {

void print(const std::string& text) { std::fwrite(text.data(), 1, text.size(), stdout); }

int refuse(const std::string& message) {
  fmt::print(stderr, "error: {}\n", message);
  return exit_other;
}

bool is_kind(const Registry& registry, const std::string& kind) { return !registry.names(kind).empty(); }

/// Throws InputError where a file is wrong.
MaterialLibrary read_library(const std::vector<std::string>& folders = library_folders()) {
  Diagnostics diagnostics;
  MaterialLibrary library(folders, read_text_file, diagnostics);
  diagnostics.throw_if_errors();
  return library;
}

/// Without the folders of a user's own, which no reference manual of Kerf describes.
MaterialLibrary read_library_of_kerf() { return read_library({library_folders().front()}); }

int describe_set(const Registry& registry, const MaterialLibrary& library, const std::string& name, bool markdown) {
  const MaterialSet* set = library.find(name);
  if (!set)
    return refuse(fmt::format("there is no set \"{}\" in the material library{}", name, library.suggestion_for(name)));
  print(markdown ? set_markdown(*set, registry) : set_text(*set, registry));
  return exit_done;
}

}  // namespace

int list_command(const Registry& registry, const std::string& kind) {
  if (kind == "library") {
    print(library_text(read_library()));
    return exit_done;
  }
  if (!kind.empty() && !is_kind(registry, kind))
    return refuse(fmt::format("there is no kind \"{}\"{}", kind, suggestion(kind, registry.kinds(), "the kinds")));
  print(list_text(registry, kind));
  return exit_done;
}

int describe_command(const Registry& registry, const std::vector<std::string>& names, bool markdown) {
  const auto show = [&](const Description& d) {
    print(markdown ? describe_markdown(d) : describe_text(d));
    return exit_done;
  };
  const std::string& name = names.back();
  if (names.size() == 2 && names.front() == "library") return describe_set(registry, read_library(), name, markdown);
  if (names.size() == 1 && name == "input") return show(input_description());
  if (names.size() == 1 && name == "drive") return show(drive_description());
  std::vector<const Description*> found;
  std::vector<std::string> all = {"input", "drive"}, homonyms;
  for (const std::string& kind : registry.kinds()) {
    if (names.size() == 2 && kind != names.front()) continue;
    for (const std::string& candidate : registry.names(kind)) all.push_back(candidate);
    if (const Description* d = registry.find(kind, name)) {
      found.push_back(d);
      homonyms.push_back(fmt::format("`kerf describe {} {}`", kind, name));
    }
  }
  if (names.size() == 2 && !is_kind(registry, names.front()))
    return refuse(fmt::format("there is no kind \"{}\"{}", names.front(),
                              suggestion(names.front(), registry.kinds(), "the kinds")));
  if (found.empty() && names.size() == 1 && is_kind(registry, name))
    return refuse(fmt::format("\"{}\" is a kind, not a name; `kerf list {}` shows its names", name, name));
  if (found.empty() && names.size() == 1) {
    const MaterialLibrary library = read_library();
    if (library.find(name)) return describe_set(registry, library, name, markdown);
    for (const std::string& set : library.names()) all.push_back(set);
  }
  if (found.empty()) {
    const std::string near = nearest_name(name, all);
    return refuse(fmt::format(
        "nothing is called \"{}\"; {}", name,
        near.empty() ? "`kerf list` and `kerf list library` show all names" : "did you mean `" + near + "`?"));
  }
  if (found.size() > 1)
    return refuse(fmt::format("\"{}\" is the name of several; say {}", name, listed(homonyms, " or ")));
  return show(*found.front());
}

int schema_command(const Registry& registry) {
  print(json_schema(registry));
  return exit_done;
}

int reference_command(const Registry& registry, const std::string& folder) {
  write_reference(registry, folder, output_reference(), describe_markdown(drive_description()));
  write_library_reference(read_library_of_kerf(), registry, folder);
  write_page((std::filesystem::path(folder) / "decks.md").string(), lowering::rules_page());
  return exit_done;
}

}  // namespace kerf
