// Writes a small mesh in every format of Gmsh.
#include "support/mesh_files.hpp"

#include <cstring>

namespace kerf::test {
namespace {

struct Node {
  std::int64_t tag;
  int entity;  // a volume, or 1 for the nodes on a surface
  double x, y, z;
};
/// Nodes of entity 1 lie on a surface and have parameters, the ones of entity 7 lie in a volume.
constexpr Node nodes[] = {{10, 1, 0, 0, 0},      {20, 1, 1, 0, 0},  {30, 1, 1, 1, 0},    {40, 1, 0, 1, 0},
                          {1000000, 7, 0, 0, 1}, {60, 7, 1, 0, 1},  {70, 7, 1, 1, 1},    {80, 7, 0, 1, 1},
                          {9, 7, 2, 0, 0.5},     {8, 7, 2, 1, 0.5}, {7, 7, 0.5, 0.5, 2}, {5, 7, 1.5, 0.5, 3}};

struct Element {
  std::int64_t tag;
  int type, physical, dimension, entity;
  std::vector<std::int64_t> nodes;
};
const std::vector<Element> elements = {{500, 5, 3, 3, 7, {10, 20, 30, 40, 1000000, 60, 70, 80}},
                                       {400, 6, 3, 3, 7, {20, 60, 9, 30, 70, 8}},
                                       {300, 7, 3, 3, 7, {1000000, 60, 70, 80, 7}},
                                       {200, 4, 4, 3, 8, {60, 70, 7, 5}},
                                       {100, 3, 2, 2, 1, {10, 40, 30, 20}},
                                       {99, 2, 2, 2, 1, {20, 9, 60}},
                                       {98, 1, 1, 1, 1, {10, 20}},
                                       {97, 15, 5, 0, 1, {9}},
                                       {96, 1, 0, 1, 2, {20, 30}}};

class Writer {
 public:
  explicit Writer(const GmshFormat& format) : format_(format) {}
  void text(const std::string& line) { out_ += line + "\n"; }
  void integer(std::int64_t value) {
    format_.binary ? put(static_cast<std::int32_t>(value)) : word(std::to_string(value));
  }
  void size(std::int64_t value) { format_.binary ? put(value) : word(std::to_string(value)); }
  void real(double value) { format_.binary ? put(value) : word(std::to_string(value)); }
  void end() {
    if (!format_.binary) out_ += "\n";
  }
  std::string out_;

 private:
  void word(const std::string& w) { out_ += w + " "; }
  template <class Value>
  void put(Value value) {
    char bytes[sizeof(Value)];
    std::memcpy(bytes, &value, sizeof(Value));
    if (format_.swapped) std::reverse(bytes, bytes + sizeof(Value));
    out_.append(bytes, sizeof(Value));
  }
  GmshFormat format_;
};

void write_head(Writer& w, const GmshFormat& format) {
  w.text("$MeshFormat");
  w.text((format.version == 22 ? "2.2 " : "4.1 ") + std::string(format.binary ? "1 8" : "0 8"));
  if (format.binary) {
    w.integer(1);
    w.text("");
  }
  w.text("$EndMeshFormat\n$Comments\nno mesh\n$EndComments");
  w.text(
      "$PhysicalNames\n5\n0 5 \"pin\"\n1 1 \"edge\"\n2 2 \"two faces\"\n3 3 \"body\"\n3 4 \"tip\"\n$EndPhysicalNames");
}

void write_22(Writer& w, const GmshFormat& format) {
  const std::string section = format.parametric ? "ParametricNodes" : "Nodes";
  w.text("$" + section + "\n" + std::to_string(std::size(nodes)));
  for (const Node& node : nodes) {
    w.integer(node.tag);
    for (const double x : {node.x, node.y, node.z}) w.real(x);
    if (format.parametric) {
      w.integer(node.entity == 1 ? 2 : 3);
      w.integer(node.entity);
      if (node.entity == 1) w.real(0.25), w.real(0.75);
    }
    w.end();
  }
  w.text((format.binary ? "\n$End" : "$End") + section);
  w.text("$Elements\n" + std::to_string(elements.size()));
  for (const Element& e : elements) {
    if (format.binary) w.integer(e.type), w.integer(1), w.integer(2);
    w.integer(e.tag);
    if (!format.binary) w.integer(e.type), w.integer(2);
    w.integer(e.physical);
    w.integer(e.entity);
    for (const std::int64_t node : e.nodes) w.integer(node);
    w.end();
  }
  w.text(format.binary ? "\n$EndElements" : "$EndElements");
}

/// Points, curves, surfaces and volumes: number, box, physical groups, boundary.
void write_entities(Writer& w) {
  struct Entity {
    int dimension, tag, physical;
  };
  constexpr Entity entities[] = {{0, 1, 5}, {1, 1, 1}, {1, 2, 0}, {2, 1, 2}, {3, 7, 3}, {3, 8, 4}};
  for (const int n : {1, 2, 1, 2}) w.size(n);
  w.end();
  for (const Entity& e : entities) {
    w.integer(e.tag);
    for (int i = 0; i < (e.dimension == 0 ? 3 : 6); ++i) w.real(0.5);
    w.size(e.physical > 0 ? 1 : 0);
    if (e.physical > 0) w.integer(e.dimension == 2 ? -e.physical : e.physical);
    if (e.dimension > 0) w.size(2), w.integer(1), w.integer(-1);
    w.end();
  }
}

void write_nodes_41(Writer& w, const GmshFormat& format) {
  w.size(2), w.size(std::size(nodes)), w.size(5), w.size(1000000), w.end();
  for (const int entity : {1, 7}) {
    const bool parametric = format.parametric && entity == 1;
    w.integer(entity == 1 ? 2 : 3), w.integer(entity), w.integer(parametric ? 1 : 0);
    w.size(entity == 1 ? 4 : 8), w.end();
    for (const Node& node : nodes)
      if (node.entity == entity) w.size(node.tag), w.end();
    for (const Node& node : nodes) {
      if (node.entity != entity) continue;
      for (const double x : {node.x, node.y, node.z}) w.real(x);
      if (parametric) w.real(0.25), w.real(0.75);
      w.end();
    }
  }
}

void write_41(Writer& w, const GmshFormat& format) {
  const std::string newline = format.binary ? "\n" : "";
  w.text("$Entities");
  write_entities(w);
  w.text(newline + "$EndEntities\n$Nodes");
  write_nodes_41(w, format);
  w.text(newline + "$EndNodes\n$Elements");
  w.size(static_cast<std::int64_t>(elements.size())), w.size(static_cast<std::int64_t>(elements.size()));
  w.size(96), w.size(500), w.end();
  for (const Element& e : elements) {
    w.integer(e.dimension), w.integer(e.entity), w.integer(e.type), w.size(1), w.end();
    w.size(e.tag);
    for (const std::int64_t node : e.nodes) w.size(node);
    w.end();
  }
  w.text(newline + "$EndElements");
}

}  // namespace

std::string small_gmsh_mesh(const GmshFormat& format) {
  Writer w(format);
  write_head(w, format);
  format.version == 22 ? write_22(w, format) : write_41(w, format);
  return w.out_;
}

}  // namespace kerf::test
