// Meshes of bricks, wedges, pyramids and tetrahedra that fit together, all as hexahedra with corners that coincide.
#pragma once

#include <map>

#include "kerf/collapsed_cell.hpp"
#include "support/one_part.hpp"

namespace kerf::test {

/// What a brick of a block is cut into. Two wedges have a diagonal in the plane of x and y, so that wedges stand in
/// whole columns along z. Six pyramids have their tips in the middle; a pyramid is two tetrahedra where both sides of
/// its base want them.
enum class Cut { brick, wedges, pyramids, tetrahedra };

using CutOf = Cut (*)(int i, int j, int k);

/// Of three bricks along each direction: all kinds, next to each other.
inline Cut all_cuts(int i, int j, int k) {
  if (i == 1 && j == 1) return Cut::wedges;
  constexpr Cut others[3] = {Cut::brick, Cut::pyramids, Cut::tetrahedra};
  return others[(i + j + k) % 3];
}

/// Cuts a block that distorted_block() has made.
class CutBlock {
 public:
  CutBlock(const CellMesh& bricks, int nx, int ny, int nz, CutOf cut)
      : mesh_{bricks.x, {}, &hexahedron}, n_{nx, ny, nz}, cut_(cut) {
    for (int i = 0; i < nx; ++i)
      for (int j = 0; j < ny; ++j)
        for (int k = 0; k < nz; ++k) add(bricks.elements[static_cast<std::size_t>((i * ny + j) * nz + k)], {i, j, k});
  }
  const CellMesh& mesh() const { return mesh_; }

 private:
  using Nodes = std::array<std::int32_t, 8>;

  void add(const Nodes& n, std::array<int, 3> at) {
    const Cut cut = cut_(at[0], at[1], at[2]);
    if (cut == Cut::brick) mesh_.elements.push_back(n);
    if (cut == Cut::wedges)
      for (const Nodes& half : {Nodes{n[0], n[1], n[3], n[3], n[4], n[5], n[7], n[7]},
                                Nodes{n[1], n[2], n[3], n[3], n[5], n[6], n[7], n[7]}})
        mesh_.elements.push_back(in_order_of_kind(half));
    if (cut == Cut::brick || cut == Cut::wedges) return;
    Vec3 middle;
    for (const std::int32_t node : n) middle = middle + mesh_.x[static_cast<std::size_t>(node)] * 0.125;
    const auto tip = static_cast<std::int32_t>(mesh_.x.size());
    mesh_.x.push_back(middle);
    constexpr int way[6][3] = {{0, 0, -1}, {0, 0, 1}, {0, -1, 0}, {1, 0, 0}, {0, 1, 0}, {-1, 0, 0}};
    for (int f = 0; f < 6; ++f) {
      // Seen from the middle, a face runs the other way round.
      std::array<std::int32_t, 4> base{};
      for (std::size_t k = 0; k < 4; ++k) base[k] = n[static_cast<std::size_t>(hexahedron.face[f][3 - k])];
      bool is_cut = cut == Cut::tetrahedra, is_inside = true;
      std::array<int, 3> beyond = at;
      for (int d = 0; d < 3; ++d) {
        beyond[d] += way[f][d];
        is_inside = is_inside && beyond[d] >= 0 && beyond[d] < n_[d];
      }
      if (is_inside) is_cut = is_cut && cut_(beyond[0], beyond[1], beyond[2]) == Cut::tetrahedra;
      if (!is_cut) {
        mesh_.elements.push_back({base[0], base[1], base[2], base[3], tip, tip, tip, tip});
        continue;
      }
      // The diagonal from the lowest node is the same from either side.
      std::rotate(base.begin(), std::min_element(base.begin(), base.end()), base.end());
      mesh_.elements.push_back({base[0], base[1], base[1], base[2], tip, tip, tip, tip});
      mesh_.elements.push_back({base[0], base[2], base[2], base[3], tip, tip, tip, tip});
    }
  }

  CellMesh mesh_;
  std::array<int, 3> n_;
  CutOf cut_;
};

}  // namespace kerf::test
