// The reader of meshes of Gmsh: what the forms 2.2 and 4.1 have in common, and what each of them adds.
#pragma once

#include <algorithm>
#include <array>
#include <map>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "mesh/gmsh_source.hpp"
#include "mesh/label_map.hpp"
#include "mesh/mesh_errors.hpp"

namespace kerf::gmsh {

struct GmshType {
  int number;
  const char* name;
  int n_nodes, dimension, order;
};

using Nodes8 = std::array<std::int32_t, 8>;

/// What belongs to a physical group, or to a volume of the geometry.
struct Group {
  std::string name;
  std::vector<std::int32_t> cells, nodes;  // nodes of elements that are no cells
  std::vector<std::array<std::int32_t, 4>> faces;
};
using Key = std::pair<std::int64_t, std::int64_t>;  // dimension, number

/// One file. Its sections stand in the same order in both forms, and mean the same.
class GmshReader {
 public:
  GmshReader(const MeshFileText& file, Diagnostics& diagnostics)
      : source_(file.bytes), errors_(file.name, diagnostics) {}

  FileMesh read();

 private:
  bool read_format();
  bool read_section();
  bool leave_section();
  void read_names();
  void read_entities();
  bool read_entity(std::int64_t dimension);
  void read_nodes_2(bool parametric);
  void read_nodes_4();
  bool read_node_block();
  bool read_node_tags(std::int64_t count);
  void add_node(std::int64_t tag);
  void finish_nodes();
  void reserve_elements(std::int64_t n);
  void read_elements_2();
  bool read_element_line_2();
  std::int64_t read_element_block_2(std::int64_t most);
  bool read_element_2(const GmshType& type, std::int64_t tag, std::int64_t n_tags, FilePlace place);
  void read_elements_4();
  std::int64_t read_element_block_4();
  std::vector<Group*> groups_of(Key entity);
  bool read_corners(const GmshType& type, std::int64_t tag, Nodes8& nodes);
  const GmshType* known_type(std::int64_t number, FilePlace place);
  void add_element(const GmshType& type, std::int64_t tag, const Nodes8& nodes, std::span<Group*> groups, Group* volume,
                   FilePlace place);
  void finish_groups();
  std::vector<std::int32_t> nodes_of(const Group& group, std::vector<bool>& seen) const;

  bool count(std::int64_t& n, const char* what);
  bool text_count(std::int64_t& n, const char* what);
  bool checked(bool read, std::int64_t n, FilePlace place, const char* what);
  /// Ends a record of which `whole` tells whether all of it could be read.
  bool ended(bool whole, const char* what, const char* expected);
  void missing(std::int64_t announced, std::int64_t found, const char* what);
  std::string where(const char* what) const { return std::string(what) + " in $" + section_; }
  std::size_t trusted(std::int64_t n, std::int64_t bytes_each) const {
    return static_cast<std::size_t>(std::min(n, source_.bytes_left() / bytes_each + 1));
  }

  GmshSource source_;
  MeshErrors errors_;
  FileMesh mesh_;
  std::string section_;
  int version_ = 0;
  bool has_nodes_ = false, has_elements_ = false, broken_ = false;
  LabelMap node_of_;
  std::vector<std::int32_t> node_lines_;
  std::map<Key, Group> groups_;
  Key last_key_;
  Group* last_group_ = nullptr;
  std::map<std::int64_t, Group> volumes_;
  std::map<Key, std::vector<std::int64_t>> entities_;  // their physical groups
};

}  // namespace kerf::gmsh
