// Places the instances of an Abaqus deck, finds what its sets name, and divides the elements into blocks.
#include <algorithm>
#include <charconv>
#include <cmath>
#include <limits>
#include <set>
#include <span>

#include "kerf/math.hpp"
#include "mesh/abaqus_deck.hpp"
#include "mesh/label_map.hpp"

namespace kerf {
namespace {

using Indices = std::vector<std::int32_t>;

struct NamedSet {
  std::string name;  // as the deck writes it first
  std::int64_t label = 0;
  FilePlace place;
  Indices members;
  bool has_left_out = false;
};
using Sets = std::map<std::string, NamedSet>;  // by the name in capitals

/// One instance, or the model itself: where its nodes and cells are in the mesh, and its sets.
struct Placed {
  std::string name;  // empty for the model
  std::int32_t first_node = 0, first_cell = 0;
  LabelMap nodes, cells;  // to indices that count from first_node and first_cell
  std::span<const std::int64_t> node_labels, cell_labels;
  std::vector<std::int64_t> left_labels;  // sorted
  Sets node_sets, cell_sets;
};

/// Corners of the faces S1 to S6 from 1, 0 where a triangle has no fourth. The manual of Abaqus lists them as they are
/// seen from inside; here they go the other way round.
using Faces = std::array<std::array<int, 4>, 6>;
constexpr Faces hexahedron_faces{{{1, 4, 3, 2}, {5, 6, 7, 8}, {1, 2, 6, 5}, {2, 3, 7, 6}, {3, 4, 8, 7}, {4, 1, 5, 8}}};
constexpr Faces wedge_faces{{{1, 3, 2, 0}, {4, 5, 6, 0}, {1, 2, 5, 4}, {2, 3, 6, 5}, {3, 1, 4, 6}, {}}};
constexpr Faces pyramid_faces{{{1, 4, 3, 2}, {1, 2, 5, 0}, {2, 3, 5, 0}, {3, 4, 5, 0}, {4, 1, 5, 0}, {}}};
constexpr Faces tetrahedron_faces{{{1, 3, 2, 0}, {1, 2, 4, 0}, {2, 3, 4, 0}, {3, 1, 4, 0}, {}, {}}};

const Faces& faces_of(int n_corners) {
  return n_corners == 4   ? tetrahedron_faces
         : n_corners == 5 ? pyramid_faces
         : n_corners == 6 ? wedge_faces
                          : hexahedron_faces;
}

/// Where the corners of a solid stand among its eight nodes.
constexpr std::array<int, 8> corner_at(int n_corners) {
  if (n_corners == 4) return {0, 1, 2, 4};
  if (n_corners == 6) return {0, 1, 2, 4, 5, 6};
  return {0, 1, 2, 3, 4, 5, 6, 7};
}

Vec3 vector_of(const std::array<double, 3>& x) { return {x[0], x[1], x[2]}; }

/// Shifts points and then turns them: Rodrigues' formula, exact for multiples of a right angle.
void place_points(std::span<std::array<double, 3>> points, const AbaqusInstance& instance) {
  const auto& t = instance.turn;
  const Vec3 shift = vector_of(instance.shift), about{t[0], t[1], t[2]}, to{t[3], t[4], t[5]};
  const Vec3 axis = instance.is_turned ? (to - about) * (1.0 / norm(to - about)) : Vec3{};
  constexpr double radians = 3.14159265358979323846 / 180.0;
  double c = kerf::cos(t[6] * radians), s = kerf::sin(t[6] * radians);
  if (std::fabs(c) < 1e-15) c = 0.0;
  if (std::fabs(s) < 1e-15) s = 0.0;
  for (auto& point : points) {
    Vec3 x = vector_of(point) + shift;
    if (instance.is_turned) {
      const Vec3 v = x - about;
      x = v * c + cross(axis, v) * s + axis * (dot(axis, v) * (1.0 - c)) + about;
    }
    point = {x.x, x.y, x.z};
  }
}

/// Appends `from` to `to`. The last time that `from` is needed it need not be copied.
template <class Value>
void append(std::vector<Value>& to, std::vector<Value>& from, bool last) {
  if (to.empty() && last)
    to = std::move(from);
  else
    to.insert(to.end(), from.begin(), from.end());
}

class Assembler {
 public:
  Assembler(AbaqusDeck& deck, MeshErrors& errors) : deck_(deck), errors_(errors) {}
  FileMesh assemble();

