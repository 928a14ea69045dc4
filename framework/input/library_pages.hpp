// Shows the sets of the material library: for the terminal and as Markdown.
#pragma once

#include <string>

#include "input/library.hpp"
#include "plugin/registry.hpp"

namespace kerf {

/// Name, laws, whether it is verified, and one line about each set.
std::string library_text(const MaterialLibrary& library);

/// Every number of a set with its unit, meaning and source.
std::string set_text(const MaterialSet& set, const Registry& registry);
std::string set_markdown(const MaterialSet& set, const Registry& registry);

/// Writes library/README.md (a table of all sets) and library/FILE.md, one page per family, below `folder`.
void write_library_reference(const MaterialLibrary& library, const Registry& registry, const std::string& folder);

}  // namespace kerf
