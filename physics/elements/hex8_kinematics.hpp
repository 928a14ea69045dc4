// Geometry and motion of the eight-node hexahedron with one integration point: mean gradient, size of the stable
// step, hourglass modes, strain and rotation of a step. For a piece of a block: as many elements as a register holds.
//
// Sources: see hex8.cpp.
#pragma once

#include <kerf/element.hpp>
#include <kerf/lanes.hpp>

namespace kerf::hex8 {

// Node renumberings under which the expression for the first node's gradient gives every other node's
// (Flanagan & Belytschko 1981, table 3).
inline constexpr int renumbered[8][8] = {{0, 1, 2, 3, 4, 5, 6, 7}, {1, 2, 3, 0, 5, 6, 7, 4}, {2, 3, 0, 1, 6, 7, 4, 5},
                                         {3, 0, 1, 2, 7, 4, 5, 6}, {4, 7, 6, 5, 0, 3, 2, 1}, {5, 4, 7, 6, 1, 0, 3, 2},
                                         {6, 5, 4, 7, 2, 1, 0, 3}, {7, 6, 5, 4, 3, 2, 1, 0}};

/// Integral of dN/dx over the element, for all nodes (Flanagan & Belytschko 1981, eq. 79); cyclic in x, y, z.
[[gnu::always_inline]] inline void integrate_gradient(const Lanes (&y)[8], const Lanes (&z)[8], Lanes (&b)[8]) {
#pragma GCC unroll 8
  for (int i = 0; i < 8; ++i) {
    const int* n = renumbered[i];
    b[i] =
        (y[n[1]] * ((z[n[5]] - z[n[2]]) - (z[n[3]] - z[n[4]])) + y[n[2]] * (z[n[1]] - z[n[3]]) +
         y[n[3]] * ((z[n[2]] - z[n[7]]) - (z[n[4]] - z[n[1]])) + y[n[4]] * ((z[n[7]] - z[n[5]]) - (z[n[1]] - z[n[3]])) +
         y[n[5]] * (z[n[4]] - z[n[1]]) + y[n[7]] * (z[n[3]] - z[n[4]])) *
        (1.0 / 12.0);
  }
}

[[gnu::always_inline]] inline Lanes dot8(const Lanes (&a)[8], const Lanes (&b)[8]) {
  const Lanes even = a[0] * b[0] + a[2] * b[2] + a[4] * b[4] + a[6] * b[6];
  const Lanes odd = a[1] * b[1] + a[3] * b[3] + a[5] * b[5] + a[7] * b[7];
  return even + odd;
}

/// Projections of a nodal field on the four hourglass base vectors (Flanagan & Belytschko 1981, eq. 25 and table 1):
/// (1 1 -1 -1 -1 -1 1 1), (1 -1 -1 1 -1 1 1 -1), (1 -1 1 -1 1 -1 1 -1), (-1 1 -1 1 1 -1 1 -1).
[[gnu::always_inline]] inline void project_hourglass(const Lanes (&a)[8], Lanes (&g)[4]) {
  const Lanes s01 = a[0] + a[1], d01 = a[0] - a[1], s23 = a[2] + a[3], d23 = a[2] - a[3];
  const Lanes s45 = a[4] + a[5], d45 = a[4] - a[5], s67 = a[6] + a[7], d67 = a[6] - a[7];
  g[0] = (s01 - s23) - (s45 - s67);
  g[1] = (d01 - d23) - (d45 - d67);
  g[2] = (d01 + d23) + (d45 + d67);
  g[3] = (d45 + d67) - (d01 + d23);
}

/// Sum over the base vectors of g * base, per node: the transpose of project_hourglass.
[[gnu::always_inline]] inline void spread_hourglass(const Lanes (&g)[4], Lanes (&f)[8]) {
  const Lanes a = g[1] + g[2], b = g[2] - g[1], p = g[0] - g[3], m = g[0] + g[3];
  f[0] = p + a;
  f[1] = m - a;
  f[2] = b - m;
  f[3] = -p - b;
  const Lanes q = g[3] - g[0], r = -g[0] - g[3];
  f[4] = q + b;
  f[5] = r - b;
  f[6] = a + m;
  f[7] = p - a;
}

/// Geometry and motion of one piece of a block at the end of a step.
struct Kinematics {
  Lanes x[3][8], v[3][8], b[3][8];
  Lanes volume, velocity_gradient[3][3];  // the latter with respect to the end of the step [1/s]
  Lanes gradient_norm;  // sum of all B squared [m4]
  Lanes length;  // V / sqrt(2 lambda_max(B B^T)): the length of the stable step [m]
};

/// `nodes` are those of the piece's first lane.
[[gnu::always_inline]] inline void gather(const ElementWork& w, const std::int32_t* nodes, Kinematics& k) {
#pragma GCC unroll 8
  for (int i = 0; i < 8; ++i) {
    gather_vector(w.position, nodes + lane_width * i, k.x[0][i], k.x[1][i], k.x[2][i]);
    gather_vector(w.velocity, nodes + lane_width * i, k.v[0][i], k.v[1][i], k.v[2][i]);
  }
  // Relative to the first node: the volume of a small element far from the origin keeps its digits.
  for (int d = 0; d < 3; ++d) {
    const Lanes first = k.x[d][0];
    for (int i = 0; i < 8; ++i) k.x[d][i] -= first;
  }
}

/// Largest eigenvalue of the 3x3 matrix B B^T, by the bound of Wolkowicz & Styan (1980) and two Newton steps
/// on the characteristic polynomial, which approach it from above.
[[gnu::always_inline]] inline Lanes largest_eigenvalue(Lanes xx, Lanes yy, Lanes zz, Lanes xy, Lanes yz, Lanes zx) {
  const Lanes mean = (xx + yy + zz) * (1.0 / 3.0);
  const Lanes a = xx - mean, b = yy - mean, c = zz - mean;
  const Lanes shear = xy * xy + yz * yz + zx * zx;
  const Lanes j2 = 0.5 * (a * a + b * b + c * c) + shear;
  const Lanes j3 = a * (b * c - yz * yz) - xy * (xy * c - yz * zx) + zx * (xy * yz - b * zx);
  Lanes e = sqrt_of((4.0 / 3.0) * j2);
  const Lanes tiny = mean * mean * 1e-30 + 1e-300;
#pragma GCC unroll 2
  for (int i = 0; i < 2; ++i) {
    const Lanes ee = e * e;
    e = (2.0 * ee * e + j3) / (3.0 * ee - j2 + tiny);
  }
  return mean + e;
}

[[gnu::always_inline]] inline void measure(Kinematics& k) {
  integrate_gradient(k.x[1], k.x[2], k.b[0]);
  integrate_gradient(k.x[2], k.x[0], k.b[1]);
  integrate_gradient(k.x[0], k.x[1], k.b[2]);
  k.volume = dot8(k.x[0], k.b[0]);
  const Lanes xx = dot8(k.b[0], k.b[0]), yy = dot8(k.b[1], k.b[1]), zz = dot8(k.b[2], k.b[2]);
  const Lanes xy = dot8(k.b[0], k.b[1]), yz = dot8(k.b[1], k.b[2]), zx = dot8(k.b[2], k.b[0]);
  k.gradient_norm = xx + yy + zz;
  k.length = k.volume / sqrt_of(2.0 * largest_eigenvalue(xx, yy, zz, xy, yz, zx) + 1e-300);
}

/// Strain increments and rotations of a step, row by row.
struct StepStrain {
  alignas(64) double strain[6][lane_width];
  alignas(64) double rotation[9][lane_width];
};

/// Strain increment and rotation of the step, both zero/unity to round-off under rigid motion: the gradient
/// with respect to the end of the step, G, is carried to the mid-step configuration, G (I - G/2)^-1, and its
/// skew part W turned into the rotation (I - W/2)^-1 (I + W/2) (Hughes & Winget 1980, eqs. 28 and 36).
[[gnu::always_inline]] inline void strain_of_step(const Lanes (&l)[3][3], double dt, Lanes good, StepStrain& out,
                                                  int lane) {
  Lanes g[3][3];
  for (int i = 0; i < 3; ++i)
    for (int j = 0; j < 3; ++j) g[i][j] = l[i][j] * dt * good;
  // A = I - G/2 and its inverse by cofactors
  const Lanes a00 = 1.0 - 0.5 * g[0][0], a01 = -0.5 * g[0][1], a02 = -0.5 * g[0][2];
  const Lanes a10 = -0.5 * g[1][0], a11 = 1.0 - 0.5 * g[1][1], a12 = -0.5 * g[1][2];
  const Lanes a20 = -0.5 * g[2][0], a21 = -0.5 * g[2][1], a22 = 1.0 - 0.5 * g[2][2];
  const Lanes c00 = a11 * a22 - a12 * a21, c01 = a12 * a20 - a10 * a22, c02 = a10 * a21 - a11 * a20;
  const Lanes inv = 1.0 / (a00 * c00 + a01 * c01 + a02 * c02);
  const Lanes m[3][3] = {{c00 * inv, (a02 * a21 - a01 * a22) * inv, (a01 * a12 - a02 * a11) * inv},
                         {c01 * inv, (a00 * a22 - a02 * a20) * inv, (a02 * a10 - a00 * a12) * inv},
                         {c02 * inv, (a01 * a20 - a00 * a21) * inv, (a00 * a11 - a01 * a10) * inv}};
  Lanes h[3][3];
  for (int i = 0; i < 3; ++i)
    for (int j = 0; j < 3; ++j) h[i][j] = g[i][0] * m[0][j] + g[i][1] * m[1][j] + g[i][2] * m[2][j];
  store_lanes(out.strain[0] + lane, h[0][0]);
  store_lanes(out.strain[1] + lane, h[1][1]);
  store_lanes(out.strain[2] + lane, h[2][2]);
  store_lanes(out.strain[3] + lane, 0.5 * (h[0][1] + h[1][0]));
  store_lanes(out.strain[4] + lane, 0.5 * (h[1][2] + h[2][1]));
  store_lanes(out.strain[5] + lane, 0.5 * (h[2][0] + h[0][2]));
  // With w the half axial vector of W: R = I + 2/(1 + w.w) (w x + w x w x)
  const Lanes wx = 0.25 * (h[2][1] - h[1][2]), wy = 0.25 * (h[0][2] - h[2][0]), wz = 0.25 * (h[1][0] - h[0][1]);
  const Lanes f = 2.0 / (1.0 + wx * wx + wy * wy + wz * wz);
  store_lanes(out.rotation[0] + lane, 1.0 - f * (wy * wy + wz * wz));
  store_lanes(out.rotation[1] + lane, f * (wx * wy - wz));
  store_lanes(out.rotation[2] + lane, f * (wx * wz + wy));
  store_lanes(out.rotation[3] + lane, f * (wx * wy + wz));
  store_lanes(out.rotation[4] + lane, 1.0 - f * (wx * wx + wz * wz));
  store_lanes(out.rotation[5] + lane, f * (wy * wz - wx));
  store_lanes(out.rotation[6] + lane, f * (wx * wz - wy));
  store_lanes(out.rotation[7] + lane, f * (wy * wz + wx));
  store_lanes(out.rotation[8] + lane, 1.0 - f * (wx * wx + wy * wy));
}

[[gnu::always_inline]] inline void rotate_rows(const double (&r)[9][lane_width], int lane, Lanes (&s)[6]) {
  Lanes q[9];
  for (int i = 0; i < 9; ++i) q[i] = load_lanes(r[i] + lane);
  const Lanes a[3][3] = {{s[0], s[3], s[5]}, {s[3], s[1], s[4]}, {s[5], s[4], s[2]}};
  Lanes m[3][3];
  for (int i = 0; i < 3; ++i)
    for (int j = 0; j < 3; ++j) m[i][j] = q[3 * i] * a[0][j] + q[3 * i + 1] * a[1][j] + q[3 * i + 2] * a[2][j];
  const auto entry = [&](int i, int j) { return m[i][0] * q[3 * j] + m[i][1] * q[3 * j + 1] + m[i][2] * q[3 * j + 2]; };
  s[0] = entry(0, 0);
  s[1] = entry(1, 1);
  s[2] = entry(2, 2);
  s[3] = entry(0, 1);
  s[4] = entry(1, 2);
  s[5] = entry(2, 0);
}

}  // namespace kerf::hex8
