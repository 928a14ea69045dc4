// A mesh without a model as the beginning of an input: its parts and its sets.
#pragma once

#include <string>

#include "core/diagnostics.hpp"
#include "input/document.hpp"
#include "kerf/file_mesh.hpp"

namespace kerf::lowering {

/// The unit of length of --units, which may be one alone: "mm", or "kg,mm,ms". An error where there is none.
std::string length_of(const std::string& units, Diagnostics& diagnostics);

/// Parts for the blocks of a mesh, with a material of the same name, and sets for the ones of the file.
Node document_of_mesh(const FileMesh& mesh, const std::string& mesh_name, const std::string& unit);

}  // namespace kerf::lowering
