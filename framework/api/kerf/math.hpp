// Small fixed-size algebra that laws are written in: vectors, symmetric tensors, rotations.
//
// Everything here is header-only, branch-light and free of aliasing, so that a loop over points that
// calls it vectorises. Tensor components are ordered xx, yy, zz, xy, yz, zx; shear components are
// tensor components (not engineering strains). What a material may need exists for float as well, for
// laws that are written for both; see material.hpp. exp, log, pow and their like are in functions.hpp.
#pragma once

#include <cmath>
#include <type_traits>

#include "kerf/functions.hpp"
#include "kerf/select.hpp"
#include "kerf/sizes.hpp"

namespace kerf {

/// Points that are computed together; every array handed to a law has this many entries per quantity.
inline constexpr int lane_width = 8;

struct Vec3 {
  double x = 0.0, y = 0.0, z = 0.0;

  constexpr Vec3 operator+(Vec3 b) const { return {x + b.x, y + b.y, z + b.z}; }
  constexpr Vec3 operator-(Vec3 b) const { return {x - b.x, y - b.y, z - b.z}; }
  constexpr Vec3 operator-() const { return {-x, -y, -z}; }
  constexpr Vec3 operator*(double s) const { return {x * s, y * s, z * s}; }
  constexpr double operator[](int i) const { return i == 0 ? x : i == 1 ? y : z; }
  constexpr double& operator[](int i) { return i == 0 ? x : i == 1 ? y : z; }
  friend constexpr Vec3 operator*(double s, Vec3 a) { return a * s; }
};

constexpr double dot(Vec3 a, Vec3 b) { return a.x * b.x + a.y * b.y + a.z * b.z; }
constexpr Vec3 cross(Vec3 a, Vec3 b) { return {a.y * b.z - a.z * b.y, a.z * b.x - a.x * b.z, a.x * b.y - a.y * b.x}; }
inline double norm(Vec3 a) { return std::sqrt(dot(a, a)); }

/// Keeps a denominator that may be zero from being it; far below all quantities in SI units.
template <class Real>
inline constexpr Real tiny = std::is_same_v<Real, float> ? Real(1e-37) : Real(1e-300);

template <class Real>
struct SymTensorOf {
  Real xx = 0, yy = 0, zz = 0, xy = 0, yz = 0, zx = 0;

  constexpr Real trace() const { return xx + yy + zz; }
  constexpr SymTensorOf operator+(SymTensorOf b) const {
    return {xx + b.xx, yy + b.yy, zz + b.zz, xy + b.xy, yz + b.yz, zx + b.zx};
  }
  constexpr SymTensorOf operator-(SymTensorOf b) const {
    return {xx - b.xx, yy - b.yy, zz - b.zz, xy - b.xy, yz - b.yz, zx - b.zx};
  }
  constexpr SymTensorOf operator*(Real s) const { return {xx * s, yy * s, zz * s, xy * s, yz * s, zx * s}; }
  friend constexpr SymTensorOf operator*(Real s, SymTensorOf a) { return a * s; }
};
using SymTensor = SymTensorOf<double>;

template <class Real>
constexpr Real double_dot(SymTensorOf<Real> a, SymTensorOf<Real> b) {
  return a.xx * b.xx + a.yy * b.yy + a.zz * b.zz + Real(2) * (a.xy * b.xy + a.yz * b.yz + a.zx * b.zx);
}
template <class Real>
constexpr SymTensorOf<Real> deviator(SymTensorOf<Real> a) {
  const Real mean = a.trace() * Real(1.0 / 3.0);
  return {a.xx - mean, a.yy - mean, a.zz - mean, a.xy, a.yz, a.zx};
}
/// von Mises equivalent of a deviatoric stress, sqrt(3/2 s:s).
template <class Real>
Real von_mises(SymTensorOf<Real> s) {
  return std::sqrt(Real(1.5) * double_dot(s, s));
}
/// Equivalent of a deviatoric strain, sqrt(2/3 e:e).
template <class Real>
Real equivalent_strain(SymTensorOf<Real> e) {
  return std::sqrt(Real(2.0 / 3.0) * double_dot(e, e));
}
// For tensors in braces, of which a template cannot tell the type.
constexpr double double_dot(SymTensor a, SymTensor b) { return double_dot<double>(a, b); }
constexpr SymTensor deviator(SymTensor a) { return deviator<double>(a); }
inline double von_mises(SymTensor s) { return von_mises<double>(s); }
inline double equivalent_strain(SymTensor e) { return equivalent_strain<double>(e); }

struct Rotation {
  double xx = 1.0, xy = 0.0, xz = 0.0, yx = 0.0, yy = 1.0, yz = 0.0, zx = 0.0, zy = 0.0, zz = 1.0;
};

/// R a R^T.
constexpr SymTensor rotate(SymTensor a, const Rotation& r) {
  const double mxx = r.xx * a.xx + r.xy * a.xy + r.xz * a.zx, mxy = r.xx * a.xy + r.xy * a.yy + r.xz * a.yz,
               mxz = r.xx * a.zx + r.xy * a.yz + r.xz * a.zz;
  const double myx = r.yx * a.xx + r.yy * a.xy + r.yz * a.zx, myy = r.yx * a.xy + r.yy * a.yy + r.yz * a.yz,
               myz = r.yx * a.zx + r.yy * a.yz + r.yz * a.zz;
  const double mzx = r.zx * a.xx + r.zy * a.xy + r.zz * a.zx, mzy = r.zx * a.xy + r.zy * a.yy + r.zz * a.yz,
               mzz = r.zx * a.zx + r.zy * a.yz + r.zz * a.zz;
  return {mxx * r.xx + mxy * r.xy + mxz * r.xz, myx * r.yx + myy * r.yy + myz * r.yz,
          mzx * r.zx + mzy * r.zy + mzz * r.zz, mxx * r.yx + mxy * r.yy + mxz * r.yz,
          myx * r.zx + myy * r.zy + myz * r.zz, mzx * r.xx + mzy * r.xy + mzz * r.xz};
}

/// Largest eigenvalue of a symmetric tensor, without branches or trigonometry; accurate to round-off times the
/// tensor's size, and to its square root (1e-8) where the two largest eigenvalues coincide.
/// The eigenvalue that stands alone (the largest where det s > 0, else the smallest) lies between 1 and 2/sqrt(3)
/// times sqrt(J2); Newton's method on e^3 - J2 e - |J3| reaches it from above (the bound is Wolkowicz & Styan 1980,
/// eq. 2.2). The other two are the roots of what is left, x^2 + e x + e^2 - J2.
inline double largest_principal(SymTensor a) {
  const SymTensor s = deviator(a);
  const double j2 = 0.5 * double_dot(s, s);
  const double j3 =
      s.xx * (s.yy * s.zz - s.yz * s.yz) - s.xy * (s.xy * s.zz - s.yz * s.zx) + s.zx * (s.xy * s.yz - s.yy * s.zx);
  const double size = std::fabs(j3);
  double e = std::sqrt((4.0 / 3.0) * j2);
  for (int i = 0; i < 5; ++i) {
    const double ee = e * e;
    e = (2.0 * ee * e + size) / (3.0 * ee - j2 + 1e-300);
  }
  const double rest = std::sqrt(max_of(4.0 * j2 - 3.0 * e * e, 0.0));
  return select(j3 < 0.0, 0.5 * (e + rest), e) + a.trace() * (1.0 / 3.0);
}

}  // namespace kerf

KERF_SIZES(math, KERF_SIZE(Vec3), KERF_SIZE(SymTensor), KERF_SIZE(Rotation))
