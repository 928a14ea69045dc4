// The formulation of eight-node hexahedra for SolidKernel: the mean gradient's forces and hourglass control.
//
// In single precision the nodes' motion relative to the element's first node is taken in doubles and then rounded.
//
// Sources: see ../hex8.cpp.
#pragma once

#include <cstddef>

#include <kerf/solid_kernel.hpp>

#include "control.hpp"
#include "kinematics.hpp"

namespace kerf::hex8 {

template <class Real>
class Kernel : public SolidKernel<Real, Kinematics<Real>, State, Kernel<Real>> {
  using Base = SolidKernel<Real, Kinematics<Real>, State, Kernel<Real>>;
  using typename Base::Piece, typename Base::Strain, typename Base::Totals, typename Base::V, typename Base::Work;
  using Motion = Kinematics<Real>;

 public:
  explicit Kernel(const Control& control)
      : Base(control.solid),
        stiffness_(control.solid.finds_elastic_share),
        hourglass_coefficient_(static_cast<Real>(control.hourglass_coefficient)) {}

  [[gnu::always_inline]] static void measure(const double* position, const double* velocity, const std::int32_t* nodes,
                                             Motion& k) {
    gather(position, velocity, nodes, k);
    hex8::measure(k);
  }

  [[gnu::always_inline]] static void forces_of_stress(const Motion& k, const V (&sigma)[3][3], V (&force)[3][8]) {
    for (int i = 0; i < 3; ++i) {
      V along[n_modes] = {};
      for (int m = 0; m < n_gradient_modes; ++m)
        along[m] = -(sigma[i][0] * k.b[0][m] + sigma[i][1] * k.b[1][m] + sigma[i][2] * k.b[2][m]);
      spread(along, force[i]);
    }
  }

  /// f_I = -(sigma - hourglass correction) B_I - hourglass, in quanta.
  [[gnu::always_inline]] V find_forces(const Work& w, int block, int lane, const Piece& p, const Strain& step, V alive,
                                       Totals& totals, V (&force)[3][8]) const {
    const Motion& k = p.k;
    V shape[3][4], rate[3][4];
    for (int d = 0; d < 3; ++d) std::copy_n(k.x[d] + first_hourglass, 4, shape[d]);
    for (int i = 0; i < 3; ++i)
      for (int a = 0; a < 4; ++a) {
        rate[i][a] = k.v[i][first_hourglass + a];
        for (int j = 0; j < 3; ++j) rate[i][a] -= k.velocity_gradient[i][j] * shape[j][a];
      }

    V resist[3][4];
    if (stiffness_)
      resist_displacement(w, block, lane, p, step, shape, rate, alive, resist, totals);
    else
      resist_velocity(w, block, lane, p, shape, rate, alive, resist, totals);

    const V scale = alive * static_cast<Real>(w.scale.per_quantum);
    V sigma[3][3], size{};
    Base::total_stress(p, sigma);
    for (int i = 0; i < 3; ++i) {
      for (int j = 0; j < 3; ++j) {
        V correction{};
        for (int a = 0; a < 4; ++a) correction += resist[i][a] * shape[j][a];
        sigma[i][j] = (sigma[i][j] - correction * p.per_volume) * scale;
      }
      V along[n_modes];
      along[xi_eta_zeta] = -(resist[i][3] * scale);
      for (int m = 0; m < n_gradient_modes; ++m) {
        along[m] = -(sigma[i][0] * k.b[0][m] + sigma[i][1] * k.b[1][m] + sigma[i][2] * k.b[2][m]);
        if (m >= first_hourglass) along[m] -= resist[i][m - first_hourglass] * scale;
      }
      spread(along, force[i]);
      size += Base::sizes_of(force[i]);
    }
    return size;
  }

 private:
  static constexpr int resistance = place_in_state(offsetof(State, resistance));
  /// What viscous hourglass control may take of an hourglass velocity in a step: all of it. Twice as much would be the
  /// limit of stability.
  static constexpr double most_effect = 1.0;
  /// Square of frequency times step that hourglass control by stiffness may give to the modes of an element: half of
  /// the limit of stability.
  static constexpr double most_effect_of_growth = 2.0;

  /// Upper bound of the largest eigenvalue of gamma_a . gamma_b, the products of the hourglass shape vectors; eight for
  /// a parallelepiped. With s = x . Gamma / V, gamma = Gamma - B s and p = B Gamma, the products are
  /// 8 I - s^T (p - B B^T s) - p^T s, and what is subtracted is bounded by its Frobenius norm.
  [[gnu::noinline]] static V largest_shape(const Piece& p, const V (&shape)[3][4]) {
    const Motion& k = p.k;
    V base[3][4], s[3][4], r[3][4];  // of the gradient; shape per volume; gradient along the shape vectors
    for (int i = 0; i < 3; ++i)
      for (int a = 0; a < 4; ++a) base[i][a] = a < 3 ? Real(8.0) * k.b[i][first_hourglass + a] : V{};
    for (int i = 0; i < 3; ++i)
      for (int a = 0; a < 4; ++a) s[i][a] = shape[i][a] * p.per_volume;
    for (int i = 0; i < 3; ++i) {
      V m[3];
      for (int j = 0; j < 3; ++j) m[j] = k.product(i, j);
      for (int a = 0; a < 4; ++a) r[i][a] = base[i][a] - (m[0] * s[0][a] + m[1] * s[1][a] + m[2] * s[2][a]);
    }
    V norm2{};
    for (int a = 0; a < 4; ++a)
      for (int b = a; b < 4; ++b) {
        V d{};
        for (int i = 0; i < 3; ++i) d += s[i][a] * r[i][b] + base[i][a] * s[i][b];
        norm2 += Real(a == b ? 1.0 : 2.0) * d * d;
      }
    return Real(8.0) + sqrt_of(norm2);
  }

