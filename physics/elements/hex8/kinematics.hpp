// Geometry and motion of the eight-node hexahedron with one integration point: mean gradient, size of the stable
// step, hourglass modes, strain and rotation of a step. For a piece of a block: as many elements as a register holds,
// with numbers of type `Real`, double or float.
//
// Sources: see ../hex8.cpp.
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
template <class Real>
[[gnu::always_inline]] inline void integrate_gradient(const LanesOf<Real> (&y)[8], const LanesOf<Real> (&z)[8],
                                                      LanesOf<Real> (&b)[8]) {
#pragma GCC unroll 8
  for (int i = 0; i < 8; ++i) {
    const int* n = renumbered[i];
    b[i] =
        (y[n[1]] * ((z[n[5]] - z[n[2]]) - (z[n[3]] - z[n[4]])) + y[n[2]] * (z[n[1]] - z[n[3]]) +
         y[n[3]] * ((z[n[2]] - z[n[7]]) - (z[n[4]] - z[n[1]])) + y[n[4]] * ((z[n[7]] - z[n[5]]) - (z[n[1]] - z[n[3]])) +
         y[n[5]] * (z[n[4]] - z[n[1]]) + y[n[7]] * (z[n[3]] - z[n[4]])) *
        Real(1.0 / 12.0);
  }
}

template <class V>
[[gnu::always_inline]] inline V dot8(const V (&a)[8], const V (&b)[8]) {
  const V even = a[0] * b[0] + a[2] * b[2] + a[4] * b[4] + a[6] * b[6];
  const V odd = a[1] * b[1] + a[3] * b[3] + a[5] * b[5] + a[7] * b[7];
  return even + odd;
}

/// Projections of a nodal field on the four hourglass base vectors (Flanagan & Belytschko 1981, eq. 25 and table 1):
/// (1 1 -1 -1 -1 -1 1 1), (1 -1 -1 1 -1 1 1 -1), (1 -1 1 -1 1 -1 1 -1), (-1 1 -1 1 1 -1 1 -1).
template <class V>
[[gnu::always_inline]] inline void project_hourglass(const V (&a)[8], V (&g)[4]) {
  const V s01 = a[0] + a[1], d01 = a[0] - a[1], s23 = a[2] + a[3], d23 = a[2] - a[3];
  const V s45 = a[4] + a[5], d45 = a[4] - a[5], s67 = a[6] + a[7], d67 = a[6] - a[7];
  g[0] = (s01 - s23) - (s45 - s67);
  g[1] = (d01 - d23) - (d45 - d67);
  g[2] = (d01 + d23) + (d45 + d67);
  g[3] = (d45 + d67) - (d01 + d23);
}

/// Sum over the base vectors of g * base, per node: the transpose of project_hourglass.
template <class V>
[[gnu::always_inline]] inline void spread_hourglass(const V (&g)[4], V (&f)[8]) {
  const V a = g[1] + g[2], b = g[2] - g[1], p = g[0] - g[3], m = g[0] + g[3];
  f[0] = p + a;
  f[1] = m - a;
  f[2] = b - m;
  f[3] = -p - b;
  const V q = g[3] - g[0], r = -g[0] - g[3];
  f[4] = q + b;
  f[5] = r - b;
  f[6] = a + m;
  f[7] = p - a;
}

/// Geometry and motion of one piece of a block at the end of a step.
template <class Real>
struct Kinematics {
  using V = LanesOf<Real>;
  V x[3][8], v[3][8], b[3][8];
  V volume, velocity_gradient[3][3];  // the latter with respect to the end of the step [1/s]
  V gradient_norm;  // sum of all B squared [m4]
  Lanes exact_volume[n_wide<Real>];  // the same as `volume`, in double precision
  V length;  // V / sqrt(2 lambda_max(B B^T)): the length of the stable step [m]
};