 private:
  struct Offsets {
    std::int32_t node = 0, cell = 0;
  };
  /// A body that has been placed: whose sets are to be found, and where its own nodes and cells begin.
  struct Source {
    AbaqusBody* body = nullptr;
    Placed* placed = nullptr;
    Offsets offsets;
  };
  void place_all();
  void place(Placed& placed, std::span<AbaqusBody* const> bodies, std::span<const bool> last);
  bool fits(const Placed& placed, const AbaqusBody& body);
  void finish_labels(Placed& placed, std::span<const std::int32_t> node_lines);
  void find_nodes_of_cells(Placed& placed);
  AbaqusBody* part_of(const AbaqusInstance& instance);
  void find_sets(const Source& source);
  void add_item(const Source& source, const AbaqusSet& set, const AbaqusItem& item, Placed& scope, NamedSet& to);
  void add_labels(const AbaqusSet& set, const AbaqusItem& item, Placed& scope, NamedSet& to);
  void add_generated(const AbaqusSet& set, const AbaqusItem& item, const Placed& scope, NamedSet& to);
  void add_nodes_of(const AbaqusSet& set, Placed& scope, NamedSet& to);
  const NamedSet* find_set(const std::string& name, bool of_cells, Placed& scope, FilePlace place);
  Placed* instance_named(const std::string& name);
  void find_surfaces(const Source& source);
  void find_faces(const AbaqusSurface::Face& face, Placed& placed, MeshFaceSet& to);
  void add_face(std::int32_t cell, const AbaqusSurface::Face& face, MeshFaceSet& to);
  void make_blocks();
  void add_block(const std::string& name, const Indices& cells, FilePlace place, bool only_free);
  void hand_over_sets();

