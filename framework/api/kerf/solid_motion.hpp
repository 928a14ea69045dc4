// Motion of solid elements with one integration point, whatever their number of nodes: what a formulation has to say of
// an element's geometry, and strain and rotation of a step that follow from the velocity gradient. For a piece of a
// block: as many elements as a register holds, with numbers of type `Real`, double or float.
//
// Sources: T.J.R. Hughes & J. Winget, "Finite rotation effects in numerical integration of rate constitutive
// equations", IJNME 15 (1980) 1862-1867; D.P. Flanagan & T. Belytschko, J. Appl. Mech. 51 (1984) 35-40 for the
// eigenvalue bound of the time step; H. Wolkowicz & G.P.H. Styan, Lin. Alg. Appl. 29 (1980) 471-506.
#pragma once

#include <kerf/element.hpp>
#include <kerf/lanes.hpp>

namespace kerf {

/// What SolidKernel asks of an element's geometry and motion at the end of a step. B_iI is the mean gradient times the
/// volume: the derivative of the volume by coordinate i of node I [m2]. A formulation derives its own from it, with
///   V rate(int i, int j) const: the sum over the nodes of v_i B_j [m3/s].
template <class Real, const Shape& shape>
struct SolidMotion {
  using V = LanesOf<Real>;
  static constexpr int n_nodes = shape.n_nodes, n_faces = shape.n_faces;
  static constexpr int newest_node = n_nodes - 1;  // most often in no element before; a guess, which only costs time
  V volume;  // [m3]
  V velocity_gradient[3][3];  // by the positions at the end of the step; SolidKernel sets it [1/s]
  V gradient_norm;  // sum of all B squared [m4]
  Lanes exact_volume[n_wide<Real>];  // the same as `volume`, in double precision
  V length;  // of stable_length [m]
};

/// Positions and velocities of a piece's nodes; positions relative to the first node, so that the volume of a small
/// element far from the origin keeps its digits. `nodes` are those of the piece's first lane.
template <int n_nodes>
[[gnu::always_inline]] inline void gather_nodes(const double* position, const double* velocity,
                                                const std::int32_t* nodes, Lanes (&x)[3][n_nodes],
                                                Lanes (&v)[3][n_nodes]) {
#pragma GCC unroll 8
  for (int i = 0; i < n_nodes; ++i) {
    gather_vector(position, nodes + lane_width * i, x[0][i], x[1][i], x[2][i]);
    gather_vector(velocity, nodes + lane_width * i, v[0][i], v[1][i], v[2][i]);
  }
  for (int d = 0; d < 3; ++d) {
    const Lanes first = x[d][0];
    for (int i = 0; i < n_nodes; ++i) x[d][i] -= first;
  }
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

/// The length that a plane wave crosses in the greatest stable step, V / sqrt(n/4 lambda_max(B B^T)) with n nodes,
/// and the trace of B B^T, from the products B_i B_j summed over the nodes.
template <class Real, const Shape& shape>
[[gnu::always_inline]] inline void stable_length(LanesOf<Real> xx, LanesOf<Real> yy, LanesOf<Real> zz, LanesOf<Real> xy,
                                                 LanesOf<Real> yz, LanesOf<Real> zx, SolidMotion<Real, shape>& k) {
  using V = LanesOf<Real>;
  constexpr Real quarter_of_nodes = shape.n_nodes / 4.0;
  k.gradient_norm = xx + yy + zz;
  if constexpr (std::is_same_v<Real, double>) {
    k.length = k.volume / sqrt_of(quarter_of_nodes * largest_eigenvalue<double>(xx, yy, zz, xy, yz, zx) + tiny<double>);
  } else {
    // The determinant of a matrix of lengths to the fourth would leave the range of floats.
    const V one = 1.0f / (k.gradient_norm + tiny<float>);
    const V share = largest_eigenvalue<float>(xx * one, yy * one, zz * one, xy * one, yz * one, zx * one);
    k.length = k.volume / sqrt_of(quarter_of_nodes * share * k.gradient_norm + tiny<float>);
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

}  // namespace kerf
