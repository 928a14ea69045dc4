// Entities, nodes and elements in the form 4.1 of Gmsh.
#include "mesh/gmsh_reader.hpp"

namespace kerf::gmsh {

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

}  // namespace kerf::gmsh