/// `nodes` are those of the piece's first lane. Positions are relative to the first node, so that the volume of a small
/// element far from the origin keeps its digits; in single precision so are velocities, and differences are taken
/// before they are rounded.
[[gnu::always_inline]] inline void gather(const double* position, const double* velocity, const std::int32_t* nodes,
                                          Kinematics<double>& k) {
#pragma GCC unroll 8
  for (int i = 0; i < 8; ++i) {
    gather_vector(position, nodes + lane_width * i, k.x[0][i], k.x[1][i], k.x[2][i]);
    gather_vector(velocity, nodes + lane_width * i, k.v[0][i], k.v[1][i], k.v[2][i]);
  }
  for (int d = 0; d < 3; ++d) {
    const Lanes first = k.x[d][0];
    for (int i = 0; i < 8; ++i) k.x[d][i] -= first;
  }
}
/// Volume of the element, of corners relative to the first one (J. Grandy, "Efficient computation of volume of
/// hexahedral cells", UCRL-ID-128886 (1997)). It equals the sum of x B, which in single precision has an error that an
/// equation of state would multiply by the bulk modulus.
[[gnu::always_inline]] inline Lanes volume_of(const Lanes (&x)[8][3]) {
  const auto triple = [](const Lanes(&a)[3], const Lanes(&b)[3], const Lanes(&c)[3]) __attribute__((always_inline)) {
    return a[0] * (b[1] * c[2] - b[2] * c[1]) + a[1] * (b[2] * c[0] - b[0] * c[2]) + a[2] * (b[0] * c[1] - b[1] * c[0]);
  };
  Lanes p[3], q[3], r[3], from_1[3], from_3[3], from_4[3];
  for (int d = 0; d < 3; ++d) {
    p[d] = (x[3][d] - x[1][d]) + (x[7][d] - x[2][d]);
    q[d] = (x[4][d] - x[3][d]) + (x[5][d] - x[7][d]);
    r[d] = (x[1][d] - x[4][d]) + (x[2][d] - x[5][d]);
    from_1[d] = x[6][d] - x[1][d];
    from_3[d] = x[6][d] - x[3][d];
    from_4[d] = x[6][d] - x[4][d];
  }
  return (triple(p, from_3, x[2]) + triple(q, from_4, x[7]) + triple(r, from_1, x[5])) * (1.0 / 12.0);
}

[[gnu::always_inline]] inline void gather(const double* position, const double* velocity, const std::int32_t* nodes,
                                          Kinematics<float>& k) {
  constexpr int n = n_wide<float>;
  Lanes x[n][8][3], v0[n][3];
#pragma GCC unroll 8
  for (int i = 0; i < 8; ++i) {
    Lanes v[n][3];
    for (int part = 0; part < n; ++part) {
      const std::int32_t* node = nodes + lane_width * i + part * register_lanes;
      gather_vector(position, node, x[part][i][0], x[part][i][1], x[part][i][2]);
      gather_vector(velocity, node, v[part][0], v[part][1], v[part][2]);
    }
    for (int d = 0; d < 3; ++d) {
      if (i == 0) {
        for (int part = 0; part < n; ++part) v0[part][d] = v[part][d];
        k.x[d][0] = k.v[d][0] = SingleLanes{};
        continue;
      }
      Lanes wide_x[n], wide_v[n];
      for (int part = 0; part < n; ++part) {
        wide_x[part] = x[part][i][d] -= x[part][0][d];
        wide_v[part] = v[part][d] - v0[part][d];
      }
      k.x[d][i] = narrowed(wide_x);
      k.v[d][i] = narrowed(wide_v);
    }
  }
  for (int part = 0; part < n; ++part) k.exact_volume[part] = volume_of(x[part]);
  k.volume = narrowed(k.exact_volume);
}

/// Largest eigenvalue of the 3x3 matrix B B^T, by the bound of Wolkowicz & Styan (1980) and two Newton steps
/// on the characteristic polynomial, which approach it from above.
template <class Real>
[[gnu::always_inline]] inline LanesOf<Real> largest_eigenvalue(LanesOf<Real> xx, LanesOf<Real> yy, LanesOf<Real> zz,
                                                               LanesOf<Real> xy, LanesOf<Real> yz, LanesOf<Real> zx) {
  using V = LanesOf<Real>;
  const V mean = (xx + yy + zz) * Real(1.0 / 3.0);
  const V a = xx - mean, b = yy - mean, c = zz - mean;
  const V shear = xy * xy + yz * yz + zx * zx;
  const V j2 = Real(0.5) * (a * a + b * b + c * c) + shear;
  const V j3 = a * (b * c - yz * yz) - xy * (xy * c - yz * zx) + zx * (xy * yz - b * zx);
  V e = sqrt_of(Real(4.0 / 3.0) * j2);
  const V least = mean * mean * Real(1e-30) + tiny<Real>;
#pragma GCC unroll 2
  for (int i = 0; i < 2; ++i) {
    const V ee = e * e;
    e = (Real(2.0) * ee * e + j3) / (Real(3.0) * ee - j2 + least);
  }
  return mean + e;
}

