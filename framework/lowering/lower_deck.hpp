// From a keyword deck to the document and the mesh that the rest of Kerf reads.
#pragma once

#include <memory>
#include <string>

#include "input/document.hpp"
#include "kerf/file_mesh.hpp"
#include "lowering/deck_report.hpp"
#include "lowering/lowering.hpp"

namespace kerf::lowering {

struct LoweredDeck {
  Node document;
  std::shared_ptr<FileMesh> mesh;  // in the deck's unit of length
  std::string mesh_name;  // what the document calls the file of the mesh
  DeckReport report;
};

/// Whether a file is a keyword deck: by the ending of its name (.k, .key, .dyn, .kwd), or, where the ending is not of
/// another format, by a keyword in its first line that is no comment.
bool is_deck(const std::string& path, const std::string& bytes);

/// Reads a deck and everything that it includes. Mistakes, and what cannot be run, go to `diagnostics`; the document is
/// whole where it has no errors. Local.
LoweredDeck lower_deck(const std::string& path, LoweringOptions options, Diagnostics& diagnostics);

}  // namespace kerf::lowering