  AbaqusDeck& deck_;
  MeshErrors& errors_;
  FileMesh mesh_;
  std::deque<Placed> placed_;  // the model first
  std::map<std::string, Placed*> instances_;
  std::vector<Source> sources_;
  std::vector<std::uint8_t> n_corners_;
  std::vector<bool> in_block_;
  std::set<std::string> block_names_;
};

std::string full_name(const Placed& placed, const std::string& name) {
  return placed.name.empty() ? name : placed.name + "." + name;
}

FileMesh Assembler::assemble() {
  mesh_.format = "Abaqus";
  if (errors_.count() > 0) return std::move(mesh_);
  place_all();
  if (errors_.count() > 0) return std::move(mesh_);
  for (const Source& source : sources_) find_sets(source);
  for (const Source& source : sources_) find_surfaces(source);
  make_blocks();
  hand_over_sets();
  return std::move(mesh_);
}

// ---- placing ---------------------------------------------------------------------------------------------------

AbaqusBody* Assembler::part_of(const AbaqusInstance& instance) {
  for (AbaqusBody& part : deck_.parts)
    if (upper(part.name) == upper(instance.part)) return &part;
  errors_.at(instance.own.place, "instance",
             "there is no part " + in_quotes(instance.part) + "; expected the name of a *PART above");
  return nullptr;
}

/// Instances come first and the model last, for sets of the model name those of instances.
void Assembler::place_all() {
  std::map<AbaqusBody*, int> uses;
  std::vector<AbaqusBody*> parts;
  for (const AbaqusInstance& instance : deck_.instances) {
    parts.push_back(part_of(instance));
    ++uses[parts.back()];
  }
  if (deck_.instances.empty() && !deck_.parts.empty())
    errors_.at(deck_.parts[0].place, "part", "no part has an instance; expected *INSTANCE in an *ASSEMBLY");
  if (errors_.count() > 0) return;
  for (std::size_t i = 0; i < parts.size() && errors_.count() == 0; ++i) {
    AbaqusInstance& instance = deck_.instances[i];
    Placed& placed = placed_.emplace_back();
    placed.name = instance.own.name;
    instances_[upper(placed.name)] = &placed;
    AbaqusBody* const bodies[2] = {parts[i], &instance.own};
    const bool last[2] = {--uses[parts[i]] == 0, true};
    const Vec3 a{instance.turn[0], instance.turn[1], instance.turn[2]};
    const Vec3 b{instance.turn[3], instance.turn[4], instance.turn[5]};
    if (instance.is_turned && !(norm(b - a) > 0.0))
      errors_.at(instance.own.place, "instance", "the axis of the turn has no length; expected two different points");
    place(placed, bodies, last);
    place_points(std::span(mesh_.points).subspan(static_cast<std::size_t>(placed.first_node)), instance);
  }
  if (errors_.count() > 0) return;
  AbaqusBody* const bodies[1] = {&deck_.model};
  const bool last[1] = {true};
  place(placed_.emplace_back(), bodies, last);
  for (Placed& placed : placed_) {
    placed.node_labels =
        std::span(mesh_.node_labels).subspan(static_cast<std::size_t>(placed.first_node), placed.node_labels.size());
    placed.cell_labels =
        std::span(mesh_.cell_labels).subspan(static_cast<std::size_t>(placed.first_cell), placed.cell_labels.size());
  }
}

bool Assembler::fits(const Placed& placed, const AbaqusBody& body) {
  constexpr std::size_t most = std::numeric_limits<std::int32_t>::max();
  if (mesh_.points.size() + body.points.size() <= most && mesh_.cells.size() + body.cells.size() <= most) return true;
  errors_.at(body.place, "size",
             "with instance " + in_quotes(placed.name) +
                 " there are more than 2147483647 nodes or "
                 "elements");
  return false;
}

void Assembler::place(Placed& placed, std::span<AbaqusBody* const> bodies, std::span<const bool> last) {
  placed.first_node = static_cast<std::int32_t>(mesh_.points.size());
  placed.first_cell = static_cast<std::int32_t>(mesh_.cells.size());
  std::vector<std::int32_t> lines;
  for (std::size_t b = 0; b < bodies.size(); ++b) {
    AbaqusBody& body = *bodies[b];
    if (!fits(placed, body)) return;
    sources_.push_back(
        {&body,
         &placed,
         {static_cast<std::int32_t>(mesh_.points.size()), static_cast<std::int32_t>(mesh_.cells.size())}});
    append(mesh_.points, body.points, last[b]);
    append(mesh_.node_labels, body.node_labels, last[b]);
    append(lines, body.node_lines, last[b]);
    append(mesh_.cells, body.cells, last[b]);
    append(mesh_.cell_labels, body.cell_labels, last[b]);
    append(mesh_.cell_places, body.cell_places, last[b]);
    append(n_corners_, body.n_corners, last[b]);
    placed.left_labels.insert(placed.left_labels.end(), body.left_labels.begin(), body.left_labels.end());
    for (const auto& [type, n] : body.left_out) mesh_.left_out[type] += n;
  }
  std::sort(placed.left_labels.begin(), placed.left_labels.end());
  finish_labels(placed, lines);
  find_nodes_of_cells(placed);
}

void Assembler::finish_labels(Placed& placed, std::span<const std::int32_t> node_lines) {
  placed.node_labels = std::span(mesh_.node_labels).subspan(static_cast<std::size_t>(placed.first_node));
  placed.cell_labels = std::span(mesh_.cell_labels).subspan(static_cast<std::size_t>(placed.first_cell));
  placed.nodes = LabelMap(placed.node_labels);
  placed.cells = LabelMap(placed.cell_labels);
  if (placed.first_node > 0 && !placed.node_labels.empty()) mesh_.labels_repeat = true;
  if (placed.first_cell > 0 && !placed.cell_labels.empty()) mesh_.labels_repeat = true;
  for (const std::int32_t i : placed.nodes.repeated()) {
    const auto at = static_cast<std::size_t>(i);
    errors_.at({node_lines[at], 1}, "repeated node",
               "node " + std::to_string(placed.node_labels[at]) + " is there twice; expected different numbers");
  }
  for (const std::int32_t i : placed.cells.repeated()) {
    const auto at = static_cast<std::size_t>(placed.first_cell + i);
    errors_.at(mesh_.cell_places[at], "repeated element",
               "element " + std::to_string(mesh_.cell_labels[at]) + " is there twice; expected different numbers");
  }
}

void Assembler::find_nodes_of_cells(Placed& placed) {
  for (auto c = static_cast<std::size_t>(placed.first_cell); c < mesh_.cells.size(); ++c)
    for (std::int32_t& node : mesh_.cells[c]) {
      const std::int32_t found = placed.nodes.find(node);
      if (found < 0)
        errors_.at(mesh_.cell_places[c], "unknown node",
                   "element " + std::to_string(mesh_.cell_labels[c]) + " has node " + std::to_string(node) +
                       ", which does not exist; expected a number from *NODE");
      node = found < 0 ? -1 : placed.first_node + found;
    }
}

// ---- sets ------------------------------------------------------------------------------------------------------

Placed* Assembler::instance_named(const std::string& name) {
  const auto found = instances_.find(upper(name));
  return found == instances_.end() ? nullptr : found->second;
}

/// A set of `scope`, or "instance.set". Null, and an error, where there is none.
const NamedSet* Assembler::find_set(const std::string& name, bool of_cells, Placed& scope, FilePlace place) {
  const auto in = [&](Placed& placed, const std::string& set) -> const NamedSet* {
    const Sets& sets = of_cells ? placed.cell_sets : placed.node_sets;
    const auto found = sets.find(upper(set));
    return found == sets.end() ? nullptr : &found->second;
  };
  const NamedSet* set = in(scope, name);
  const std::size_t dot = name.find('.');
  Placed* instance = dot == std::string::npos ? nullptr : instance_named(name.substr(0, dot));
  if (!set && instance) set = in(*instance, name.substr(dot + 1));
  if (!set)
    errors_.at(place, "unknown set",
               "there is no set of " + std::string(of_cells ? "elements " : "nodes ") + in_quotes(name) +
                   " above; expected a number or the name of a set");
  return set;
}

void Assembler::find_sets(const Source& source) {
  for (const AbaqusSet& set : source.body->sets) {
    Placed* scope = set.instance.empty() ? source.placed : instance_named(set.instance);
    if (!scope) {
      errors_.at(set.place, "instance", "there is no instance " + in_quotes(set.instance));
      continue;
    }
    Sets& sets = set.of_cells ? source.placed->cell_sets : source.placed->node_sets;
    NamedSet& to = sets[upper(set.name)];
    if (to.name.empty()) to = {set.name, static_cast<std::int64_t>(sets.size()), set.place, {}, false};
    to.has_left_out = to.has_left_out || set.has_left_out;
    if (!set.nodes_of.empty()) add_nodes_of(set, *scope, to);
    for (const AbaqusItem& item : set.items) add_item(source, set, item, *scope, to);
    std::sort(to.members.begin(), to.members.end());
    to.members.erase(std::unique(to.members.begin(), to.members.end()), to.members.end());
  }
}

void Assembler::add_item(const Source& source, const AbaqusSet& set, const AbaqusItem& item, Placed& scope,
                         NamedSet& to) {
  if (item.kind == AbaqusItem::Kind::labels) return add_labels(set, item, scope, to);
  if (item.kind == AbaqusItem::Kind::generated) return add_generated(set, item, scope, to);
  if (item.kind == AbaqusItem::Kind::order) {
    const std::int32_t offset = set.of_cells ? source.offsets.cell : source.offsets.node;
    for (std::int64_t i = item.first; i <= item.last; ++i) to.members.push_back(offset + static_cast<std::int32_t>(i));
    return;
  }
  const std::string& name = source.body->names[static_cast<std::size_t>(item.name)];
  const std::size_t dot = name.rfind('.');
  Placed* instance = dot == std::string::npos ? nullptr : instance_named(name.substr(0, dot));
  AbaqusItem label = item;
  const char* end = name.data() + name.size();
  const auto [stop, error] = std::from_chars(end - (instance ? name.size() - dot - 1 : 0), end, label.first);
  if (instance && error == std::errc{} && stop == end) {  // instance.label
    label.last = label.first;
    return add_labels(set, label, *instance, to);
  }
  const NamedSet* other = find_set(name, set.of_cells, scope, item.place);
  if (!other) return;
  const Indices members = other->members;  // it may be the set itself
  to.members.insert(to.members.end(), members.begin(), members.end());
  to.has_left_out = to.has_left_out || other->has_left_out;
}

/// Labels of elements that are no solids are left out of sets.
void Assembler::add_labels(const AbaqusSet& set, const AbaqusItem& item, Placed& scope, NamedSet& to) {
  const LabelMap& map = set.of_cells ? scope.cells : scope.nodes;
  const std::int32_t offset = set.of_cells ? scope.first_cell : scope.first_node;
  for (std::int64_t label = item.first;; ++label) {
    const std::int32_t index = map.find(label);
    if (index >= 0) {
      to.members.push_back(offset + index);
    } else if (set.of_cells && std::binary_search(scope.left_labels.begin(), scope.left_labels.end(), label)) {
      to.has_left_out = true;
    } else {
      errors_.at(item.place, "unknown label",
                 "set " + in_quotes(set.name) + " has " + (set.of_cells ? "element " : "node ") +
                     std::to_string(label) + ", which does not exist; expected a number from " +
                     (set.of_cells ? "*ELEMENT" : "*NODE"));
    }
    if (label == item.last) return;
  }
}

/// GENERATE takes what exists between two labels; how much is missing is a warning.
void Assembler::add_generated(const AbaqusSet& set, const AbaqusItem& item, const Placed& scope, NamedSet& to) {
  const LabelMap& map = set.of_cells ? scope.cells : scope.nodes;
  const std::int32_t offset = set.of_cells ? scope.first_cell : scope.first_node;
  const std::span<const std::int64_t> labels = set.of_cells ? scope.cell_labels : scope.node_labels;
  const std::int64_t n = (item.last - item.first) / item.step + 1;
  std::int64_t found = 0;
  const auto take = [&](std::int32_t index) {
    to.members.push_back(offset + index);
    ++found;
  };
  if (n <= static_cast<std::int64_t>(labels.size())) {
    for (std::int64_t label = item.first; label <= item.last; label += item.step)
      if (const std::int32_t index = map.find(label); index >= 0) take(index);
  } else {
    for (std::size_t i = 0; i < labels.size(); ++i)
      if (labels[i] >= item.first && labels[i] <= item.last && (labels[i] - item.first) % item.step == 0)
        take(static_cast<std::int32_t>(i));
  }
  const auto& left = scope.left_labels;
  const auto from = std::lower_bound(left.begin(), left.end(), item.first);
  for (auto label = from; set.of_cells && label != left.end() && *label <= item.last; ++label)
    if ((*label - item.first) % item.step == 0) {
      to.has_left_out = true;
      ++found;
    }
  if (found < n)
    errors_.warn(item.place, "set " + in_quotes(set.name) + " has " + std::to_string(n) + " numbers, of which " +
                                 std::to_string(n - found) + " do not exist");
}

void Assembler::add_nodes_of(const AbaqusSet& set, Placed& scope, NamedSet& to) {
  const NamedSet* cells = find_set(set.nodes_of, true, scope, set.place);
  if (!cells) return;
  if (cells->has_left_out)
    errors_.warn(set.place, "set " + in_quotes(set.name) + " has no nodes of elements that are no solids");
  for (const std::int32_t cell : cells->members) {
    const auto& nodes = mesh_.cells[static_cast<std::size_t>(cell)];
    to.members.insert(to.members.end(), nodes.begin(), nodes.end());
  }
}

// ---- surfaces --------------------------------------------------------------------------------------------------

void Assembler::find_surfaces(const Source& source) {
  for (const AbaqusSurface& surface : source.body->surfaces) {
    MeshFaceSet to;
    to.name = full_name(*source.placed, surface.name);
    to.label = static_cast<std::int64_t>(mesh_.face_sets.size()) + 1;
    for (const AbaqusSurface::Face& face : surface.faces) find_faces(face, *source.placed, to);
    mesh_.face_sets.push_back(std::move(to));
  }
}

void Assembler::find_faces(const AbaqusSurface::Face& face, Placed& placed, MeshFaceSet& to) {
  std::int64_t label = 0;
  const char *begin = face.cells.data(), *end = begin + face.cells.size();
  const auto [stop, error] = std::from_chars(begin, end, label);
  if (error == std::errc{} && stop == end) {
    const std::int32_t index = placed.cells.find(label);
    if (index >= 0) return add_face(placed.first_cell + index, face, to);
    errors_.at(face.place, "unknown label",
               "surface " + in_quotes(to.name) + " has element " + face.cells +
                   ", which is no solid; expected a number from *ELEMENT");
    return;
  }
  const NamedSet* cells = find_set(face.cells, true, placed, face.place);
  if (!cells) return;
  if (cells->has_left_out)
    errors_.warn(face.place, "surface " + in_quotes(to.name) + " has no faces of elements that are no solids");
  for (const std::int32_t cell : cells->members) add_face(cell, face, to);
}

void Assembler::add_face(std::int32_t cell, const AbaqusSurface::Face& face, MeshFaceSet& to) {
  const auto c = static_cast<std::size_t>(cell);
  const std::array<int, 8> at = corner_at(n_corners_[c]);
  const std::array<int, 4> corners = faces_of(n_corners_[c])[static_cast<std::size_t>(face.number - 1)];
  if (corners[0] == 0) {
    errors_.at(face.place, "face",
               "element " + std::to_string(mesh_.cell_labels[c]) + " has no face S" + std::to_string(face.number));
    return;
  }
  std::array<std::int32_t, 4> nodes{};
  for (std::size_t k = 0; k < 4; ++k) {
    const int corner = corners[k] == 0 ? corners[2] : corners[k];
    nodes[k] = mesh_.cells[c][static_cast<std::size_t>(at[static_cast<std::size_t>(corner - 1)])];
  }
  to.faces.push_back(nodes);
}

// ---- blocks ----------------------------------------------------------------------------------------------------

/// Adds a block of `cells`, or, with `only_free`, of the ones that are in no block yet.
void Assembler::add_block(const std::string& name, const Indices& cells, FilePlace place, bool only_free) {
  MeshBlock block{name, static_cast<std::int64_t>(mesh_.blocks.size()) + 1, {}, place};
  for (const std::int32_t cell : cells)
    if (!only_free || !in_block_[static_cast<std::size_t>(cell)]) block.cells.push_back(cell);
  for (const std::int32_t cell : block.cells) in_block_[static_cast<std::size_t>(cell)] = true;
  if (only_free && block.cells.empty()) return;
  block_names_.insert(name);
  mesh_.blocks.push_back(std::move(block));
}

/// First the sets of sections, then for the rest the sets that *ELEMENT names, then for the rest one block an instance.
void Assembler::make_blocks() {
  in_block_.assign(mesh_.cells.size(), false);
  for (const Source& source : sources_)
    for (const AbaqusUse& section : source.body->sections) {
      const NamedSet* cells = find_set(section.set, true, *source.placed, section.place);
      if (cells && !(cells->members.empty() && cells->has_left_out))
        add_block(full_name(*source.placed, cells->name), cells->members, section.place, false);
    }
  for (const Source& source : sources_)
    for (const AbaqusUse& element : source.body->element_sets)
      if (const NamedSet* cells = find_set(element.set, true, *source.placed, element.place))
        add_block(full_name(*source.placed, cells->name), cells->members, element.place, true);
  for (const Placed& placed : placed_) {
    Indices all(placed.cell_labels.size());
    for (std::size_t i = 0; i < all.size(); ++i) all[i] = placed.first_cell + static_cast<std::int32_t>(i);
    add_block(placed.name.empty() ? "elements" : placed.name, all, {}, true);
  }
}

void Assembler::hand_over_sets() {
  for (Placed& placed : placed_) {
    std::map<std::int64_t, NamedSet*> nodes, cells;  // in the order of the deck
    for (auto& [name, set] : placed.node_sets) nodes[set.label] = &set;
    for (auto& [name, set] : placed.cell_sets) cells[set.label] = &set;
    for (auto& [label, set] : nodes)
      mesh_.node_sets.push_back({full_name(placed, set->name), label, std::move(set->members)});
    for (auto& [label, set] : cells)
      if (std::string name = full_name(placed, set->name); !block_names_.contains(name))
        mesh_.cell_sets.push_back({std::move(name), label, std::move(set->members), set->place});
  }
}

}  // namespace

FileMesh assemble_abaqus(AbaqusDeck& deck, MeshErrors& errors) { return Assembler(deck, errors).assemble(); }

}  // namespace kerf