template <class Real>
[[gnu::always_inline]] inline void measure(Kinematics<Real>& k) {
  using V = LanesOf<Real>;
  integrate_gradient<Real>(k.x[1], k.x[2], k.b[0]);
  integrate_gradient<Real>(k.x[2], k.x[0], k.b[1]);
  integrate_gradient<Real>(k.x[0], k.x[1], k.b[2]);
  if constexpr (std::is_same_v<Real, double>) k.exact_volume[0] = k.volume = dot8(k.x[0], k.b[0]);
  const V xx = dot8(k.b[0], k.b[0]), yy = dot8(k.b[1], k.b[1]), zz = dot8(k.b[2], k.b[2]);
  const V xy = dot8(k.b[0], k.b[1]), yz = dot8(k.b[1], k.b[2]), zx = dot8(k.b[2], k.b[0]);
  k.gradient_norm = xx + yy + zz;
  if constexpr (std::is_same_v<Real, double>) {
    k.length = k.volume / sqrt_of(2.0 * largest_eigenvalue<double>(xx, yy, zz, xy, yz, zx) + tiny<double>);
  } else {
    // The determinant of a matrix of lengths to the fourth would leave the range of floats.
    const V one = 1.0f / (k.gradient_norm + tiny<float>);
    const V share = largest_eigenvalue<float>(xx * one, yy * one, zz * one, xy * one, yz * one, zx * one);
    k.length = k.volume / sqrt_of(2.0f * share * k.gradient_norm + tiny<float>);
  }
}

/// Strain increments and rotations of a step, row by row. In single precision one is subtracted from the rotation's
/// diagonal: of the small angle of a step it would round off what turns the stress.
template <class Real>
struct StepStrain {
  alignas(64) Real strain[6][lane_width];
  alignas(64) Real rotation[9][lane_width];
};
template <class Real>
inline constexpr Real diagonal = std::is_same_v<Real, float> ? Real(0.0) : Real(1.0);

