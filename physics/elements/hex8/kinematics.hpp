// Geometry and motion of the eight-node hexahedron with one integration point: mean gradient, size of the stable
// step, hourglass modes. For a piece of a block: as many elements as a register holds,
// with numbers of type `Real`, double or float.
//
// Sources: see ../hex8.cpp.
#pragma once

#include <kerf/solid_motion.hpp>

namespace kerf::hex8 {

// Nodal values are handled as sums over the nodes along seven base vectors: signs that vary with the natural
// coordinates xi, eta, zeta (where a node has -1 or 1) and with their products. The eighth vector, of ones, is left
// out: what moves all nodes alike does no work. The last four are the hourglass base vectors of Flanagan & Belytschko
// (1981, table 1), (1 1 -1 -1 -1 -1 1 1), (1 -1 -1 1 -1 1 1 -1), (1 -1 1 -1 1 -1 1 -1), (-1 1 -1 1 1 -1 1 -1).
enum Mode : int { along_xi, along_eta, along_zeta, eta_zeta, zeta_xi, xi_eta, xi_eta_zeta };
inline constexpr int n_modes = 7, first_hourglass = eta_zeta;
inline constexpr int n_gradient_modes = 6;  // the gradient has nothing along the last

/// Sums over the nodes of value times base vector.
template <class V>
[[gnu::always_inline]] inline void project(const V (&a)[8], V (&m)[n_modes]) {
  const V s01 = a[1] + a[0], d01 = a[1] - a[0], s23 = a[2] + a[3], d23 = a[2] - a[3];
  const V s45 = a[5] + a[4], d45 = a[5] - a[4], s67 = a[6] + a[7], d67 = a[6] - a[7];
  const V along0 = d01 + d23, along1 = d45 + d67;  // xi, on the faces zeta = -1 and 1
  const V across0 = s23 - s01, across1 = s67 - s45;  // eta
  const V twist0 = d23 - d01, twist1 = d67 - d45;  // xi eta
  m[along_xi] = along0 + along1;
  m[along_eta] = across0 + across1;
  m[along_zeta] = (s45 + s67) - (s01 + s23);
  m[eta_zeta] = across1 - across0;
  m[zeta_xi] = along1 - along0;
  m[xi_eta] = twist0 + twist1;
  m[xi_eta_zeta] = twist1 - twist0;
}

/// Sum over the base vectors of m times vector, for all nodes but the last: the transpose of `project`.
template <class V>
[[gnu::always_inline]] inline void spread(const V (&m)[n_modes], V (&f)[8]) {
  const V along0 = m[along_xi] - m[zeta_xi], along1 = m[along_xi] + m[zeta_xi];
  const V across0 = m[along_eta] - m[eta_zeta], across1 = m[along_eta] + m[eta_zeta];
  const V twist0 = m[xi_eta] - m[xi_eta_zeta], twist1 = m[xi_eta] + m[xi_eta_zeta];
  const V even0 = twist0 - m[along_zeta], even1 = twist1 + m[along_zeta];
  const V odd0 = -m[along_zeta] - twist0, odd1 = m[along_zeta] - twist1;
  f[0] = even0 - (along0 + across0);
  f[1] = odd0 + (along0 - across0);
  f[2] = even0 + (along0 + across0);
  f[3] = odd0 - (along0 - across0);
  f[4] = even1 - (along1 + across1);
  f[5] = odd1 + (along1 - across1);
  f[6] = even1 + (along1 + across1);
}

/// Scalar product of the first six entries.
template <class V, int n, int m>
[[gnu::always_inline]] inline V dot6(const V (&a)[n], const V (&b)[m]) {
  return (a[0] * b[0] + a[2] * b[2] + a[4] * b[4]) + (a[1] * b[1] + a[3] * b[3] + a[5] * b[5]);
}

/// The mean gradient (Flanagan & Belytschko 1981, eq. 79), along the base vectors: derivative of the volume by the x
/// of a mode; cyclic in x, y, z. Sixty-four times the volume is [xi, eta, zeta] + ([zeta xi, eta zeta, zeta] +
/// [xi eta, eta, eta zeta] + [xi, xi eta, zeta xi]) / 3, with the triple products of three modes' (x, y, z): the
/// integral over xi, eta, zeta of the Jacobian's determinant leaves just these.
template <class Real>
[[gnu::always_inline]] inline void mean_gradient(const LanesOf<Real> (&y)[n_modes], const LanesOf<Real> (&z)[n_modes],
                                                 LanesOf<Real> (&b)[n_gradient_modes]) {
  const auto cross = [&](int m, int n) __attribute__((always_inline)) { return y[m] * z[n] - y[n] * z[m]; };
  constexpr Real linear = 1.0 / 64.0, twisted = 1.0 / 192.0;
  b[along_xi] = linear * cross(along_eta, along_zeta) + twisted * cross(xi_eta, zeta_xi);
  b[along_eta] = linear * cross(along_zeta, along_xi) + twisted * cross(eta_zeta, xi_eta);
  b[along_zeta] = linear * cross(along_xi, along_eta) + twisted * cross(zeta_xi, eta_zeta);
  b[eta_zeta] = twisted * (cross(along_zeta, zeta_xi) + cross(xi_eta, along_eta));
  b[zeta_xi] = twisted * (cross(eta_zeta, along_zeta) + cross(along_xi, xi_eta));
  b[xi_eta] = twisted * (cross(along_eta, eta_zeta) + cross(zeta_xi, along_xi));
}

/// Geometry and motion of one piece of a block at the end of a step; positions x, velocities v and the gradient b
/// along the base vectors.
template <class Real>
struct Kinematics : SolidMotion<Real, hexahedron> {
  using V = LanesOf<Real>;
  // Along the curve that elements stand on, the corner farthest from the origin is the newest one.
  static constexpr int newest_node = 6;
  V x[3][n_modes], v[3][n_modes], b[3][n_gradient_modes];

