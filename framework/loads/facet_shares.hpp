// How a pressure on a facet is shared by its corners.
#pragma once

#include <array>

#include "kerf/math.hpp"

namespace kerf {

/// The vectors of area [m2] that belong to the corners x of a facet: the integrals of N_a n dA over the bilinear
/// surface through the corners, with the shape function N_a of corner a and the normal n to which the corners run
/// counter-clockwise. Their sum is the vector of the whole area. A triangle repeats its last corner.
///
/// With x = a + b s + c t + d s t and (s, t) in [-1, 1]^2, n dA = (b x c + s b x d + t d x c) ds dt, and the integral
/// with N_a = (1 + s_a s)(1 + t_a t)/4 is b x c + (s_a/3) b x d + (t_a/3) d x c. The derivative of the volume of a
/// hexahedron by the position of a corner is the sum of these over its faces, so that a uniform pressure all round a
/// body meets the forces of uniform stress exactly.
inline std::array<Vec3, 4> facet_shares(const std::array<Vec3, 4>& x) {
  const Vec3 b = (x[1] - x[0] + x[2] - x[3]) * 0.25, c = (x[3] - x[0] + x[2] - x[1]) * 0.25;
  const Vec3 d = (x[0] - x[1] + x[2] - x[3]) * 0.25;
  const Vec3 middle = cross(b, c), by_s = cross(b, d) * (1.0 / 3.0), by_t = cross(d, c) * (1.0 / 3.0);
  return {middle - by_s - by_t, middle + by_s - by_t, middle + by_s + by_t, middle - by_s + by_t};
}

}  // namespace kerf
