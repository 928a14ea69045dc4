// The interface of mesh generators: meshes whose nodes and elements are computed from their number.
//
// A generator never stores the whole mesh, so that every rank can build just its share and ten million
// elements cost nothing before they are distributed. Generators are plugins of kind "mesh".
#pragma once

#include <algorithm>
#include <array>
#include <cstdint>
#include <string>
#include <vector>

#include "kerf/input_files.hpp"
#include "kerf/schema.hpp"
#include "kerf/shape.hpp"

namespace kerf {

class MeshGenerator : public Plugin {
 public:
  /// Reads the files that the parameters name. Returns whole lines "place: error: sentence"; empty where all is well.
  /// Called once, before prepare(), on every rank with the same files.
  virtual std::vector<std::string> load(const InputFiles& /*files*/) { return {}; }
  /// Checks the parameters against one another and builds what the numbering needs (grading, section).
  /// Returns sentences that say what is wrong; empty where all is well. Called once, on every rank.
  virtual std::vector<std::string> prepare() = 0;

  virtual std::int64_t n_nodes() const = 0;
  virtual std::int64_t n_elements() const = 0;
  /// Position of a node before the part is placed [m].
  virtual Vec3 node(std::int64_t i) const = 0;
  /// The shape of all elements.
  virtual const Shape& shape() const { return hexahedron; }
  /// Nodes of an element in the order of its shape (positive volume). Corners of a hexahedron may coincide in the
  /// orders of CellKind, in kerf/collapsed_cell.hpp, where the element technology takes such cells.
  virtual ElementNodeIds element(std::int64_t e) const = 0;
  /// Names of the faces of the body ("x_min", "lateral", ...), for sets and boundary conditions. A name that would mean
  /// several faces is not among them; each of these faces is called `WORD:NAME`, and messages offer these names.
  virtual std::vector<std::string> face_names() const = 0;
  /// The place of a name in face_names(), or -1. To be overridden where there are very many names.
  virtual int find_face(const std::string& name) const {
    const std::vector<std::string> names = face_names();
    const auto found = std::find(names.begin(), names.end(), name);
    return found == names.end() ? -1 : static_cast<int>(found - names.begin());
  }
  /// Whether a node lies on a named face (index into face_names()).
  virtual bool on_face(std::int64_t i, int face) const = 0;

  /// The mesh that this one is a part of, such as that of a file; null where it stands alone. Parts of one mesh share
  /// the nodes that have the same number in it.
  virtual const void* whole_mesh() const { return nullptr; }
  /// The number of a node in the whole mesh; different nodes have different numbers.
  virtual std::int64_t node_of_whole(std::int64_t i) const { return i; }
  /// Whether nodes and elements have numbers that the user knows, those of a file: messages and results tell them.
  virtual bool has_labels() const { return whole_mesh() != nullptr; }
  /// These numbers.
  virtual std::int64_t node_label(std::int64_t i) const { return i; }
  virtual std::int64_t element_label(std::int64_t e) const { return e; }
};

}  // namespace kerf

KERF_SIZES(mesh, KERF_SIZE(MeshGenerator))
