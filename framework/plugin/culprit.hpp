// Which plugin library, and which function of it, the program is in: asked where nothing works any more but reading.
#pragma once

#include <string>
#include <vector>

#include "plugin/library_file.hpp"

namespace kerf {

/// What the stack tells, from its innermost call outwards. Texts live as long as the program.
struct Culprit {
  const char* library = nullptr;  // path of the innermost plugin library on the stack; null where there is none
  const char* function = nullptr;  // null where it is not known
  bool waits = false;  // MPI was called, and has not called a plugin: this rank waits for another one
};

/// Makes a library known to find_culprit(), under the name that the system's loader will be given.
void remember_library(const std::string& path, std::vector<LibraryFunction> functions);

/// To be called once before any signal: the first look at a stack loads a library of the system.
void prepare_to_find_culprits();

/// Safe in a handler of signals. `context` is the handler's third argument, or null.
Culprit find_culprit(void* context);

}  // namespace kerf