/// Strain increment and rotation of the step, both zero/unity to round-off under rigid motion: the gradient
/// with respect to the end of the step, G, is carried to the mid-step configuration, G (I - G/2)^-1, and its
/// skew part W turned into the rotation (I - W/2)^-1 (I + W/2) (Hughes & Winget 1980, eqs. 28 and 36).
template <class Real>
[[gnu::always_inline]] inline void strain_of_step(const LanesOf<Real> (&l)[3][3], Real dt, LanesOf<Real> good,
                                                  StepStrain<Real>& out, int lane) {
  using V = LanesOf<Real>;
  constexpr Real half = 0.5, one = 1.0;
  V g[3][3];
  for (int i = 0; i < 3; ++i)
    for (int j = 0; j < 3; ++j) g[i][j] = l[i][j] * dt * good;
  // A = I - G/2 and its inverse by cofactors
  const V a00 = one - half * g[0][0], a01 = -half * g[0][1], a02 = -half * g[0][2];
  const V a10 = -half * g[1][0], a11 = one - half * g[1][1], a12 = -half * g[1][2];
  const V a20 = -half * g[2][0], a21 = -half * g[2][1], a22 = one - half * g[2][2];
  const V c00 = a11 * a22 - a12 * a21, c01 = a12 * a20 - a10 * a22, c02 = a10 * a21 - a11 * a20;
  const V inv = one / (a00 * c00 + a01 * c01 + a02 * c02);
  const V m[3][3] = {{c00 * inv, (a02 * a21 - a01 * a22) * inv, (a01 * a12 - a02 * a11) * inv},
                     {c01 * inv, (a00 * a22 - a02 * a20) * inv, (a02 * a10 - a00 * a12) * inv},
                     {c02 * inv, (a01 * a20 - a00 * a21) * inv, (a00 * a11 - a01 * a10) * inv}};
  V h[3][3];
  for (int i = 0; i < 3; ++i)
    for (int j = 0; j < 3; ++j) h[i][j] = g[i][0] * m[0][j] + g[i][1] * m[1][j] + g[i][2] * m[2][j];
  // With w the half axial vector of W: R = I + 2/(1 + w.w) (w x + w x w x)
  const V wx = Real(0.25) * (h[2][1] - h[1][2]), wy = Real(0.25) * (h[0][2] - h[2][0]),
          wz = Real(0.25) * (h[1][0] - h[0][1]);
  // The strain is that of the middle of the step; the law adds it to a stress that has been turned to the end.
  const V xx = h[0][0], yy = h[1][1], zz = h[2][2];
  const V xy = half * (h[0][1] + h[1][0]), yz = half * (h[1][2] + h[2][1]), zx = half * (h[2][0] + h[0][2]);
  store_lanes(out.strain[0] + lane, xx + Real(2.0) * (wy * zx - wz * xy));
  store_lanes(out.strain[1] + lane, yy + Real(2.0) * (wz * xy - wx * yz));
  store_lanes(out.strain[2] + lane, zz + Real(2.0) * (wx * yz - wy * zx));
  store_lanes(out.strain[3] + lane, xy + (wz * (xx - yy) + wy * yz - wx * zx));
  store_lanes(out.strain[4] + lane, yz + (wx * (yy - zz) + wz * zx - wy * xy));
  store_lanes(out.strain[5] + lane, zx + (wy * (zz - xx) + wx * xy - wz * yz));
  const V f = Real(2.0) / (one + wx * wx + wy * wy + wz * wz);
  store_lanes(out.rotation[0] + lane, diagonal<Real> - f * (wy * wy + wz * wz));
  store_lanes(out.rotation[1] + lane, f * (wx * wy - wz));
  store_lanes(out.rotation[2] + lane, f * (wx * wz + wy));
  store_lanes(out.rotation[3] + lane, f * (wx * wy + wz));
  store_lanes(out.rotation[4] + lane, diagonal<Real> - f * (wx * wx + wz * wz));
  store_lanes(out.rotation[5] + lane, f * (wy * wz - wx));
  store_lanes(out.rotation[6] + lane, f * (wx * wz - wy));
  store_lanes(out.rotation[7] + lane, f * (wy * wz + wx));
  store_lanes(out.rotation[8] + lane, diagonal<Real> - f * (wx * wx + wy * wy));
}

template <class Real>
[[gnu::always_inline]] inline void rotate_rows(const Real (&r)[9][lane_width], int lane, LanesOf<Real> (&s)[6]) {
  using V = LanesOf<Real>;
  V q[9];
  for (int i = 0; i < 9; ++i) q[i] = load_lanes(r[i] + lane);
  const V a[3][3] = {{s[0], s[3], s[5]}, {s[3], s[1], s[4]}, {s[5], s[4], s[2]}};
  V m[3][3];
  for (int i = 0; i < 3; ++i)
    for (int j = 0; j < 3; ++j) m[i][j] = q[3 * i] * a[0][j] + q[3 * i + 1] * a[1][j] + q[3 * i + 2] * a[2][j];
  const auto entry = [&](int i, int j) { return m[i][0] * q[3 * j] + m[i][1] * q[3 * j + 1] + m[i][2] * q[3 * j + 2]; };
  const V turned[6] = {entry(0, 0), entry(1, 1), entry(2, 2), entry(0, 1), entry(1, 2), entry(2, 0)};
  if constexpr (std::is_same_v<Real, double>) {
    for (int i = 0; i < 6; ++i) s[i] = turned[i];
  } else {
    // With R = I + Q: s + Q s + (Q s)^T + Q s Q^T.
    const V both[6] = {m[0][0] + m[0][0], m[1][1] + m[1][1], m[2][2] + m[2][2],
                       m[0][1] + m[1][0], m[1][2] + m[2][1], m[2][0] + m[0][2]};
    for (int i = 0; i < 6; ++i) s[i] += both[i] + turned[i];
  }
}

}  // namespace kerf::hex8
