// A mesh as a file describes it, in memory and free of any format, and the readers that make it.
//
// Nodes and cells are numbered from 0 in the order of the file; the numbers that the file gives them are their labels.
// A reader keeps what Kerf can compute, the solids, and counts the rest by name, so that nothing is left out unseen.
#pragma once

#include <array>
#include <cstdint>
#include <map>
#include <string>
#include <string_view>
#include <vector>

#include "core/diagnostics.hpp"

namespace kerf {

/// Where something stands in a file, for messages; the line is 0 in files that have no lines.
struct FilePlace {
  std::int32_t line = 0, column = 0;
};

/// Cells of one kind that the file puts together: a block of Exodus, a physical volume of Gmsh, a set of elements of
/// Abaqus, a part of a deck.
struct MeshBlock {
  std::string name;  // as the file calls it; its number where the file has no name for it
  std::int64_t label = 0;
  std::vector<std::int32_t> cells;  // ascending
  FilePlace place;
};

/// Nodes that the file names. Gmsh lets a surface have the name of a volume: names may occur twice.
struct MeshNodeSet {
  std::string name;
  std::int64_t label = 0;
  std::vector<std::int32_t> nodes;  // ascending, each once
};

/// Faces that the file names, by their corners; a triangle repeats its last corner. The ones of Gmsh need not be faces
/// of cells. The ones of Abaqus and Exodus are, and their corners go counter-clockwise as seen from outside.
struct MeshFaceSet {
  std::string name;
  std::int64_t label = 0;
  std::vector<std::array<std::int32_t, 4>> faces;
};

struct FileMesh {
  std::vector<std::array<double, 3>> points;  // per node, in the unit of the file
  std::vector<std::int64_t> node_labels;  // per node
  /// Per cell: eight nodes in the order of Kerf's hexahedron, where corners that coincide stand for a wedge, a pyramid
  /// or a tetrahedron: wedge 0 1 2 2 3 4 5 5, pyramid 0 1 2 3 4 4 4 4, tetrahedron 0 1 2 2 3 3 3 3.
  std::vector<std::array<std::int32_t, 8>> cells;
  std::vector<std::int64_t> cell_labels;  // per cell
  std::vector<FilePlace> cell_places;  // per cell, or empty
  std::vector<MeshBlock> blocks;
  std::vector<MeshBlock> cell_sets;  // further sets of cells, which may overlap: sets of elements of Abaqus
  std::vector<MeshNodeSet> node_sets;
  std::vector<MeshFaceSet> face_sets;
  std::map<std::string, std::int64_t> left_out;  // how many elements of which kind are neither cells nor in a set
  bool labels_repeat =
      false;  // whether labels may occur twice, as instances of Abaqus number their own nodes and cells
  std::string format;  // "Gmsh 4.1, binary", for messages

  const MeshBlock* block(std::string_view name) const;
};

/// What a reader is given: the bytes of the file and what messages call it.
struct MeshFileText {
  std::string_view bytes;
  std::string name;
};

/// Gmsh 2.2 and 4.1, as text or binary, of either byte order. Blocks are physical volumes, or, where there are none,
/// the volumes themselves; node sets are physical points, curves, surfaces and volumes; face sets physical surfaces. A
/// physical group without a name is called by its number. Mistakes go to `diagnostics`, at "name:line:column" in text
/// and "name" in binary files. Local.
FileMesh read_gmsh(const MeshFileText& file, Diagnostics& diagnostics);

/// Abaqus input decks: *NODE, *ELEMENT of types C3D8, C3D8R, C3D6, C3D4 and their kin, *NSET and *ELSET with GENERATE,
/// *SURFACE of elements' faces, *PART, *INSTANCE with translation and rotation, *ASSEMBLY, *INCLUDE refused. Blocks
/// are sets of elements that a *SOLID SECTION names, or else all elements of one *ELEMENT with ELSET; instances stand
/// before names as "instance.set". Other keywords are left alone, materials and steps among them. Local.
FileMesh read_abaqus(const MeshFileText& file, Diagnostics& diagnostics);

/// Exodus II in any netCDF format, classic ones and netCDF-4. Blocks are element blocks of HEX8, WEDGE6, PYRAMID5 and
/// TETRA4 that have elements; node sets and side sets keep their names. Messages name no line. Local.
FileMesh read_exodus(const MeshFileText& file, Diagnostics& diagnostics);

/// Whichever of the above the ending of the name and the first bytes tell: .msh, .inp, .exo, .e, .g, .ex2. Where the
/// reader finds no mistake, check_mesh looks for more. Post: the mesh is sound where `diagnostics` has no new errors.
/// Local.
FileMesh read_mesh_file(const std::string& path, Diagnostics& diagnostics);

/// What no reader can have meant: cells with nodes that do not exist, labels that occur twice, cells in two blocks or
/// in none, cells of the same nodes, blocks without cells. Added to `diagnostics`, at most twenty of each kind. Local.
void check_mesh(const FileMesh& mesh, const std::string& name, Diagnostics& diagnostics);

}  // namespace kerf
