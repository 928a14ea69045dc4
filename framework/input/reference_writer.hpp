// Writes the reference manual from what the types declare: for the terminal and as Markdown.
#pragma once

#include <string>

#include "kerf/schema.hpp"
#include "plugin/registry.hpp"

namespace kerf {

/// A table of the names and summaries of one kind, or of all kinds where `kind` is empty.
std::string list_text(const Registry& registry, const std::string& kind);

/// Everything that a plugin, or a block with all blocks inside it, takes and keeps.
std::string describe_text(const Description& description);
std::string describe_markdown(const Description& description);

/// Writes a page, in a folder that is made if need be. Throws std::runtime_error where that fails.
void write_page(const std::string& path, const std::string& text);

/// What stands at the top of an input file: the declaration of ModelInput.
const Description& input_description();

/// Writes input.md, drive.md, output.md, README.md (the index) and KIND/NAME.md below `folder`, which is made if need
/// be. Throws std::runtime_error where a file cannot be written.
void write_reference(const Registry& registry, const std::string& folder, const std::string& output_page,
                     const std::string& drive_page);

}  // namespace kerf
