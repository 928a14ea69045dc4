// The mesh of a deck: nodes, solids, parts and sets, as a FileMesh, with the places where they stand.
#pragma once

#include <array>
#include <cstdint>
#include <string>
#include <vector>

#include "decks/deck.hpp"
#include "kerf/file_mesh.hpp"

namespace kerf::decks {

enum class SolidShape : std::uint8_t { hex8, wedge6, pyramid5, tet4, tet10 };

/// A part of the deck: what *PART says, or a number that solids name where the deck has no *PART at all.
struct DeckPart {
  std::int64_t id = 0;  // as the whole deck calls it
  std::string title;
  std::int64_t section = 0, material = 0, eos = 0, hourglass = 0;  // ids; 0 where there is none
  std::int32_t block = -1;  // number of the block of the deck; -1 where there is none
  std::size_t repeat = 0;  // of its cards in the block
  Place place;
};

/// Codes that *NODE gives a node: which of its motions (TC) and rotations (RC) are held, 0 to 7.
struct NodeCode {
  std::int32_t node = 0;
  std::int8_t tc = 0, rc = 0;
};

/// A tetrahedron with nodes in the middle of its edges. The mesh holds its corners only.
struct TenNodes {
  std::int32_t cell = 0;
  std::array<std::int32_t, 10> nodes = {};
};

/// A set of parts, or of solids, by the ids that the whole deck uses.
struct DeckIdSet {
  std::int64_t id = 0;
  std::string title;
  std::vector<std::int64_t> ids;  // ascending, each once
  Place place;
};

struct DeckMesh {
  /// Blocks are the parts that have solids; their labels are the ids of the parts. Names are titles, or ids where
  /// there is no title or another part has the same. Node sets and face sets are those of *SET_NODE and *SET_SEGMENT.
  FileMesh mesh;
  std::vector<DeckPart> parts;  // in the order of the deck
  std::vector<std::int32_t> cell_part;  // per cell
  std::vector<SolidShape> shapes;  // per cell
  std::vector<std::int32_t> cell_sources;  // per cell, the reading of a file in which it stands
  std::vector<NodeCode> codes;  // of nodes that have one
  std::vector<TenNodes> ten_nodes;
  std::vector<DeckIdSet> part_sets, solid_sets;

  /// Where a cell is written.
  Place place_of_cell(std::size_t cell) const {
    return {cell_sources[cell], mesh.cell_places[cell].line, mesh.cell_places[cell].column};
  }
};

/// Reads the mesh of a deck. Nodes are moved, and ids shifted, as includes say; lengths are in the unit of the whole
/// deck. Mistakes go to `diagnostics`: ids that occur twice or are not defined, volumes that are not positive. Local.
DeckMesh read_mesh(const Deck& deck, Diagnostics& diagnostics);

/// Whether `base` is a form of sets that read_mesh reads: "SET_NODE_LIST", not "SET_NODE_COLUMN". The ids of the others
/// are known, so that check_references tells of them where something names them.
bool is_read_set(const std::string& base);

/// Ids that fields name but nothing defines: materials, sections, curves, sets, parts; curves whose abscissae do not
/// increase; and a missing end time. Local.
void check_references(const Deck& deck, const DeckMesh& mesh, Diagnostics& diagnostics);

}  // namespace kerf::decks
