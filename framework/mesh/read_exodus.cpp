// Reads meshes of Exodus II: Sjaardema, Schoof & Yarberry, "EXODUS: a finite element data model" (2019), section 4.
#include <algorithm>
#include <cmath>
#include <limits>

#include "mesh/mesh_errors.hpp"
#include "mesh/netcdf.hpp"

namespace kerf {
namespace {

using Integers = std::vector<std::int64_t>;

/// Nodes of the sides of an element from 1, 0 where a triangle has no fourth; section 4.8, table 2.
using Sides = std::array<std::array<int, 4>, 6>;

struct ExodusType {
  const char* prefix;
  std::int64_t n_nodes;
  std::array<int, 8> order;  // Kerf's eight nodes out of those of Exodus
  Sides sides;
};

constexpr ExodusType types[] = {
    {"HEX",
     8,
     {0, 1, 2, 3, 4, 5, 6, 7},
     {{{1, 2, 6, 5}, {2, 3, 7, 6}, {3, 4, 8, 7}, {1, 5, 8, 4}, {1, 4, 3, 2}, {5, 6, 7, 8}}}},
    {"WEDGE",
     6,
     {0, 1, 2, 2, 3, 4, 5, 5},
     {{{1, 2, 5, 4}, {2, 3, 6, 5}, {1, 4, 6, 3}, {1, 3, 2, 0}, {4, 5, 6, 0}, {}}}},
    {"PYR", 5, {0, 1, 2, 3, 4, 4, 4, 4}, {{{1, 2, 5, 0}, {2, 3, 5, 0}, {3, 4, 5, 0}, {1, 5, 4, 0}, {1, 4, 3, 2}, {}}}},
    {"TET", 4, {0, 1, 2, 2, 3, 3, 3, 3}, {{{1, 2, 4, 0}, {2, 3, 4, 0}, {1, 4, 3, 0}, {1, 3, 2, 0}, {}, {}}}}};

const ExodusType* type_of(const std::string& name) {
  for (const ExodusType& type : types)
    if (name.starts_with(type.prefix)) return &type;
  return nullptr;
}

/// Up to the first zero or blank, in capitals.
std::string word_of(const std::string& text) {
  std::string word;
  for (const char c : text) {
    if (c == '\0' || c == ' ') break;
    word += static_cast<char>(c >= 'a' && c <= 'z' ? c - 'a' + 'A' : c);
  }
  return word;
}

/// Whether entry `i` has members. Without them its tables may be missing.
bool is_full(const Integers& status, std::size_t i) { return i >= status.size() || status[i] != 0; }

class ExodusReader {
 public:
  ExodusReader(const MeshFileText& file, Diagnostics& diagnostics)
      : bytes_(file.bytes), errors_(file.name, diagnostics) {}
  FileMesh read();

 private:
  void read_nodes();
  bool read_coordinates(std::array<std::vector<double>, 3>& x);
  void read_blocks();
  void read_block(std::size_t i, std::int64_t id, const std::string& name);
  void add_cells(const ExodusType& type, const Integers& nodes, MeshBlock& block);
  void read_element_labels();
  void read_node_sets();
  void read_side_sets();
  void add_side(std::int64_t element, std::int64_t side, MeshFaceSet& to, std::int64_t& left_out);
  /// What the entries of a kind are called: their number where they have no name.
  std::vector<std::string> names(const char* variable, const Integers& ids);
  /// Reads integers that must be there.
  bool read(const std::string& variable, Integers& values);
  void error(const char* kind, const std::string& message) { errors_.at({}, kind, message); }
  Integers ids(const char* variable);  // empty where there are none

