// The element of tests/plugin/wedge, compiled into the test program.
#pragma once

#include "support/one_part.hpp"

void kerf_register_wedge(kerf::Registrar& registrar);

namespace kerf::test {

inline std::unique_ptr<Element> make_wedge(const std::string& parameters) {
  static const Registry registry = [] {
    Registry r;
    kerf_register_wedge(r);
    return r;
  }();
  return make_law<Element>("element", "wedge", parameters, nullptr, registry);
}

/// The same nodes, with two wedges in place of each hexahedron.
inline CellMesh in_wedges(const CellMesh& hexahedra) {
  static const std::unique_ptr<Element> wedge = make_wedge("{}");
  constexpr int corners[2][6] = {{0, 3, 1, 4, 7, 5}, {2, 1, 3, 6, 5, 7}};
  CellMesh mesh{hexahedra.x, {}, &wedge->shape()};
  for (const auto& e : hexahedra.elements)
    for (const auto& half : corners) {
      std::array<std::int32_t, 8> nodes{};
      for (int k = 0; k < 6; ++k) nodes[k] = e[half[k]];
      mesh.elements.push_back(nodes);
    }
  return mesh;
}

}  // namespace kerf::test
