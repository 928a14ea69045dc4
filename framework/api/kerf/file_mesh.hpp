// A mesh as a file describes it, in memory and free of any format.
//
// Nodes and cells are numbered from 0 in the order of the file; the numbers that the file gives them are their labels.
#pragma once

#include <array>
#include <cstdint>
#include <map>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "kerf/sizes.hpp"

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
  bool labels_repeat = false;  // labels may occur twice: instances of Abaqus number their own nodes and cells
  std::string format;  // "Gmsh 4.1, binary", for messages

  /// The block that an input calls by its name, or by its number in the file: `block:NUMBER`. Null where no block is
  /// called so, or more than one.
  const MeshBlock* block(std::string_view called) const;
  /// What an input calls a block: its name, or `block:NUMBER` where another block has this name, too.
  std::string call(const MeshBlock& block) const;
};

/// The kinds of sets of nodes; also the first word of their qualified names.
inline constexpr const char *node_set_word = "node_set", *face_set_word = "face_set";

/// The sets of a mesh by what an input calls them: `node_set:NAME` and `face_set:NAME`. NAME alone is enough where one
/// kind has it, or both kinds have it with the same nodes. Sets of one kind that have one name are one set.
class MeshSets {
 public:
  /// One of the names, and its nodes of the whole mesh, ascending.
  struct Called {
    std::string name;
    std::span<const std::int32_t> nodes;
  };

  /// `mesh` has to live as long as this.
  explicit MeshSets(const FileMesh& mesh);
  MeshSets(const MeshSets&) = delete;
  MeshSets& operator=(const MeshSets&) = delete;

  /// All that an input can call them, ascending.
  std::vector<std::string> names() const;
  /// The place of a name in names(), or -1.
  int find(std::string_view called) const;
  /// Nodes of the whole mesh, ascending.
  std::span<const std::int32_t> nodes(int set) const { return called_[static_cast<std::size_t>(set)].nodes; }
  /// What an input calls the set of this kind: its name where that is enough.
  std::string call(const char* kind, const std::string& name) const;

 private:
  std::vector<Called> called_;  // by name
  std::vector<std::vector<std::int32_t>> made_;  // nodes that the mesh does not have as one list
};

}  // namespace kerf

KERF_SIZES(file_mesh, KERF_SIZE(FilePlace), KERF_SIZE(MeshBlock), KERF_SIZE(MeshNodeSet), KERF_SIZE(MeshFaceSet),
           KERF_SIZE(FileMesh), KERF_SIZE(MeshSets), KERF_SIZE(MeshSets::Called))