  std::string_view bytes_;
  MeshErrors errors_;
  std::unique_ptr<NetcdfFile> file_;
  FileMesh mesh_;
  std::vector<std::int32_t> cell_of_;  // per element of the file; -1 where it is no solid
  std::vector<const ExodusType*> type_of_cell_;
};

FileMesh ExodusReader::read() {
  std::string why;
  file_ = bytes_.starts_with("CDF") ? open_classic_netcdf(bytes_, why) : open_netcdf4(bytes_, why);
  if (!file_) {
    error("file", why + "; expected a mesh of Exodus II");
    return std::move(mesh_);
  }
  mesh_.format = std::string("Exodus II, ") + file_->format();
  read_nodes();
  if (errors_.count() > 0) return std::move(mesh_);
  read_blocks();
  if (errors_.count() > 0) return std::move(mesh_);
  read_element_labels();
  read_node_sets();
  read_side_sets();
  return std::move(mesh_);
}

bool ExodusReader::read(const std::string& variable, Integers& values) {
  if (file_->read(variable, values)) return true;
  error("variable", "the values of " + in_quotes(variable) + " cannot be read; expected whole numbers in the file");
  return false;
}

Integers ExodusReader::ids(const char* variable) {
  Integers values;
  if (file_->has(variable)) read(variable, values);
  return values;
}

/// A letter that no name has: what follows it is left over from other data of the program that wrote the file.
bool is_control(char c) { return static_cast<unsigned char>(c) < ' ' || c == '\x7f'; }

std::vector<std::string> ExodusReader::names(const char* variable, const Integers& ids) {
  std::vector<std::string> out;
  for (const std::int64_t id : ids) out.push_back(std::to_string(id));
  std::string letters;
  const std::vector<std::int64_t> shape = file_->shape(variable);
  if (shape.size() != 2 || shape[0] != static_cast<std::int64_t>(ids.size()) || !file_->read(variable, letters))
    return out;
  const auto width = static_cast<std::size_t>(shape[1]);
  for (std::size_t i = 0; i < out.size() && (i + 1) * width <= letters.size(); ++i) {
    std::string name = letters.substr(i * width, width);
    name.resize(static_cast<std::size_t>(std::find_if(name.begin(), name.end(), is_control) - name.begin()));
    while (name.ends_with(' ')) name.pop_back();
    if (!name.empty()) out[i] = name;
  }
  return out;
}

// ---- nodes -----------------------------------------------------------------------------------------------------

/// Files that are old have all coordinates in one array.
bool ExodusReader::read_coordinates(std::array<std::vector<double>, 3>& x) {
  if (file_->has("coordx"))
    return file_->read("coordx", x[0]) && file_->read("coordy", x[1]) && file_->read("coordz", x[2]);
  std::vector<double> all;
  if (file_->shape("coord").size() != 2 || file_->shape("coord")[0] != 3 || !file_->read("coord", all)) return false;
  const auto n = static_cast<std::ptrdiff_t>(all.size() / 3);
  for (std::ptrdiff_t k = 0; k < 3; ++k)
    x[static_cast<std::size_t>(k)].assign(all.begin() + k * n, all.begin() + (k + 1) * n);
  return true;
}

void ExodusReader::read_nodes() {
  std::array<std::vector<double>, 3> x;
  if (!read_coordinates(x) || x[1].size() != x[0].size() || x[2].size() != x[0].size())
    return error("variable",
                 "the coordinates of nodes cannot be read; expected \"coordx\", \"coordy\" and \"coordz\" of "
                 "one length");
  const std::size_t n = x[0].size();
  if (n > static_cast<std::size_t>(std::numeric_limits<std::int32_t>::max()))
    return error("size", "there are more than 2147483647 nodes");
  mesh_.points.resize(n);
  for (std::size_t i = 0; i < n; ++i) {
    mesh_.points[i] = {x[0][i], x[1][i], x[2][i]};
    for (const double coordinate : mesh_.points[i])
      if (!std::isfinite(coordinate))
        error("coordinates", "node " + std::to_string(i + 1) + " has a coordinate that is no finite number");
  }
  if (file_->has("node_num_map")) read("node_num_map", mesh_.node_labels);
  if (!file_->has("node_num_map"))
    for (std::size_t i = 0; i < n; ++i) mesh_.node_labels.push_back(static_cast<std::int64_t>(i) + 1);
  if (mesh_.node_labels.size() != n) error("variable", "\"node_num_map\" is not as long as there are nodes");
}

// ---- blocks ----------------------------------------------------------------------------------------------------

void ExodusReader::read_blocks() {
  const Integers block_ids = ids("eb_prop1"), status = ids("eb_status");
  const std::vector<std::string> block_names = names("eb_names", block_ids);
  for (std::size_t i = 0; i < block_ids.size(); ++i)
    if (is_full(status, i)) read_block(i, block_ids[i], block_names[i]);
}

void ExodusReader::read_block(std::size_t i, std::int64_t id, const std::string& name) {
  const std::string variable = "connect" + std::to_string(i + 1);
  const std::string kind = word_of(file_->attribute(variable, "elem_type"));
  const std::vector<std::int64_t> shape = file_->shape(variable);
  if (shape.size() != 2 || shape[0] < 0 || shape[1] < 1 || shape[0] > std::numeric_limits<std::int32_t>::max())
    return error("block", "block " + in_quotes(name) + " of elements " + in_quotes(kind) +
                              " has no table of nodes; expected \"" + variable + "\" of elements by nodes");
  const ExodusType* type = type_of(kind);
  if (type && shape[1] != type->n_nodes)
    return error("type", "block " + in_quotes(name) + " has elements " + in_quotes(kind) + " of " +
                             std::to_string(shape[1]) +
                             " nodes; expected elements of first order: HEX8, WEDGE6, "
                             "PYRAMID5 or TETRA4");
  Integers nodes;
  if (!read(variable, nodes)) return;
  if (!type) {
    if (shape[0] > 0) mesh_.left_out[kind.empty() ? "elements without a type" : kind] += shape[0];
    cell_of_.resize(cell_of_.size() + static_cast<std::size_t>(shape[0]), -1);
    return;
  }
  MeshBlock block{name, id, {}, {}};
  add_cells(*type, nodes, block);
  if (!block.cells.empty()) mesh_.blocks.push_back(std::move(block));
}

void ExodusReader::add_cells(const ExodusType& type, const Integers& nodes, MeshBlock& block) {
  const auto n_nodes = static_cast<std::int64_t>(mesh_.points.size());
  const auto width = static_cast<std::size_t>(type.n_nodes);
  for (std::size_t first = 0; first + width <= nodes.size(); first += width) {
    std::array<std::int32_t, 8> cell{};
    for (std::size_t k = 0; k < 8; ++k) {
      const std::int64_t node = nodes[first + static_cast<std::size_t>(type.order[k])];
      if (node < 1 || node > n_nodes) {
        error("unknown node", "an element of block " + in_quotes(block.name) + " has node " + std::to_string(node) +
                                  "; expected 1 to " + std::to_string(n_nodes));
        break;
      }
      cell[k] = static_cast<std::int32_t>(node - 1);
    }
    const auto index = static_cast<std::int32_t>(mesh_.cells.size());
    block.cells.push_back(index);
    cell_of_.push_back(index);
    type_of_cell_.push_back(&type);
    mesh_.cells.push_back(cell);
  }
}

void ExodusReader::read_element_labels() {
  Integers labels;
  if (file_->has("elem_num_map") && !read("elem_num_map", labels)) return;
  if (!labels.empty() && labels.size() != cell_of_.size())
    return error("variable", "\"elem_num_map\" is not as long as there are elements");
  mesh_.cell_labels.resize(mesh_.cells.size());
  for (std::size_t e = 0; e < cell_of_.size(); ++e)
    if (cell_of_[e] >= 0)
      mesh_.cell_labels[static_cast<std::size_t>(cell_of_[e])] =
          labels.empty() ? static_cast<std::int64_t>(e) + 1 : labels[e];
}

// ---- sets ------------------------------------------------------------------------------------------------------

void ExodusReader::read_node_sets() {
  const Integers set_ids = ids("ns_prop1"), status = ids("ns_status");
  const std::vector<std::string> set_names = names("ns_names", set_ids);
  for (std::size_t i = 0; i < set_ids.size(); ++i) {
    MeshNodeSet set{set_names[i], set_ids[i], {}};
    Integers nodes;
    if (is_full(status, i) && !read("node_ns" + std::to_string(i + 1), nodes)) continue;
    for (const std::int64_t node : nodes) {
      if (node < 1 || node > static_cast<std::int64_t>(mesh_.points.size()))
        error("unknown node", "node set " + in_quotes(set.name) + " has node " + std::to_string(node) +
                                  "; expected 1 to " + std::to_string(mesh_.points.size()));
      else
        set.nodes.push_back(static_cast<std::int32_t>(node - 1));
    }
    std::sort(set.nodes.begin(), set.nodes.end());
    set.nodes.erase(std::unique(set.nodes.begin(), set.nodes.end()), set.nodes.end());
    mesh_.node_sets.push_back(std::move(set));
  }
}

void ExodusReader::read_side_sets() {
  const Integers set_ids = ids("ss_prop1"), status = ids("ss_status");
  const std::vector<std::string> set_names = names("ss_names", set_ids);
  for (std::size_t i = 0; i < set_ids.size(); ++i) {
    MeshFaceSet set{set_names[i], set_ids[i], {}};
    const std::string number = std::to_string(i + 1);
    Integers elements, sides;
    const bool full = is_full(status, i);
    if (full && (!read("elem_ss" + number, elements) || !read("side_ss" + number, sides))) continue;
    if (elements.size() != sides.size()) {
      error("side set", "side set " + in_quotes(set.name) + " has not as many sides as elements");
      continue;
    }
    std::int64_t left_out = 0;
    for (std::size_t k = 0; k < sides.size(); ++k) add_side(elements[k], sides[k], set, left_out);
    if (left_out > 0)
      errors_.warn({}, "side set " + in_quotes(set.name) + " has " + std::to_string(left_out) +
                           " sides of elements that are no solids, which are left out");
    mesh_.face_sets.push_back(std::move(set));
  }
}

void ExodusReader::add_side(std::int64_t element, std::int64_t side, MeshFaceSet& to, std::int64_t& left_out) {
  if (element < 1 || element > static_cast<std::int64_t>(cell_of_.size()))
    return error("unknown element", "side set " + in_quotes(to.name) + " has element " + std::to_string(element) +
                                        "; expected 1 to " + std::to_string(cell_of_.size()));
  const std::int32_t index = cell_of_[static_cast<std::size_t>(element - 1)];
  if (index < 0) {
    ++left_out;
    return;
  }
  const auto cell = static_cast<std::size_t>(index);
  const ExodusType& type = *type_of_cell_[cell];
  const bool exists = side >= 1 && side <= 6 && type.sides[static_cast<std::size_t>(side - 1)][0] != 0;
  if (!exists)
    return error("side", "side set " + in_quotes(to.name) + " has side " + std::to_string(side) + " of an element " +
                             type.prefix + ", which has no such side");
  const std::array<int, 4>& corners = type.sides[static_cast<std::size_t>(side - 1)];
  std::array<std::int32_t, 4> face{};
  for (std::size_t k = 0; k < 4; ++k) {
    const int corner = (corners[k] == 0 ? corners[2] : corners[k]) - 1;
    const auto at = std::find(type.order.begin(), type.order.end(), corner) - type.order.begin();
    face[k] = mesh_.cells[cell][static_cast<std::size_t>(at)];
  }
  to.faces.push_back(face);
}

}  // namespace

FileMesh read_exodus(const MeshFileText& file, Diagnostics& diagnostics) {
  return ExodusReader(file, diagnostics).read();
}

}  // namespace kerf
