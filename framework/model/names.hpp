// What the user calls an element or a node: by the number of its file, or by that of the model where a mesh is
// generated.
//
// Nothing is stored with elements and nodes: their mesh generators know the numbers, whoever owns them.
#pragma once

#include <cstdint>
#include <string>

namespace kerf {

struct Model;

/// Whether the mesh of any part brings numbers of its own.
bool has_labels(const Model& model);

/// The number that the user knows an element by, from its id. Local; the same on all ranks.
std::int64_t element_label(const Model& model, std::int64_t id);
/// The same of a node. One that parts share has the number that the first of them gives it.
std::int64_t node_label(const Model& model, std::int64_t id);

/// "element 17 of part rod". Local; the same on all ranks.
std::string element_name(const Model& model, std::int64_t id);
/// "node 17 of part rod".
std::string node_name(const Model& model, std::int64_t id);

}  // namespace kerf
