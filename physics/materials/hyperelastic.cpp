// Rubber: the hyperelastic deviators of Neo-Hooke and of Mooney and Rivlin, from the left Cauchy-Green tensor that the
// point carries along.
//
// Sources: R.S. Rivlin, "Large elastic deformations of isotropic materials IV", Phil. Trans. R. Soc. A 241 (1948)
// 379-397; M. Mooney, "A theory of large elastic deformation", J. Appl. Phys. 11 (1940) 582-592; G.A. Holzapfel,
// Nonlinear Solid Mechanics (2000), sections 6.4 and 6.5 (isochoric split); T.J.R. Hughes & J. Winget, IJNME 15 (1980)
// 1862-1867 (strain and rotation of a step).
#include <kerf/material.hpp>

namespace {

using namespace kerf;

struct Matrix {
  double xx = 0, xy = 0, xz = 0, yx = 0, yy = 0, yz = 0, zx = 0, zy = 0, zz = 0;
};
[[gnu::always_inline]] constexpr Matrix product(const Matrix& a, const Matrix& b) {
  return {a.xx * b.xx + a.xy * b.yx + a.xz * b.zx, a.xx * b.xy + a.xy * b.yy + a.xz * b.zy,
          a.xx * b.xz + a.xy * b.yz + a.xz * b.zz, a.yx * b.xx + a.yy * b.yx + a.yz * b.zx,
          a.yx * b.xy + a.yy * b.yy + a.yz * b.zy, a.yx * b.xz + a.yy * b.yz + a.yz * b.zz,
          a.zx * b.xx + a.zy * b.yx + a.zz * b.zx, a.zx * b.xy + a.zy * b.yy + a.zz * b.zy,
          a.zx * b.xz + a.zy * b.yz + a.zz * b.zz};
}
[[gnu::always_inline]] constexpr Matrix inverse(const Matrix& a) {
  const double xx = a.yy * a.zz - a.yz * a.zy, yx = a.yz * a.zx - a.yx * a.zz, zx = a.yx * a.zy - a.yy * a.zx;
  const double f = 1.0 / (a.xx * xx + a.xy * yx + a.xz * zx);
  return {f * xx, f * (a.xz * a.zy - a.xy * a.zz), f * (a.xy * a.yz - a.xz * a.yy),
          f * yx, f * (a.xx * a.zz - a.xz * a.zx), f * (a.xz * a.yx - a.xx * a.yz),
          f * zx, f * (a.xy * a.zx - a.xx * a.zy), f * (a.xx * a.yy - a.xy * a.yx)};
}
[[gnu::always_inline]] constexpr SymTensor square(SymTensor a) {
  return {a.xx * a.xx + a.xy * a.xy + a.zx * a.zx, a.xy * a.xy + a.yy * a.yy + a.yz * a.yz,
          a.zx * a.zx + a.yz * a.yz + a.zz * a.zz, a.xx * a.xy + a.xy * a.yy + a.zx * a.yz,
          a.xy * a.zx + a.yy * a.yz + a.yz * a.zz, a.zx * a.xx + a.yz * a.xy + a.zz * a.zx};
}
constexpr double determinant(SymTensor a) {
  return a.xx * (a.yy * a.zz - a.yz * a.yz) - a.xy * (a.xy * a.zz - a.yz * a.zx) + a.zx * (a.xy * a.yz - a.yy * a.zx);
}
constexpr SymTensor unit{1.0, 1.0, 1.0, 0.0, 0.0, 0.0};

/// [w]a - a[w], with [w] the skew tensor of the vector w: how a symmetric tensor changes as it turns.
[[gnu::always_inline]] constexpr SymTensor turning(Vec3 w, SymTensor a) {
  return {2.0 * (w.y * a.zx - w.z * a.xy),
          2.0 * (w.z * a.xy - w.x * a.yz),
          2.0 * (w.x * a.yz - w.y * a.zx),
          w.z * (a.xx - a.yy) + w.y * a.yz - w.x * a.zx,
          w.x * (a.yy - a.zz) + w.z * a.zx - w.y * a.xy,
          w.y * (a.zz - a.xx) + w.x * a.xy - w.z * a.yz};
}

/// The stretch of a step that follows its rotation, U = f R^T, with f the deformation gradient of the step.
///
/// Elements have the gradient h of the displacement by the middle of the step, f = (I - h/2)^-1 (I + h/2). Its skew
/// part 2 [w] makes the rotation R = (I - [w])^-1 (I + [w]), its symmetric part D the strain D + [w]D - D[w]. Both are
/// taken apart again here, so that f is exact in steps of any size. With x for the turning by w, whose eigenvalues are
/// 0, +-i|w| and +-2i|w|, (1 + x)^-1 = 1 + (x^4 - x^3 + (1 + 5a)(x^2 - x)) / ((1 + a)(1 + 4a)), a = w.w.
[[gnu::always_inline]] constexpr Matrix stretch_of_step(SymTensor strain, const Rotation& r) {
  const double scale = 1.0 / (1.0 + r.xx + r.yy + r.zz);
  const Vec3 w = {scale * (r.zy - r.yz), scale * (r.xz - r.zx), scale * (r.yx - r.xy)};
  const double a = dot(w, w);
  const SymTensor t1 = turning(w, strain), t2 = turning(w, t1), t3 = turning(w, t2), t4 = turning(w, t3);
  const SymTensor half =
      0.5 * (strain + (1.0 / ((1.0 + a) * (1.0 + 4.0 * a))) * (t4 - t3 + (1.0 + 5.0 * a) * (t2 - t1)));
  const Matrix h = {half.xx,       half.xy - w.z, half.zx + w.y, half.xy + w.z, half.yy,
                    half.yz - w.x, half.zx - w.y, half.yz + w.x, half.zz};
  const Matrix minus = {1.0 - h.xx, -h.xy, -h.xz, -h.yx, 1.0 - h.yy, -h.yz, -h.zx, -h.zy, 1.0 - h.zz},
               plus = {1.0 + h.xx, h.xy, h.xz, h.yx, 1.0 + h.yy, h.yz, h.zx, h.zy, 1.0 + h.zz},
               back = {r.xx, r.yx, r.zx, r.xy, r.yy, r.zy, r.xz, r.yz, r.zz};
  return product(product(inverse(minus), plus), back);
}

/// u b u^T.
[[gnu::always_inline]] constexpr SymTensor carried(const Matrix& u, SymTensor b) {
  const Matrix left = product(u, {b.xx, b.xy, b.zx, b.xy, b.yy, b.yz, b.zx, b.yz, b.zz});
  return {left.xx * u.xx + left.xy * u.xy + left.xz * u.xz, left.yx * u.yx + left.yy * u.yy + left.yz * u.yz,
          left.zx * u.zx + left.zy * u.zy + left.zz * u.zz, left.xx * u.yx + left.xy * u.yy + left.xz * u.yz,
          left.yx * u.zx + left.yy * u.zy + left.yz * u.zz, left.zx * u.xx + left.zy * u.xy + left.zz * u.xz};
}

/// W = C10 (I1 - 3) + C01 (I2 - 3) of the isochoric b = J^(-2/3) F F^T: the deviator is
/// s = (2/J) dev[(C10 + I1 C01) b - C01 b^2]. The state holds b - I, which the element has turned with the material.
template <class LawType>
struct Hyperelastic : PointwiseMaterial<LawType> {
  static constexpr unsigned inputs = with_rotation;