  [[gnu::always_inline]] V rate(int i, int j) const { return dot6(v[i], b[j]); }
  /// Sum over the nodes of B_i B_j; base vectors have eight entries.
  [[gnu::always_inline]] V product(int i, int j) const { return Real(8.0) * dot6(b[i], b[j]); }
};

/// `nodes` are those of the piece's first lane. In single precision velocities too are relative to those of the first
/// node, and differences are taken before they are rounded.
[[gnu::always_inline]] inline void gather(const double* position, const double* velocity, const std::int32_t* nodes,
                                          Kinematics<double>& k) {
  Lanes x[3][8], v[3][8];
  gather_nodes(position, velocity, nodes, x, v);
  for (int d = 0; d < 3; ++d) {
    project(x[d], k.x[d]);
    project(v[d], k.v[d]);
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
  SingleLanes short_x[3][8], short_v[3][8];
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
        short_x[d][0] = short_v[d][0] = SingleLanes{};
        continue;
      }
      Lanes wide_x[n], wide_v[n];
      for (int part = 0; part < n; ++part) {
        wide_x[part] = x[part][i][d] -= x[part][0][d];
        wide_v[part] = v[part][d] - v0[part][d];
      }
      short_x[d][i] = narrowed(wide_x);
      short_v[d][i] = narrowed(wide_v);
    }
  }
  for (int d = 0; d < 3; ++d) {
    project(short_x[d], k.x[d]);
    project(short_v[d], k.v[d]);
  }
  for (int part = 0; part < n; ++part) k.exact_volume[part] = volume_of(x[part]);
  k.volume = narrowed(k.exact_volume);
}

template <class Real>
[[gnu::always_inline]] inline void measure(Kinematics<Real>& k) {
  mean_gradient<Real>(k.x[1], k.x[2], k.b[0]);
  mean_gradient<Real>(k.x[2], k.x[0], k.b[1]);
  mean_gradient<Real>(k.x[0], k.x[1], k.b[2]);
  if constexpr (std::is_same_v<Real, double>) k.exact_volume[0] = k.volume = dot6(k.x[0], k.b[0]);
  stable_length(k.product(0, 0), k.product(1, 1), k.product(2, 2), k.product(0, 1), k.product(1, 2), k.product(2, 0),
                k);
}

}  // namespace kerf::hex8
