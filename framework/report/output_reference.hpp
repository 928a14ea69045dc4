// The page of the manual about what is written, made from the tables that the writers use.
#pragma once

#include <string>

namespace kerf {

/// Lines of the books, fields and timers, as Markdown.
std::string output_reference();

}  // namespace kerf
