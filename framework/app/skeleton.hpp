// The C++ source of a law that was tried in Python, with the same declarations and an empty body.
#pragma once

#include <map>
#include <string>

#include "plugin/registry.hpp"

namespace kerf {

/// What becomes of a prototype in the folder of a plugin, by place in the folder.
struct Skeleton {
  std::string source, page, samples;
};

/// The law `kind` of the Python file, under the name `name`: of several laws of the kind the one that has this name.
/// `type` is its name in C++, `python` the text of the file. Throws std::runtime_error where there is none.
Skeleton skeleton_of(const Registry& laws, const std::string& kind, const std::string& name, const std::string& type,
                     const std::string& python);

}  // namespace kerf
