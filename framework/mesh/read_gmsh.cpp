// Reads meshes of Gmsh, formats 2.2 and 4.1: https://gmsh.info/doc/texinfo/gmsh.html, "Gmsh file formats".
#include <fmt/format.h>

#include <array>
#include <charconv>
#include <cmath>
#include <limits>
#include <span>
#include <utility>

#include "mesh/gmsh_source.hpp"
#include "mesh/label_map.hpp"
#include "mesh/mesh_errors.hpp"

namespace kerf {
namespace {

/// The number that the text form of Gmsh holds, which has sixteen digits: one mesh has the same bits in every form.
double as_written_in_text(double value) {
  if (!std::isfinite(value)) return value;
  std::array<char, 32> text{};
  const auto written = std::to_chars(text.data(), text.data() + text.size(), value, std::chars_format::general, 16);
  std::from_chars(text.data(), written.ptr, value);
  return value;
}

struct GmshType {
  int number;
  const char* name;
  int n_nodes, dimension, order;
};

constexpr GmshType types[] = {{1, "line", 2, 1, 1},
                              {2, "triangle", 3, 2, 1},
                              {3, "quadrangle", 4, 2, 1},
                              {4, "tetrahedron", 4, 3, 1},
                              {5, "hexahedron", 8, 3, 1},
                              {6, "prism", 6, 3, 1},
                              {7, "pyramid", 5, 3, 1},
                              {15, "point", 1, 0, 1},
                              {8, "line of 3 nodes", 3, 1, 2},
                              {9, "triangle of 6 nodes", 6, 2, 2},
                              {10, "quadrangle of 9 nodes", 9, 2, 2},
                              {11, "tetrahedron of 10 nodes", 10, 3, 2},
                              {12, "hexahedron of 27 nodes", 27, 3, 2},
                              {13, "prism of 18 nodes", 18, 3, 2},
                              {14, "pyramid of 14 nodes", 14, 3, 2},
                              {16, "quadrangle of 8 nodes", 8, 2, 2},
                              {17, "hexahedron of 20 nodes", 20, 3, 2},
                              {18, "prism of 15 nodes", 15, 3, 2},
                              {19, "pyramid of 13 nodes", 13, 3, 2},
                              {21, "triangle of 10 nodes", 10, 2, 3},
                              {26, "line of 4 nodes", 4, 1, 3},
                              {29, "tetrahedron of 20 nodes", 20, 3, 3},
                              {36, "quadrangle of 16 nodes", 16, 2, 3},
                              {92, "hexahedron of 64 nodes", 64, 3, 3}};

const GmshType* type_of(std::int64_t number) {
  for (const GmshType& type : types)
    if (type.number == number) return &type;
  return nullptr;
}

using Nodes8 = std::array<std::int32_t, 8>;

/// Kerf's eight nodes of a solid of Gmsh, which numbers corners in the same order.
Nodes8 as_hexahedron(int n_nodes, const Nodes8& n) {
  if (n_nodes == 4) return {n[0], n[1], n[2], n[2], n[3], n[3], n[3], n[3]};
  if (n_nodes == 5) return {n[0], n[1], n[2], n[3], n[4], n[4], n[4], n[4]};
  if (n_nodes == 6) return {n[0], n[1], n[2], n[2], n[3], n[4], n[5], n[5]};
  return n;
}

/// What belongs to a physical group, or to a volume of the geometry.
struct Group {
  std::string name;
  std::vector<std::int32_t> cells, nodes;  // nodes of elements that are no cells
  std::vector<std::array<std::int32_t, 4>> faces;
};
using Key = std::pair<std::int64_t, std::int64_t>;  // dimension, number

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

// ---- counts and ends of records --------------------------------------------------------------------------------

bool GmshReader::checked(bool read, std::int64_t n, FilePlace place, const char* what) {
  if (read && n >= 0 && n <= source_.bytes_left()) return true;
  errors_.at(place, "count",
             where(what) + (read ? " is " + std::to_string(n) + ", which the rest of the file cannot hold"
                                 : " is missing; expected a whole number"));
  broken_ = broken_ || source_.binary;
  return false;
}

bool GmshReader::count(std::int64_t& n, const char* what) {
  const FilePlace place = source_.place();
  const bool read = source_.size(n);
  return checked(read, n, place, what);
}

bool GmshReader::text_count(std::int64_t& n, const char* what) {
  source_.begin_text_record();
  const FilePlace place = source_.place();
  const bool read = source_.text_integer(n);
  source_.end_text_record();
  return checked(read, n, place, what);
}

bool GmshReader::ended(bool whole, const char* what, const char* expected) {
  FilePlace place = source_.place();
  if (source_.end_record() && whole) return true;
  if (source_.binary) {
    broken_ = true;
    errors_.at({}, what,
               where(what) + " cannot be read, " + std::to_string(source_.bytes_left()) +
                   " bytes before the end of the file; expected " + expected);
  } else {
    errors_.at(place, what, where(what) + " cannot be read from here on; expected " + expected);
  }
  return false;
}

void GmshReader::missing(std::int64_t announced, std::int64_t found, const char* what) {
  errors_.at(
      source_.place(), what,
      "$" + section_ + " ends after " + std::to_string(found) + " " + what + "; expected " + std::to_string(announced));
  broken_ = broken_ || source_.binary;
}

// ---- sections --------------------------------------------------------------------------------------------------

bool GmshReader::read_format() {
  source_.begin_text_record();
  const FilePlace place = source_.place();
  double version = 0.0;
  std::int64_t type = 0, size = 0, one = 0;
  const bool whole = source_.text_real(version) && source_.text_integer(type) && source_.text_integer(size);
  if (!source_.end_text_record() || !whole || (type != 0 && type != 1) || (size != 4 && size != 8)) {
    errors_.at(place, "format", "this is no line of $MeshFormat; expected the version, 0 or 1, and 8");
    return false;
  }
  version_ = version >= 2.0 && version < 2.3 ? 2 : version == 4.1 ? 4 : 0;
  const std::string text = fmt::format("{}", version);
  if (version_ == 0)
    errors_.at(place, "format",
               "the format of Gmsh is " + text + "; expected 2.2 or 4.1 (in Gmsh: Mesh.MshFileVersion = 4.1)");
  mesh_.format = "Gmsh " + text + (type == 1 ? ", binary" : ", text");
  source_.size_bytes = static_cast<int>(size);
  if (version_ == 0 || type == 0) return version_ != 0;
  source_.binary = true;
  const bool read = source_.integer(one);
  source_.swapped = one != 1;
  if (read && (one == 1 || one == 0x01000000)) return true;
  errors_.at({}, "format", "the order of bytes cannot be told from $MeshFormat; expected the number 1 in four bytes");
  return false;
}

/// Reads a section whose end is known from what it says; false where the section is passed over.
bool GmshReader::read_section() {
  if (section_ == "PhysicalNames") return read_names(), true;
  if (section_ == "Entities" && version_ == 4) return read_entities(), true;
  if (section_ == "PartitionedEntities")
    errors_.at(source_.place(), "partitions",
               "the mesh is cut into partitions; expected a whole one (in Gmsh: unpartition it before saving)");
  const bool nodes = section_ == "Nodes" || (section_ == "ParametricNodes" && version_ == 2);
  if (!nodes && section_ != "Elements") return false;
  if (nodes ? has_nodes_ : has_elements_ || !has_nodes_) {
    errors_.at(source_.place(), "sections",
               "$" + section_ +
                   " is out of order; expected one section $Nodes, then one "
                   "section $Elements");
    return false;
  }
  if (nodes)
    version_ == 2 ? read_nodes_2(section_ != "Nodes") : read_nodes_4();
  else
    version_ == 2 ? read_elements_2() : read_elements_4();
  (nodes ? has_nodes_ : has_elements_) = true;
  return true;
}

FileMesh GmshReader::read() {
  section_ = source_.next_section();
  const bool known = section_ == "MeshFormat";
  if (!known)
    errors_.at(source_.place(), "format", "this is no mesh of Gmsh 2.2 or 4.1; expected $MeshFormat in the first line");
  if (!known || !read_format() || !leave_section()) return std::move(mesh_);
  while (!broken_ && !(section_ = source_.next_section()).empty()) {
    const std::int64_t before = errors_.count();
    const bool read = read_section();
    if (read && errors_.count() == before && !source_.at_section_end())
      errors_.at(source_.place(), "ends",
                 "$" + section_ + " goes on; expected $End" + section_ + " after what it counts");
    if (broken_ || !leave_section()) break;
  }
  if (errors_.count() == 0 && !has_nodes_) errors_.at({}, "sections", "there are no nodes; expected $Nodes");
  if (errors_.count() == 0 && !has_elements_) errors_.at({}, "sections", "there are no elements; expected $Elements");
  if (errors_.count() == 0) finish_groups();
  return std::move(mesh_);
}

bool GmshReader::leave_section() {
  if (source_.leave_section(section_)) return true;
  errors_.at(source_.place(), "ends", "$" + section_ + " has no end; expected $End" + section_);
  return false;
}

void GmshReader::read_names() {
  std::int64_t n = 0;
  if (!text_count(n, "the number of names")) return;
  for (std::int64_t i = 0; i < n; ++i) {
    if (!source_.begin_text_record()) return missing(n, i, "names");
    const FilePlace place = source_.place();
    std::int64_t dimension = 0, tag = 0;
    const bool whole = source_.text_integer(dimension) && source_.text_integer(tag);
    const std::string_view rest = source_.rest_of_line();
    const std::size_t open = rest.find('"'), close = rest.rfind('"');
    source_.end_text_record();
    if (whole && dimension >= 0 && dimension <= 3 && open != close)
      groups_[{dimension, tag}].name = rest.substr(open + 1, close - open - 1);
    else
      errors_.at(place, "name", where("a name") + " cannot be read; expected: dimension number \"name\"");
  }
}

// ---- entities of 4.1 -------------------------------------------------------------------------------------------

void GmshReader::read_entities() {
  std::int64_t counts[4] = {0, 0, 0, 0};
  source_.begin_record();
  for (std::int64_t& n : counts)
    if (!count(n, "a number of entities")) return;
  if (!ended(true, "a number of entities", "four numbers")) return;
  for (std::int64_t dimension = 0; dimension < 4; ++dimension)
    for (std::int64_t i = 0; i < counts[dimension]; ++i) {
      if (!source_.begin_record()) return missing(counts[dimension], i, "entities of a dimension");
      const bool whole = read_entity(dimension);
      if (!ended(whole, "an entity", "its number, its box, its physical groups and its boundary") && broken_) return;
    }
}

bool GmshReader::read_entity(std::int64_t dimension) {
  std::int64_t tag = 0, n = 0, number = 0;
  double box = 0.0;
  if (!source_.integer(tag)) return false;
  for (int i = 0; i < (dimension == 0 ? 3 : 6); ++i)
    if (!source_.real(box)) return false;
  if (!source_.size(n)) return false;
  std::vector<std::int64_t>& physical = entities_[{dimension, tag}];
  for (std::int64_t i = 0; i < n; ++i) {
    if (!source_.integer(number)) return false;
    physical.push_back(number < 0 ? -number : number);  // the sign is that of a direction
  }
  if (dimension == 0) return true;
  if (!source_.size(n)) return false;
  for (std::int64_t i = 0; i < n; ++i)
    if (!source_.integer(number)) return false;
  return true;
}

// ---- nodes -----------------------------------------------------------------------------------------------------

void GmshReader::add_node(std::int64_t tag) {
  mesh_.node_labels.push_back(tag);
  if (!source_.binary) node_lines_.push_back(source_.place().line);
}

void GmshReader::read_nodes_2(bool parametric) {
  std::int64_t n = 0, tag = 0, dimension = 0, entity = 0;
  if (!text_count(n, "the number of nodes")) return;
  mesh_.points.reserve(trusted(n, 8));
  mesh_.node_labels.reserve(trusted(n, 8));
  for (std::int64_t i = 0; i < n; ++i) {
    if (!source_.begin_record()) return missing(n, i, "nodes");
    std::array<double, 3> x{};
    bool whole = source_.integer(tag) && source_.real(x[0]) && source_.real(x[1]) && source_.real(x[2]);
    add_node(tag);
    mesh_.points.push_back(x);
    if (parametric) {
      whole = whole && source_.integer(dimension) && source_.integer(entity);
      for (int k = 0; whole && dimension < 3 && k < dimension; ++k) whole = source_.real(x[0]);
    }
    if (!ended(whole, "a node", parametric ? "number x y z dimension entity parameters" : "number x y z") && broken_)
      return;
  }
  finish_nodes();
}

void GmshReader::read_nodes_4() {
  std::int64_t blocks = 0, n = 0, low = 0, high = 0;
  source_.begin_record();
  if (!count(blocks, "the number of blocks") || !count(n, "the number of nodes")) return;
  if (!ended(source_.size(low) && source_.size(high), "the first line", "four numbers")) return;
  mesh_.points.reserve(trusted(n, 8));
  mesh_.node_labels.reserve(trusted(n, 8));
  for (std::int64_t i = 0; i < blocks; ++i) {
    if (!source_.begin_record()) return missing(blocks, i, "blocks of nodes");
    if (!read_node_block()) return;
  }
  const auto found = static_cast<std::int64_t>(mesh_.node_labels.size());
  if (found != n) missing(n, found, "nodes");
  finish_nodes();
}

bool GmshReader::read_node_block() {
  std::int64_t dimension = 0, entity = 0, parametric = 0, n = 0;
  const bool whole = source_.integer(dimension) && source_.integer(entity) && source_.integer(parametric);
  if (whole && !count(n, "the number of nodes of a block")) return false;
  const bool sound = whole && dimension >= 0 && dimension <= 3 && (parametric == 0 || parametric == 1);
  if (!ended(sound, "the head of a block of nodes", "dimension entity parametric count")) return false;
  if (!read_node_tags(n)) return false;
  const std::int64_t n_parameters = parametric == 1 ? dimension : 0;
  for (std::int64_t i = 0; i < n; ++i) {
    if (!source_.begin_record()) return missing(n, i, "coordinates of a block"), false;
    std::array<double, 3> x{};
    double parameter = 0.0;
    bool read = source_.real(x[0]) && source_.real(x[1]) && source_.real(x[2]);
    for (std::int64_t k = 0; read && k < n_parameters; ++k) read = source_.real(parameter);
    mesh_.points.push_back(x);
    if (!ended(read, "a node", n_parameters > 0 ? "x y z and parameters" : "x y z") && broken_) return false;
  }
  return true;
}

bool GmshReader::read_node_tags(std::int64_t n) {
  for (std::int64_t i = 0; i < n; ++i) {
    if (!source_.begin_record()) return missing(n, i, "numbers of a block of nodes"), false;
    std::int64_t tag = 0;
    const bool read = source_.size(tag);
    add_node(tag);
    if (!ended(read, "the number of a node", "one whole number") && broken_) return false;
  }
  return true;
}

void GmshReader::finish_nodes() {
  if (source_.binary)
    for (std::array<double, 3>& x : mesh_.points)
      for (double& value : x) value = as_written_in_text(value);
  if (mesh_.node_labels.size() > static_cast<std::size_t>(std::numeric_limits<std::int32_t>::max())) {
    errors_.at({}, "size", "there are more than 2147483647 nodes");
    broken_ = true;
    return;
  }
  node_of_ = LabelMap(mesh_.node_labels);
  for (const std::int32_t i : node_of_.repeated()) {
    const auto at = static_cast<std::size_t>(i);
    errors_.at({source_.binary ? 0 : node_lines_[at], source_.binary ? 0 : 1}, "repeated node",
               "node " + std::to_string(mesh_.node_labels[at]) + " is there twice; expected different numbers");
  }
  node_lines_ = {};
}

// ---- elements --------------------------------------------------------------------------------------------------

const GmshType* GmshReader::known_type(std::int64_t number, FilePlace place) {
  const GmshType* type = type_of(number);
  if (!type) {
    errors_.at(place, "type " + std::to_string(number),
               "elements of type " + std::to_string(number) +
                   " are not known; expected hexahedra (5), prisms (6), "
                   "pyramids (7) or tetrahedra (4)",
               1);
  } else if (type->order > 1) {
    errors_.at(place, type->name,
               std::string("this is a ") + type->name + " (type " + std::to_string(number) +
                   "), of higher order; expected elements of first order (in Gmsh: Mesh.ElementOrder = 1)",
               1);
  }
  return type && type->order == 1 ? type : nullptr;
}

bool GmshReader::read_corners(const GmshType& type, std::int64_t tag, Nodes8& nodes) {
  for (int k = 0; k < type.n_nodes; ++k) {
    std::int64_t label = 0;
    const FilePlace place = source_.place();
    if (!(version_ == 2 ? source_.integer(label) : source_.size(label))) return false;
    const std::int32_t node = node_of_.find(label);
    nodes[static_cast<std::size_t>(k)] = node;
    if (node < 0)
      errors_.at(place, "unknown node",
                 "element " + std::to_string(tag) + " has node " + std::to_string(label) +
                     ", which $Nodes does not have; expected a number from there");
  }
  return true;
}

void GmshReader::add_element(const GmshType& type, std::int64_t tag, const Nodes8& nodes, std::span<Group*> groups,
                             Group* volume, FilePlace place) {
  if (type.dimension == 3) {
    const auto cell = static_cast<std::int32_t>(mesh_.cells.size());
    for (Group* group : groups) group->cells.push_back(cell);
    if (volume) volume->cells.push_back(cell);
    mesh_.cells.push_back(as_hexahedron(type.n_nodes, nodes));
    mesh_.cell_labels.push_back(tag);
    if (!source_.binary) mesh_.cell_places.push_back(place);
    return;
  }
  if (groups.empty()) ++mesh_.left_out[type.name];
  for (Group* group : groups) {
    if (type.dimension == 2)
      group->faces.push_back({nodes[0], nodes[1], nodes[2], nodes[type.n_nodes == 4 ? 3 : 2]});
    else
      group->nodes.insert(group->nodes.end(), nodes.begin(), nodes.begin() + type.n_nodes);
  }
}

void GmshReader::reserve_elements(std::int64_t n) {
  mesh_.cells.reserve(trusted(n, 16));
  mesh_.cell_labels.reserve(trusted(n, 16));
  if (!source_.binary) mesh_.cell_places.reserve(trusted(n, 16));
}

void GmshReader::read_elements_2() {
  std::int64_t n = 0, done = 0;
  if (!text_count(n, "the number of elements")) return;
  reserve_elements(n);
  while (done < n && !broken_) {
    if (!source_.begin_record()) return missing(n, done, "elements");
    if (source_.binary)
      done += read_element_block_2(n - done);
    else
      ended(read_element_line_2(), "an element", "number type count-of-tags tags nodes"), ++done;
  }
}

bool GmshReader::read_element_line_2() {
  const FilePlace place = source_.place();
  std::int64_t tag = 0, number = 0, n_tags = 0;
  if (!source_.integer(tag) || !source_.integer(number) || !source_.integer(n_tags)) return false;
  const GmshType* type = known_type(number, place);
  if (type) return read_element_2(*type, tag, n_tags, place);
  source_.skip_line();
  return true;
}

/// Elements of one type in a binary file; how many there are.
std::int64_t GmshReader::read_element_block_2(std::int64_t most) {
  std::int64_t number = 0, n = 0, n_tags = 0, tag = 0;
  const bool whole = source_.integer(number) && source_.integer(n) && source_.integer(n_tags);
  if (!ended(whole && n > 0 && n <= most, "a block of elements", "type, count and number of tags")) return 0;
  const GmshType* type = known_type(number, {});
  broken_ = !type;
  for (std::int64_t i = 0; i < n && !broken_; ++i)
    ended(source_.integer(tag) && read_element_2(*type, tag, n_tags, {}), "an element", "number, tags and nodes");
  return n;
}

/// Tags and nodes. The first tag is the physical group, 0 for none, the second the entity of the geometry.
bool GmshReader::read_element_2(const GmshType& type, std::int64_t tag, std::int64_t n_tags, FilePlace place) {
  std::int64_t physical = 0, entity = 0, other = 0;
  if (n_tags < 0 || n_tags > source_.bytes_left()) return false;
  for (std::int64_t i = 0; i < n_tags; ++i)
    if (!source_.integer(i == 0 ? physical : i == 1 ? entity : other)) return false;
  Nodes8 nodes{};
  if (!read_corners(type, tag, nodes)) return false;
  const Key key{type.dimension, physical < 0 ? -physical : physical};  // the sign is that of a direction
  if (key != last_key_ || !last_group_) {
    last_key_ = key;
    last_group_ = key.second == 0 ? nullptr : &groups_[key];
  }
  Group* volume = type.dimension == 3 ? &volumes_[entity] : nullptr;
  add_element(type, tag, nodes, {&last_group_, last_group_ ? 1u : 0u}, volume, place);
  return true;
}

void GmshReader::read_elements_4() {
  std::int64_t blocks = 0, n = 0, low = 0, high = 0, done = 0;
  source_.begin_record();
  if (!count(blocks, "the number of blocks") || !count(n, "the number of elements")) return;
  if (!ended(source_.size(low) && source_.size(high), "the first line", "four numbers")) return;
  reserve_elements(n);
  for (std::int64_t i = 0; i < blocks; ++i) {
    if (!source_.begin_record()) return missing(blocks, i, "blocks of elements");
    const std::int64_t found = read_element_block_4();
    if (found < 0) return;
    done += found;
  }
  if (done != n) missing(n, done, "elements");
}

/// How many elements the block has; -1 where the section cannot be read further.
std::int64_t GmshReader::read_element_block_4() {
  const FilePlace head = source_.place();
  std::int64_t dimension = 0, entity = 0, number = 0, n = 0, tag = 0;
  const bool whole = source_.integer(dimension) && source_.integer(entity) && source_.integer(number);
  if (whole && !count(n, "the number of elements of a block")) return -1;
  if (!ended(whole, "the head of a block of elements", "dimension entity type count")) return -1;
  const GmshType* type = known_type(number, head);
  if (!type && source_.binary) return broken_ = true, -1;
  std::vector<Group*> groups;
  if (type) groups = groups_of({type->dimension, entity});
  Group* volume = type && type->dimension == 3 ? &volumes_[entity] : nullptr;
  for (std::int64_t i = 0; i < n; ++i) {
    if (!source_.begin_record()) return missing(n, i, "elements of a block"), -1;
    const FilePlace place = source_.place();
    Nodes8 nodes{};
    const bool read = !type ? source_.skip_line() : source_.size(tag) && read_corners(*type, tag, nodes);
    if (ended(read, "an element", "number nodes") && type) add_element(*type, tag, nodes, groups, volume, place);
    if (broken_) return -1;
  }
  return n;
}

std::vector<Group*> GmshReader::groups_of(Key entity) {
  std::vector<Group*> groups;
  const auto found = entities_.find(entity);
  if (found == entities_.end()) return groups;
  for (const std::int64_t number : found->second) groups.push_back(&groups_[{entity.first, number}]);
  return groups;
}

// ---- groups ----------------------------------------------------------------------------------------------------

/// All nodes of a group, ascending. `seen` is false for all nodes, before and after.
std::vector<std::int32_t> GmshReader::nodes_of(const Group& group, std::vector<bool>& seen) const {
  std::vector<std::int32_t> nodes;
  const auto add = [&](std::int32_t node) {
    if (!seen[static_cast<std::size_t>(node)]) nodes.push_back(node);
    seen[static_cast<std::size_t>(node)] = true;
  };
  for (const std::int32_t cell : group.cells)
    for (const std::int32_t node : mesh_.cells[static_cast<std::size_t>(cell)]) add(node);
  for (const auto& face : group.faces)
    for (const std::int32_t node : face) add(node);
  for (const std::int32_t node : group.nodes) add(node);
  std::sort(nodes.begin(), nodes.end());
  for (const std::int32_t node : nodes) seen[static_cast<std::size_t>(node)] = false;
  return nodes;
}

void GmshReader::finish_groups() {
  bool physical_volumes = false;
  std::vector<bool> seen(mesh_.points.size());
  for (auto& [key, group] : groups_) {
    const auto [dimension, number] = key;
    const std::string name = group.name.empty() ? std::to_string(number) : group.name;
    mesh_.node_sets.push_back({name, number, nodes_of(group, seen)});
    if (dimension == 2) mesh_.face_sets.push_back({name, number, std::move(group.faces)});
    if (dimension != 3) continue;
    physical_volumes = true;
    mesh_.blocks.push_back({name, number, std::move(group.cells), {}});
  }
  if (physical_volumes) return;
  for (auto& [number, group] : volumes_)
    mesh_.blocks.push_back({std::to_string(number), number, std::move(group.cells), {}});
}

}  // namespace

FileMesh read_gmsh(const MeshFileText& file, Diagnostics& diagnostics) { return GmshReader(file, diagnostics).read(); }

}  // namespace kerf
