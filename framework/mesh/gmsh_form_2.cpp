// Nodes and elements in the form 2.2 of Gmsh.
#include "mesh/gmsh_reader.hpp"

namespace kerf::gmsh {

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

}  // namespace kerf::gmsh
