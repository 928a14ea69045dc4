// Reads meshes of Gmsh, formats 2.2 and 4.1: https://gmsh.info/doc/texinfo/gmsh.html, "Gmsh file formats".
#include <fmt/format.h>

#include <charconv>
#include <cmath>
#include <limits>

#include "mesh/gmsh_reader.hpp"

namespace kerf::gmsh {
namespace {

/// The number that the text form of Gmsh holds, which has sixteen digits: one mesh has the same bits in every form.
double as_written_in_text(double value) {
  if (!std::isfinite(value)) return value;
  std::array<char, 32> text{};
  const auto written = std::to_chars(text.data(), text.data() + text.size(), value, std::chars_format::general, 16);
  std::from_chars(text.data(), written.ptr, value);
  return value;
}

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

/// Kerf's eight nodes of a solid of Gmsh, which numbers corners in the same order.
Nodes8 as_hexahedron(int n_nodes, const Nodes8& n) {
  if (n_nodes == 4) return {n[0], n[1], n[2], n[2], n[3], n[3], n[3], n[3]};
  if (n_nodes == 5) return {n[0], n[1], n[2], n[3], n[4], n[4], n[4], n[4]};
  if (n_nodes == 6) return {n[0], n[1], n[2], n[2], n[3], n[4], n[5], n[5]};
  return n;
}

}  // namespace

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

// ---- nodes -----------------------------------------------------------------------------------------------------

void GmshReader::add_node(std::int64_t tag) {
  mesh_.node_labels.push_back(tag);
  if (!source_.binary) node_lines_.push_back(source_.place().line);
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

}  // namespace kerf::gmsh

namespace kerf {

FileMesh read_gmsh(const MeshFileText& file, Diagnostics& diagnostics) {
  return gmsh::GmshReader(file, diagnostics).read();
}

}  // namespace kerf
