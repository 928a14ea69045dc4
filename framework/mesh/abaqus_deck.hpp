// What the lines of an Abaqus deck say about its mesh, before instances are placed and sets are looked up.
#pragma once

#include <array>
#include <cstdint>
#include <deque>
#include <map>
#include <string>
#include <utility>
#include <vector>

#include "mesh/mesh_errors.hpp"

namespace kerf {

/// An entry of a set: labels from first to last, or cells or nodes by their order in the body, or the name of a set.
struct AbaqusItem {
  enum class Kind : std::uint8_t { labels, generated, order, name };
  std::int64_t first = 0, last = 0, step = 1;
  std::int32_t name = -1;  // in AbaqusBody::names
  Kind kind = Kind::labels;
  FilePlace place;
};

struct AbaqusSet {
  std::string name;
  bool of_cells = false;
  bool has_left_out = false;  // whether it has elements that are no solids
  std::string instance;  // whose labels it has; empty for those of the body itself
  std::string nodes_of;  // the set of elements whose nodes it has, in place of items
  FilePlace place;
  std::vector<AbaqusItem> items;
};

struct AbaqusSurface {
  struct Face {
    std::string cells;  // a label or a set
    int number = 0;  // as in S1
    FilePlace place;
  };
  std::string name;
  FilePlace place;
  std::vector<Face> faces;
};

/// Elements of one *ELEMENT, or the elements of a section.
struct AbaqusUse {
  std::string set;
  FilePlace place;
};

/// What has nodes and elements of its own numbers: a part, an instance, or the model around them.
struct AbaqusBody {
  std::string name;
  FilePlace place;
  std::vector<std::array<double, 3>> points;
  std::vector<std::int64_t> node_labels;
  std::vector<std::int32_t> node_lines;
  std::vector<std::array<std::int32_t, 8>> cells;  // labels of nodes, in the order of Kerf's hexahedron
  std::vector<std::int64_t> cell_labels;
  std::vector<FilePlace> cell_places;
  std::vector<std::uint8_t> n_corners;  // per cell: 4, 5, 6 or 8
  std::vector<std::int64_t> left_labels;  // of elements that are no solids
  std::map<std::string, std::int64_t> left_out;
  std::vector<std::string> names;
  std::vector<AbaqusSet> sets;
  std::vector<AbaqusSurface> surfaces;
  std::vector<AbaqusUse> sections, element_sets;  // what *SOLID SECTION and *ELEMENT name
};

/// A part that is shifted, then turned about an axis through two points.
struct AbaqusInstance {
  std::string part;
  std::array<double, 3> shift{};
  std::array<double, 7> turn{};  // two points and an angle in degrees
  bool is_turned = false;
  AbaqusBody own;  // what stands between *INSTANCE and *END INSTANCE
};

struct AbaqusDeck {
  AbaqusBody model;
  std::deque<AbaqusBody> parts;
  std::deque<AbaqusInstance> instances;
};

/// Reads the lines of a deck.
AbaqusDeck parse_abaqus(std::string_view bytes, MeshErrors& errors);

/// Places the instances and looks up sets. The deck is taken apart.
FileMesh assemble_abaqus(AbaqusDeck& deck, MeshErrors& errors);

/// Abaqus does not tell capitals from small letters.
std::string upper(std::string_view text);

}  // namespace kerf
