// From the text of an input file to a checked model.
#pragma once

#include <memory>
#include <string>
#include <vector>

#include "core/diagnostics.hpp"
#include "input/curve_table.hpp"
#include "input/document.hpp"
#include "input/files_of_input.hpp"
#include "input/library.hpp"
#include "input/model_input.hpp"
#include "plugin/registry.hpp"

namespace kerf {

/// Reads an input text, after the overrides "key.path=value", into a model. All mistakes go to `diagnostics`, and
/// the model holds what could be read: members whose text was wrong are null. `read` gets the files that the text
/// names, always the same ones in the same order; sets of materials are looked for in the folders `library`. Throws
/// InputError where the text is not YAML at all, or names a set of materials that does not exist.
std::unique_ptr<ModelInput> read_model_input(const std::string& file_name, const std::string& bytes,
                                             const std::vector<std::string>& overrides, const Registry& registry,
                                             Diagnostics& diagnostics, OriginMap& origins,
                                             const FileReader& read = read_text_file,
                                             const std::vector<std::string>& library = library_folders());

/// The same for a document that another reader has made, whose meshes are in `meshes` already.
std::unique_ptr<ModelInput> read_model_document(const std::string& file_name, Node root, MeshCache meshes,
                                                const std::vector<std::string>& overrides, const Registry& registry,
                                                Diagnostics& diagnostics, OriginMap& origins, const FileReader& read,
                                                const std::vector<std::string>& library);

/// Checks what no single block can know: names that refer to one another, faces, variables that laws read from one
/// another. Prepares the mesh generators. May be called on a model with errors, to find all of them at once.
/// Post: where `diagnostics` holds no error, every required member of the model is there.
void validate(const ModelInput& model, const OriginMap& origins, Diagnostics& diagnostics);

}  // namespace kerf