  /// What is left of a resistance whose largest effect on the hourglass velocities of a cube in this step would be
  /// `effect`, so that the effect is at most `most` in the present shape. In most elements a bound by the lengths of
  /// the shape vectors says that nothing has to go: sqrt(8) (1 + x) at most, x = |s| V / (4 length), and
  /// (1 + x)^2 <= 1.2 + 6 x^2.
  [[gnu::always_inline]] static V bounded_share(const Piece& p, const V (&shape)[3][4], V effect, V most) {
    V size2{};
    for (int i = 0; i < 3; ++i)
      for (int a = 0; a < 4; ++a) size2 += shape[i][a] * shape[i][a];
    const V length2 = p.k.length * p.k.length;
    const auto may_exceed = effect * (Real(1.2) * length2 + Real(0.375) * size2) > most * length2;
    V share = lanes(Real(1.0));
    if (mask_of(may_exceed) != 0) [[unlikely]] {
      const V exact = effect * largest_shape(p, shape) * Real(0.125);
      share = may_exceed && exact > most ? most / exact : share;
    }
    return share;
  }

  [[gnu::always_inline]] V viscous_coefficient(const Piece& p) const {
    const V area = sqrt_of(p.k.gradient_norm * Real(2.0 / 3.0));
    return (Real(0.25) * hourglass_coefficient_) * p.mass * p.per_volume * p.c * area;
  }

  /// Viscous control: resistance = Q/4 rho c A g (Hallquist 1998, eq. 3.21, with A = sqrt(2/3 B:B), which is the
  /// face area of a cube). A force acts on the mean of the velocities before and after it, so half of its work is
  /// booked now and half in the next step, which knows the velocity after it. At most it stops the hourglass motion of
  /// an element within a step.
  [[gnu::always_inline]] void resist_velocity(const Work& w, int block, int lane, const Piece& p,
                                              const V (&shape)[3][4], const V (&rate)[3][4], V alive, V (&resist)[3][4],
                                              Totals& totals) const {
    V coefficient = viscous_coefficient(p);
    const V effect = Real(64.0) * static_cast<Real>(w.dt) * p.per_mass * coefficient;
    coefficient *= bounded_share(p, shape, effect, lanes(Real(most_effect)));
    V work{};
    for (int a = 0; a < 4; ++a)
      for (int i = 0; i < 3; ++i) {
        resist[i][a] = coefficient * rate[i][a];
        Real* stored = Base::state_at(w, block, resistance + 3 * a + i, lane);
        work += (load_lanes(stored) + alive * resist[i][a]) * rate[i][a];
        store_lanes(stored, resist[i][a]);
      }
    book_hourglass(w, lane, work, p.good, totals);
  }

  /// Stiffness control (Flanagan & Belytschko 1981, eqs. 63-67): resistance grows with k g dt and turns with the
  /// element; k = kappa/24 (K + 4G/3) B:B/V, so that kappa = 1 would give the hourglass modes of a cube the
  /// highest frequency of the element. A fluid has no shape to hold: it gets the viscous form. Where a solid flows, a
  /// resistance grows as little as the deviator does. The shape vectors of the step's end see the rate in the
  /// directions of its start: they take the rotation for a part of the linear motion. So the rate turns together with
  /// the old resistance.
  [[gnu::always_inline]] void resist_displacement(const Work& w, int block, int lane, const Piece& p,
                                                  const Strain& step, const V (&shape)[3][4], const V (&rate)[3][4],
                                                  V alive, V (&resist)[3][4], Totals& totals) const {
    const auto dt = static_cast<Real>(w.dt);
    const auto solid = p.solid > Real(0.0);
    V elastic = (hourglass_coefficient_ / Real(24.0)) * p.wave * p.k.gradient_norm * p.per_volume * dt;
    elastic = solid ? elastic : viscous_coefficient(p);
    elastic *= bounded_share(p, shape, Real(64.0) * dt * p.per_mass * elastic,
                             solid ? lanes(Real(most_effect_of_growth)) : lanes(Real(most_effect)));
    const V flowing = elastic * (solid ? p.elastic_share : lanes(Real(1.0)));
    V work{};
    V r[9];
    for (int i = 0; i < 9; ++i) r[i] = load_lanes(step.rotation[i] + lane);
    for (int a = 0; a < 4; ++a) {
      V grown[3];
      for (int i = 0; i < 3; ++i) {
        const V old = load_lanes(Base::state_at(w, block, resistance + 3 * a + i, lane));
        // What falls does so with the full stiffness, down to nothing: it must not give back more than it has taken.
        const V full = abs_of(elastic * rate[i][a]), zero{};
        const V falling = old * rate[i][a] < zero ? min_of(abs_of(old) / (full + tiny<Real>), lanes(Real(1.0))) : zero;
        const V growth = flowing + (elastic - flowing) * falling;
        grown[i] = p.solid * old + growth * rate[i][a];
        work += (old + alive * grown[i]) * rate[i][a];
      }
      for (int i = 0; i < 3; ++i) {
        resist[i][a] = r[3 * i] * grown[0] + r[3 * i + 1] * grown[1] + r[3 * i + 2] * grown[2];
        if constexpr (std::is_same_v<Real, float>) resist[i][a] += grown[i];
        store_lanes(Base::state_at(w, block, resistance + 3 * a + i, lane), resist[i][a]);
      }
    }
    book_hourglass(w, lane, work, p.good, totals);
  }

  bool stiffness_;
  Real hourglass_coefficient_;
};

}  // namespace kerf::hex8