  struct State {
    SymTensor stretch;
  };
  static void describe_state(Schema<LawType>& s) {
    s.state(&State::stretch, "stretch", "-", "isochoric left Cauchy-Green tensor less the unit tensor");
  }
  double cost() const override { return 7.0; }

  [[gnu::always_inline]] void update_point(const PointInputWith<inputs>& in, SymTensor& stress, State& state,
                                           double& shear_modulus) const {
    const auto [C10, C01] = static_cast<const LawType&>(*this).coefficients();
    const SymTensor b = carried(stretch_of_step(in.strain_increment, in.rotation), unit + state.stretch);
    // The change of volume of all steps drops out.
    const SymTensor isochoric = positive_power(max_of(determinant(b), 1e-200), -1.0 / 3.0) * b, e = isochoric - unit;
    const double per_volume = 2.0 / in.volume_ratio(), trace = e.trace();
    stress = per_volume * deviator((C10 + C01 * (1.0 + trace)) * e - C01 * square(e));
    state.stretch = e;
    // Waves of shear are fastest along the longest stretch by C10, across the shortest by C01: det b = 1.
    const double second = 0.5 * ((3.0 + trace) * (3.0 + trace) - double_dot(isochoric, isochoric));
    const SymTensor inverse_of_b = square(isochoric) - (3.0 + trace) * isochoric + second * unit;
    shear_modulus =
        per_volume * (C10 * largest_principal(isochoric) + max_of(C01, 0.0) * largest_principal(inverse_of_b));
  }
};
struct Coefficients {
  double C10, C01;  // [Pa]
};

struct NeoHookean final : Hyperelastic<NeoHookean> {
  double G = 0.0;  // [Pa]

  static void describe(Schema<NeoHookean>& s) {
    s.real(&NeoHookean::G, "shear_modulus", "Pa", positive, "shear modulus of small strains");
    describe_state(s);
  }
  Coefficients coefficients() const { return {0.5 * G, 0.0}; }
};

struct MooneyRivlin final : Hyperelastic<MooneyRivlin> {
  double C10 = 0.0, C01 = 0.0;  // [Pa]

  static void describe(Schema<MooneyRivlin>& s) {
    s.real(&MooneyRivlin::C10, "C10", "Pa", positive, "coefficient of the first invariant");
    s.real(&MooneyRivlin::C01, "C01", "Pa", any_value,
           "coefficient of the second invariant; below 0 the material is unstable at large strains")
        .usual(non_negative);
    s.rule("C01", "C10 + C01 must be positive: it is half of the shear modulus",
           [](const MooneyRivlin& m) { return m.C10 + m.C01 > 0.0; });
    describe_state(s);
  }
  Coefficients coefficients() const { return {C10, C01}; }
};

}  // namespace

KERF_REGISTER(KERF_TYPE(NeoHookean, "material", "neo_hookean", "rubber whose energy grows with the first invariant")
                  KERF_TYPE(MooneyRivlin, "material", "mooney_rivlin", "rubber with two coefficients"))
