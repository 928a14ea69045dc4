// Compares the 24 turned orders of a brick's corners with the collapsed forms.
#include "decks/solid_shape.hpp"

#include <algorithm>
#include <vector>

namespace kerf::decks {
namespace {

using Nodes = std::array<std::int32_t, 8>;
using Order = std::array<std::uint8_t, 8>;

Order after(const Order& a, const Order& b) {
  Order c{};
  for (std::size_t k = 0; k < 8; ++k) c[k] = a[b[k]];
  return c;
}

/// All rotations of a cube, from two quarter turns.
std::vector<Order> rotations() {
  const Order about_z = {1, 2, 3, 0, 5, 6, 7, 4}, about_x = {3, 2, 6, 7, 0, 1, 5, 4};
  std::vector<Order> found = {{0, 1, 2, 3, 4, 5, 6, 7}};
  for (std::size_t k = 0; k < found.size(); ++k)
    for (const Order& turn : {about_z, about_x}) {
      const Order next = after(found[k], turn);
      if (std::find(found.begin(), found.end(), next) == found.end()) found.push_back(next);
    }
  return found;
}

bool same(const Nodes& n, std::size_t first, std::size_t last) {
  for (std::size_t k = first + 1; k <= last; ++k)
    if (n[k] != n[first]) return false;
  return true;
}

}  // namespace

int n_distinct(const Nodes& nodes) {
  Nodes sorted = nodes;
  std::sort(sorted.begin(), sorted.end());
  return static_cast<int>(std::unique(sorted.begin(), sorted.end()) - sorted.begin());
}

RecognisedSolid recognised(const Nodes& nodes) {
  const int n = n_distinct(nodes);
  if (n == 8) return {true, SolidShape::hex8, nodes};
  static const std::vector<Order> all = rotations();
  for (const Order& order : all) {
    Nodes t{};
    for (std::size_t k = 0; k < 8; ++k) t[k] = nodes[order[k]];
    if (n == 6 && t[2] == t[3] && t[6] == t[7])
      return {true, SolidShape::wedge6, {t[0], t[1], t[2], t[2], t[4], t[5], t[6], t[6]}};
    if (n == 5 && same(t, 4, 7)) return {true, SolidShape::pyramid5, {t[0], t[1], t[2], t[3], t[4], t[4], t[4], t[4]}};
    if (n == 4 && t[2] == t[3] && same(t, 4, 7))
      return {true, SolidShape::tet4, {t[0], t[1], t[2], t[2], t[4], t[4], t[4], t[4]}};
    if (n == 4 && same(t, 3, 7)) return {true, SolidShape::tet4, {t[0], t[1], t[2], t[2], t[3], t[3], t[3], t[3]}};
  }
  return {false, SolidShape::hex8, nodes};
}

Nodes mirrored(const RecognisedSolid& solid) {
  const Nodes& n = solid.nodes;
  switch (solid.shape) {
    case SolidShape::wedge6:
      return {n[4], n[5], n[6], n[6], n[0], n[1], n[2], n[2]};
    case SolidShape::pyramid5:
      return {n[0], n[3], n[2], n[1], n[4], n[4], n[4], n[4]};
    case SolidShape::tet4:
    case SolidShape::tet10:
      return {n[1], n[0], n[2], n[2], n[4], n[4], n[4], n[4]};
    case SolidShape::hex8:
      break;
  }
  return {n[4], n[5], n[6], n[7], n[0], n[1], n[2], n[3]};
}

}  // namespace kerf::decks
