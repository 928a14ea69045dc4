// Volume of eight-node hexahedra.
#pragma once

#include <kerf/shape.hpp>

namespace kerf::hex8 {

/// Volume of a trilinear hexahedron, exact also for warped faces [m3]; equals the volume of the mean gradient of
/// Flanagan & Belytschko (1981). Negative where the element is inside out. Source: J. Grandy, "Efficient computation of
/// volume of hexahedral cells", UCRL-ID-128886 (1997), the tetrakis form.
inline double volume_of(const CellCorners& x) {
  const auto d = [&x](int i, int j) { return x[static_cast<std::size_t>(i)] - x[static_cast<std::size_t>(j)]; };
  const auto triple = [](Vec3 a, Vec3 b, Vec3 c) { return dot(a, cross(b, c)); };
  return (triple(d(3, 1) + d(7, 2), d(6, 3), d(2, 0)) + triple(d(4, 3) + d(5, 7), d(6, 4), d(7, 0)) +
          triple(d(1, 4) + d(2, 5), d(6, 1), d(5, 0))) /
         12.0;
}

}  // namespace kerf::hex8
