// The update of solid elements with one integration point, block by block, with numbers of type `Real`, double or
// float: all that knows no corner. Strain, laws, energies, bulk viscosity, erosion and the stable step are here; the
// geometry, the forces of a stress on nodes, and hourglass control come from a formulation.
//
// In single precision stress and what the element keeps are floats, but masses, volumes, energies and what laws keep
// doubles. Equations of state and criteria get rows of doubles, materials rows of floats. Forces and energies are
// rounded to whole quanta of 64 bits in both.
//
// Sources: J. von Neumann & R.D. Richtmyer, J. Appl. Phys. 21 (1950) 232 and R. Landshoff, LA-1930 (1955) for the bulk
// viscosity; D.P. Flanagan & T. Belytschko, J. Appl. Mech. 51 (1984) 35-40 for the stable step.
#pragma once

#include <algorithm>
#include <bit>
#include <cstddef>
#include <limits>

#include "kerf/shock_sensor.hpp"
#include "kerf/solid_blocks.hpp"
#include "kerf/solid_element.hpp"
#include "kerf/solid_laws.hpp"
#include "kerf/solid_motion.hpp"

namespace kerf {

/// Computes the blocks of a part. `Formulation` derives from it, and adds, all of them always_inline for speed:
///
///   static void measure(const double* position, const double* velocity, const std::int32_t* nodes, Motion&);
///       Geometry and motion of a piece, but not the velocity gradient. `nodes` begins with the nodes of its first
///       lane.
///   static void forces_of_stress(const Motion&, const V (&sigma)[3][3], V (&force)[3][n_nodes]);
///       -sigma B of all nodes but the last, which gets minus the others' sum.
///
/// and, if it has hourglass modes, hides `find_forces`. `Motion` is its own, derived from SolidMotion. `State` is the
/// element's; see SolidElement.
template <class Real_, class Motion_, class State, class Formulation>
class SolidKernel {
 public:
  using Real = Real_;
  using Motion = Motion_;
  using Work = ElementArrays<Real>;
  using V = LanesOf<Real>;
  using Strain = StepStrain<Real>;
  using Rows = SolidRows<Real>;
  using Totals = SolidTotals;
  static constexpr int n_nodes = Motion::n_nodes;

  explicit SolidKernel(const SolidControl& control)
      : free_element_(control.free_element),
        finds_elastic_share_(control.finds_elastic_share),
        limited_viscosity_(control.limited_viscosity),
        linear_viscosity_(static_cast<Real>(control.linear_viscosity)),
        quadratic_viscosity_(static_cast<Real>(control.quadratic_viscosity)) {}

  void initialise(Work& w) const {
    for (int block = 0; block < w.n_blocks; ++block) {
      Motion k[pieces_of<Real>];
      Rows rows{};
      each_piece<Real>([&](int lane) __attribute__((always_inline)) {
        Motion& piece = k[lane / lanes_of<Real>];
        Formulation::measure(w.position, w.velocity, nodes_of(w, block, lane), piece);
        for (int part = 0; part < n_wide<Real>; ++part) {
          const int l = lane + part * register_lanes;
          const Lanes volume = piece.exact_volume[part];
          store_lanes(entry_at(w.volume, 1, block, 0, l), volume);
          store_lanes(rows.exact_density + l, load_lanes(entry_at(w.mass, 1, block, 0, l)) / volume);
        }
        if (mask_of(~(piece.volume > Real(0.0))) != 0 && w.inverted_block < 0) w.inverted_block = block;
        const V mass = load_lanes_as<Real>(entry_at(w.mass, 1, block, 0, lane));
        store_lanes(rows.density + lane, mass / piece.volume);
        store_lanes(rows.energy + lane, load_lanes_as<Real>(entry_at(w.internal_energy, 1, block, 0, lane)) / mass);
        store_lanes(rows.length + lane, piece.length);
        for (int i = 0; i < 6; ++i)
          store_lanes(rows.deviator[i] + lane, load_lanes(entry_at(w.deviator, 6, block, i, lane)));
      });
      stand_still(rows.step);
      update_deviator(w, block, rows);
      if (!w.solid) evaluate_eos(w, block, rows, false);
      each_piece<Real>([&](int lane) __attribute__((always_inline)) {
        const Motion& piece = k[lane / lanes_of<Real>];
        store_lanes(entry_at(w.pressure, 1, block, 0, lane), load_lanes_as<Real>(rows.pressure + lane));
        for (int i = 0; i < 6; ++i)
          store_lanes(entry_at(w.deviator, 6, block, i, lane), load_lanes(rows.deviator[i] + lane));
        const V rho = load_lanes(rows.density + lane), shear = load_lanes(rows.modulus + lane),
                K = load_lanes_as<Real>(rows.bulk + lane);
        store_free_share(w, block, lane);
        store_lanes(state_at(w, block, dilatation_rate, lane), initial_dilatation_rate(piece));
        note_step(w, block, lane, first_step(w, block, lane, piece, K, shear, rho));
        add_initial_forces(w, block, lane, piece);
      });
    }
  }

  void run(Work& w) const {
    Totals totals;
    const Real law_viscosity = longitudinal_viscosity(w);
    for (int block = 0; block < w.n_blocks; ++block) {
      fetch_ahead<n_nodes, Motion::newest_node>(w, block);
      update_block(w, block, law_viscosity, totals);
    }
    for (int l = 0; l < lane_width; ++l) w.hourglass_energy += totals.hourglass_energy[l];
  }

  /// What a piece of a block carries from one phase of the update to the next.
  struct Piece {
    Motion k;
    V s[6];  // deviator: rotated to the end of the step, later updated [Pa]
    V good;  // 1 where the volume is positive, otherwise 0
    V volume, old_volume, volume_change, per_volume;  // the first one positive
    V swept_excess;  // what the faces at the end of the step sweep beyond the change of volume; in fluids only [m3]
    V mass, per_mass, density, old_energy, work;  // the latter of the deviator in this step [J]
    V wave, c;  // rho c^2 [Pa], c [m/s]
    V viscosity, q, viscous_work, p;  // linear and quadratic [m/s]; bulk viscosity pressure [Pa]; [J]; [Pa]
    V stable;  // step [s]
    V elastic_share, solid;  // of the deviator's change; 1 with a shear modulus; if the control asks for them
  };

  /// Forces on all nodes but the last, in quanta; hourglass control adds to them in a function that hides this one.
  /// `alive` is 1, or 0 in lanes whose elements get no forces. Returns the sum of `sizes_of` the three directions,
  /// taken while the forces are still in registers.
  [[gnu::always_inline]] V find_forces(const Work& w, int, int, const Piece& p, const Strain&, V alive, Totals&,
                                       V (&force)[3][n_nodes]) const {
    const V scale = alive * static_cast<Real>(w.scale.per_quantum);
    V sigma[3][3];
    total_stress(p, sigma);
    for (int i = 0; i < 3; ++i)
      for (int j = 0; j < 3; ++j) sigma[i][j] *= scale;
    Formulation::forces_of_stress(p.k, sigma, force);
    return sizes_of(force[0]) + sizes_of(force[1]) + sizes_of(force[2]);
  }

 protected:
  static constexpr bool is_single = std::is_same_v<Real, float>;

  /// Sum of the sizes of the forces on all nodes but the last, in one direction.
  [[gnu::always_inline]] static V sizes_of(const V (&force)[n_nodes]) {
    V size{};
    for (int n = 0; n < n_nodes - 1; ++n) size += abs_of(force[n]);
    return size;
  }

  /// Stress with the pressure of the bulk viscosity [Pa].
  [[gnu::always_inline]] static void total_stress(const Piece& p, V (&sigma)[3][3]) {
    const V total = p.p + p.q;
    const V(&s)[6] = p.s;
    const V all[3][3] = {{s[0] - total, s[3], s[5]}, {s[3], s[1] - total, s[4]}, {s[5], s[4], s[2] - total}};
    for (int i = 0; i < 3; ++i)
      for (int j = 0; j < 3; ++j) sigma[i][j] = all[i][j];
  }

  [[gnu::always_inline]] static Real* state_at(const Work& w, int block, int component, int lane) {
    return entry_at(w.element_state, w.n_element_state, block, component, lane);
  }

 private:
  static constexpr int viscosity_pressure = place_in_state(offsetof(State, bulk_viscosity_pressure)),
                       free_share = place_in_state(offsetof(State, free_share)),
                       dilatation_rate = place_in_state(offsetof(State, dilatation_rate)),
                       shock_sensor = place_in_state(offsetof(State, shock_sensor));
  /// Way of a node in the first step over the length of its element. A wall may stop the node in it, and the step then
  /// shrinks while the forces are large, which makes energy: 1.8 % of a soft block's at 0.3, 0.2 % at 0.05.
  static constexpr double most_crossed = 0.05;
  [[gnu::always_inline]] static const std::int32_t* nodes_of(const Work& w, int block, int lane) {
    return entry_at(w.nodes, n_nodes, block, 0, lane);
  }

  /// An initial stress pushes from the first kick on.
  static void add_initial_forces(Work& w, int block, int lane, const Motion& k) {
    const auto scale = static_cast<Real>(w.scale.per_quantum);
    const V pressure = load_lanes(entry_at(w.pressure, 1, block, 0, lane));
    V s[6];
    for (int i = 0; i < 6; ++i)
      s[i] = (load_lanes(entry_at(w.deviator, 6, block, i, lane)) - (i < 3 ? pressure : V{})) * scale;
    const V sigma[3][3] = {{s[0], s[3], s[5]}, {s[3], s[1], s[4]}, {s[5], s[4], s[2]}};
    V force[3][n_nodes];
    Formulation::forces_of_stress(k, sigma, force);
    if (!scatter_forces<false>(w, nodes_of(w, block, lane), force) && w.bad_block < 0) w.bad_block = block;
  }

  /// Stable step with the viscosity of the initial velocity gradient. What the first step will do is not yet seen: a
  /// wall may stop the nodes in it. So no node may cross more than `most_crossed` of its element's length in it, and
  /// the next steps grow from there.
  [[gnu::always_inline]] V first_step(const Work& w, int block, int lane, const Motion& k, V bulk, V shear,
                                      V rho) const {
    const V closing = max_of(-initial_dilatation_rate(k), V{});
    const V c2 = (bulk + Real(4.0 / 3.0) * shear) / rho;
    const V viscosity = linear_viscosity_ * sqrt_of(c2) + quadratic_viscosity_ * k.length * closing +
                        longitudinal_viscosity(w) / (rho * k.length + tiny<Real>);
    const V stable = stable_step(w, block, lane, k, Real(1.0) / k.volume, viscosity, c2, bulk, shear, rho);
    V fastest{};
    for (int l = 0; l < lanes_of<Real>; ++l)
      for (int n = 0; n < n_nodes; ++n) {
        const double* v = w.velocity + 4 * static_cast<std::int64_t>(nodes_of(w, block, lane)[lane_width * n + l]);
        const double speed = std::sqrt(v[0] * v[0] + v[1] * v[1] + v[2] * v[2]);
        if (speed > fastest[l]) fastest[l] = static_cast<Real>(speed);
      }
    return min_of(stable, Real(most_crossed) * k.length / (fastest + tiny<Real>));
  }

  /// Of the material, against the motion of a plane wave; the stable step has to know it [Pa s].
  static Real longitudinal_viscosity(const Work& w) {
    return w.material ? static_cast<Real>(4.0 / 3.0 * w.material->viscosity()) : Real(0.0);
  }

  [[gnu::always_inline]] static V initial_dilatation_rate(const Motion& k) {
    V dilatation{};
    for (int i = 0; i < 3; ++i) dilatation += k.rate(i, i);
    return dilatation / k.volume;
  }

  /// Freedom to breathe: an element has 3 K where a plane wave has K + 4G/3. With neighbours behind all its faces it
  /// has none. Hexahedra at corners of bodies that are thicker than a cell have 3 faces exposed, and at Poisson's ratio
  /// 1/2 a quarter of the freedom; at corners of sheets they have 4 and two quarters, at ends of bars 5 and three, and
  /// alone 6 and all of it. In other shapes, too, the freedom grows from the third exposed face to the last.
  [[gnu::always_inline]] void store_free_share(Work& w, int block, int lane) const {
    V share{};
    for (int l = 0; l < lanes_of<Real>; ++l) {
      const int exposed = w.exposed_faces ? w.exposed_faces[block * lane_width + lane + l] : 0;
      share[l] =
          free_element_ ? Real(1.0) : Real(1.0 / (Motion::n_faces - 2)) * static_cast<Real>(std::max(exposed - 2, 0));
    }
    store_lanes(state_at(w, block, free_share, lane), share);
  }

  /// The plane wave's bound, with what a free element adds to it. With P_i the eigenvalues of B B^T, deformation along
  /// its axes has the stiffness 2 G P_i delta_ij + lambda sqrt(P_i P_j), whose largest eigenvalue is at most
  /// 2 G P_max + lambda tr P; the plane wave's is (2 G + lambda) P_max. The bulk viscosity's is tr P in place of P_max.
  /// Neighbours keep each other from breathing in all directions at once, so most elements do not need it.
  [[gnu::always_inline]] static V stable_step(const Work& w, int block, int lane, const Motion& k, V per_volume,
                                              V viscosity, V c2, V bulk, V shear, V rho) {
    const V share = load_lanes(state_at(w, block, free_share, lane));
    V fastest2 = c2;
    if (mask_of(share > Real(0.0)) != 0) [[unlikely]] {
      const V lambda = max_of(bulk - Real(2.0 / 3.0) * shear, V{});
      const V per_area = k.length * per_volume;  // 1 / sqrt(n/4 P_max) with n nodes
      const V others = share * max_of(Real(0.25 * n_nodes) * k.gradient_norm * per_area * per_area - Real(1.0), V{});
      fastest2 += lambda * others / rho;
      viscosity += others * viscosity;
    }
    return k.length / (viscosity + sqrt_of(viscosity * viscosity + fastest2) + tiny<Real>);
  }

  [[gnu::always_inline]] static void note_step(Work& w, int block, int lane, V step) {
    const V least = load_lanes(w.least_step + lane);
    const auto less = step < least;
    store_lanes(w.least_step + lane, less ? step : least);
    const LaneIntsOf<Real> where = load_lanes(w.least_block + lane);
    store_lanes(w.least_block + lane, less ? (LaneIntsOf<Real>{} + block) : where);
  }

  [[gnu::always_inline]] void update_block(Work& w, int block, Real law_viscosity, Totals& totals) const {
    Piece pieces[pieces_of<Real>];
    Rows rows;
    const auto piece = [&pieces](int lane) -> Piece& { return pieces[lane / lanes_of<Real>]; };
    each_piece<Real>([&](int lane) __attribute__((always_inline)) { deform(w, block, lane, piece(lane), rows); });
    update_deviator(w, block, rows);
    const bool uses_energy = !w.solid && w.eos->uses_energy();
    each_piece<Real>([&](int lane) __attribute__((always_inline)) {
      predict_energy(w, block, lane, uses_energy, piece(lane), rows);
    });
    if (!w.solid) evaluate_eos(w, block, rows, !uses_energy);
    each_piece<Real>([&](int lane) __attribute__((always_inline)) {
      add_viscosity(w, block, lane, uses_energy, law_viscosity, piece(lane), rows);
    });
    if (uses_energy) evaluate_eos(w, block, rows, true);
    each_piece<Real>([&](int lane) __attribute__((always_inline)) { finish_state(w, block, lane, piece(lane), rows); });
    const unsigned dead = w.judge ? judge_block(w, block, rows, pieces) : 0;
    alignas(64) Real alive[lane_width];
    std::fill_n(alive, lane_width, Real(1.0));
    for (unsigned left = dead; left != 0; left &= left - 1) alive[std::countr_zero(left)] = Real(0.0);
    if (dead != 0) [[unlikely]]
      each_piece<Real>([&](int lane) __attribute__((always_inline)) {
        take_back_work(w, block, lane, load_lanes(alive + lane), piece(lane), rows);
      });
    each_piece<Real>([&](int lane) __attribute__((always_inline)) {
      const Piece& p = piece(lane);
      const unsigned inverted = mask_of(~(p.k.volume > Real(0.0))) & ~(dead >> lane);
      if (inverted != 0 && w.inverted_block < 0) w.inverted_block = block;
      const V live = load_lanes(alive + lane) * p.good;
      note_step(w, block, lane, live > Real(0.0) ? p.stable : lanes(std::numeric_limits<Real>::max()));
      add_forces(w, block, lane, p, rows.step, live, totals);
    });
  }

  /// An element without volume keeps its state; it is eroded below, or stops the run. In single precision the new
  /// volume, its change, and the density that the equation of state will see are of double precision.
  [[gnu::always_inline]] static void update_volume(const Work& w, int block, int lane, Piece& p, Rows& rows) {
    p.good = p.k.volume > Real(0.0) ? lanes(Real(1.0)) : V{};
    constexpr int n = n_wide<Real>;
    Lanes volume[n], old_volume[n], change[n], per_volume[n];
    for (int part = 0; part < n; ++part) {
      const int l = lane + part * register_lanes;
      double* stored = entry_at(w.volume, 1, block, 0, l);
      old_volume[part] = load_lanes(stored);
      volume[part] = p.k.exact_volume[part] > 0.0 ? p.k.exact_volume[part] : old_volume[part];
      change[part] = volume[part] - old_volume[part];
      store_lanes(stored, volume[part]);
      per_volume[part] = 1.0 / volume[part];
      store_lanes(rows.exact_density + l, load_lanes(entry_at(w.mass, 1, block, 0, l)) * per_volume[part]);
    }
    p.per_volume = joined<Real>(per_volume);
    p.volume = joined<Real>(volume);
    p.old_volume = joined<Real>(old_volume);
    p.volume_change = joined<Real>(change);
  }

  /// From nodal motion to the strain of the step and the rotated deviator.
  [[gnu::always_inline]] static void deform(const Work& w, int block, int lane, Piece& p, Rows& rows) {
    Formulation::measure(w.position, w.velocity, nodes_of(w, block, lane), p.k);
    update_volume(w, block, lane, p, rows);
    for (int i = 0; i < 3; ++i)
      for (int j = 0; j < 3; ++j) p.k.velocity_gradient[i][j] = p.k.rate(i, j) * p.per_volume;
    strain_of_step<Real>(p.k.velocity_gradient, static_cast<Real>(w.dt), p.good, rows.step, lane);
    for (int i = 0; i < 6; ++i) p.s[i] = load_lanes(entry_at(w.deviator, 6, block, i, lane));
    rotate_rows<Real>(rows.step.rotation, lane, p.s);
    for (int i = 0; i < 6; ++i) store_lanes(rows.deviator[i] + lane, p.s[i]);
    p.mass = load_lanes_as<Real>(entry_at(w.mass, 1, block, 0, lane));
    p.per_mass = Real(1.0) / p.mass;
    p.density = p.mass * p.per_volume;
    p.old_energy = load_lanes_as<Real>(entry_at(w.internal_energy, 1, block, 0, lane));
    store_lanes(rows.density + lane, p.density);
    store_lanes(rows.energy + lane, p.old_energy * p.per_mass);
    store_lanes(rows.length + lane, p.k.length);
  }

  /// Change of the deviator over that of an elastic step, |s - R s R^T| / (2 G |dev strain|): one in elastic steps,
  /// little where the material flows.
  [[gnu::always_inline]] static V elastic_share(int lane, const V (&old)[6], const Rows& rows) {
    const auto& strain = rows.step.strain;
    const V mean =
        (load_lanes(strain[0] + lane) + load_lanes(strain[1] + lane) + load_lanes(strain[2] + lane)) * Real(1.0 / 3.0);
    V change2{}, strain2{};
    for (int i = 0; i < 6; ++i) {
      const V e = load_lanes(strain[i] + lane) - (i < 3 ? mean : V{});
      const V change = load_lanes(rows.deviator[i] + lane) - old[i];
      strain2 += Real(i < 3 ? 1.0 : 2.0) * e * e;
      change2 += Real(i < 3 ? 1.0 : 2.0) * change * change;
    }
    const V modulus = Real(2.0) * load_lanes(rows.modulus + lane);
    const V elastic2 = modulus * modulus * strain2;
    return change2 < elastic2 ? sqrt_of(change2 / (elastic2 + tiny<Real>)) : lanes(Real(1.0));
  }

  /// The deviator that the law has found keeps the share of this step, which takes the place of the last step's. So
  /// does what hourglass control holds of the element's shape.
  [[gnu::noinline]] void soften(Work& w, int block, int lane, Piece& p, Rows& rows) const {
    const auto factors = [&](int component) {
      return entry_at(w.softening, detail::n_softening, block, component, lane);
    };
    const V factor = load_lanes_as<Real>(factors(detail::next_strength));
    const V per_old =
        Real(1.0) / max_of(load_lanes_as<Real>(factors(detail::strength_applied)), lanes(Real(detail::least_factor)));
    if (finds_elastic_share_) {
      V sound[6];
      for (int i = 0; i < 6; ++i) sound[i] = p.s[i] * per_old;
      p.elastic_share = elastic_share(lane, sound, rows) * factor;
      p.solid *= min_of(max_of(factor * per_old, lanes(Real(detail::least_factor))), lanes(Real(1.0)));
    }
    for (int i = 0; i < 6; ++i) store_lanes(rows.deviator[i] + lane, load_lanes(rows.deviator[i] + lane) * factor);
    std::copy_n(factors(detail::next_strength), lanes_of<Real>, factors(detail::strength_applied));
    std::copy_n(factors(detail::next_tension), lanes_of<Real>, factors(detail::tension_applied));
    std::copy_n(factors(detail::next_compression), lanes_of<Real>, factors(detail::compression_applied));
  }

  /// Work of the mean of the old and the new deviator; energy with the old pressure, for the EOS.
  [[gnu::always_inline]] void predict_energy(Work& w, int block, int lane, bool uses_energy, Piece& p,
                                             Rows& rows) const {
    if (finds_elastic_share_) {
      if (!w.softening) [[likely]]
        p.elastic_share = elastic_share(lane, p.s, rows);
      p.solid = load_lanes(rows.modulus + lane) > Real(0.0) ? lanes(Real(1.0)) : V{};
    }
    if (w.softening) [[unlikely]]
      soften(w, block, lane, p, rows);
    V work{};
    for (int i = 0; i < 6; ++i) {
      const V now = load_lanes(rows.deviator[i] + lane);
      work += Real(i < 3 ? 1.0 : 2.0) * (p.s[i] + now) * load_lanes(rows.step.strain[i] + lane);
      p.s[i] = now;
      store_lanes(entry_at(w.deviator, 6, block, i, lane), now);
    }
    p.work = work * (Real(0.25) * (p.volume + p.old_volume));
    if (!uses_energy) return;
    const V old_pressure = load_lanes(entry_at(w.pressure, 1, block, 0, lane));
    const V predicted = p.old_energy + p.work - old_pressure * p.volume_change;
    store_lanes(rows.energy + lane, predicted * p.per_mass);
  }

  /// Wave speed, bulk viscosity in compression only (von Neumann & Richtmyer 1950; Landshoff 1955), and the centred
  /// energy.
  [[gnu::always_inline]] void add_viscosity(const Work& w, int block, int lane, bool uses_energy, Real law_viscosity,
                                            Piece& p, Rows& rows) const {
    const V wave = load_lanes_as<Real>(rows.bulk + lane) + Real(4.0 / 3.0) * load_lanes(rows.modulus + lane);
    // A modulus that is no number stays none, and shows in the forces.
    p.wave = wave <= Real(0.0) ? V{} : wave;
    p.c = sqrt_of(p.wave / p.density) + tiny<Real>;
    p.swept_excess = load_lanes(rows.modulus + lane) > Real(0.0) ? V{} : p.good * (swept(w, p.k) - p.volume_change);
    const auto& strain = rows.step.strain;
    const Real per_dt = Real(1.0) / static_cast<Real>(w.dt);
    const V dilatation =
        (load_lanes(strain[0] + lane) + load_lanes(strain[1] + lane) + load_lanes(strain[2] + lane)) * per_dt;
    const V closing = dilatation < Real(0.0) ? -dilatation : V{};
    const V quadratic = quadratic_viscosity_ * p.k.length * closing;
    V linear = linear_viscosity_ * p.c;
    p.viscosity = linear + quadratic;
    if (law_viscosity > Real(0.0)) [[unlikely]]
      p.viscosity += law_viscosity / (p.density * p.k.length + tiny<Real>);
    if (limited_viscosity_)
      linear *= shock_share<Real>(p.k.length, p.c, dilatation, static_cast<Real>(w.dt), per_dt,
                                  state_at(w, block, dilatation_rate, lane), state_at(w, block, shock_sensor, lane));
    p.q = p.k.volume > Real(0.0) ? p.density * p.k.length * closing * (linear + quadratic) : V{};
    Real* stored = state_at(w, block, viscosity_pressure, lane);
    const V old_q = load_lanes(stored);
    store_lanes(stored, p.q);
    p.viscous_work = Real(-0.5) * (old_q + p.q) * p.volume_change;
    if (!uses_energy) return;
    const V old_pressure = load_lanes(entry_at(w.pressure, 1, block, 0, lane));
    const V centred = p.old_energy + p.work + p.viscous_work -
                      pressure_work(p, old_pressure, load_lanes_as<Real>(rows.pressure + lane));
    store_lanes(rows.energy + lane, centred * p.per_mass);
  }

  [[gnu::always_inline]] static V swept(const Work& w, const Motion& k) {
    return (k.rate(0, 0) + k.rate(1, 1) + k.rate(2, 2)) * static_cast<Real>(w.dt);
  }
  /// Work that a pressure gives to the nodes: half of that of the old one on the faces as they were, and half of that
  /// of the new one on the faces as they are. The faces' mean sweeps the change of volume, those at the end of the step
  /// more where an element grows. The difference is of second order in the strain of a step, and nothing in one
  /// dimension, but a gas that bursts into a void has both: its balance was off by 1.4 % in a stick of explosive.
  [[gnu::always_inline]] static V pressure_work(const Piece& p, V old_pressure, V pressure) {
    return Real(0.5) * (old_pressure + pressure) * p.volume_change +
           Real(0.5) * (pressure - old_pressure) * p.swept_excess;
  }

  /// Energies and pressure at the end of the step, and the stable step with the viscosity's share.
  [[gnu::always_inline]] void finish_state(Work& w, int block, int lane, Piece& p, const Rows& rows) const {
    p.p = load_lanes_as<Real>(rows.pressure + lane);
    const V old_pressure = load_lanes(entry_at(w.pressure, 1, block, 0, lane));
    double *internal_energy = entry_at(w.internal_energy, 1, block, 0, lane),
           *viscous_energy = entry_at(w.viscous_energy, 1, block, 0, lane);
    const V given = pressure_work(p, old_pressure, p.p);
    if constexpr (is_single) {
      add_lanes(internal_energy, p.work + p.viscous_work - given);
      add_lanes(viscous_energy, p.viscous_work);
    } else {
      store_lanes(internal_energy, p.old_energy + p.work + p.viscous_work - given);
      store_lanes(viscous_energy, load_lanes(viscous_energy) + p.viscous_work);
    }
    store_lanes(entry_at(w.pressure, 1, block, 0, lane), p.p);
    p.stable = stable_step(w, block, lane, p.k, p.per_volume, p.viscosity, p.c * p.c,
                           load_lanes_as<Real>(rows.bulk + lane), load_lanes(rows.modulus + lane), p.density);
  }

  /// The stress that an element dies with never acts on its nodes: of the work of the step only the share of the old
  /// stress was given by them, and the share of the new one is taken back.
  static void take_back_work(Work& w, int block, int lane, V alive, const Piece& p, const Rows& rows) {
    V work{};
    for (int i = 0; i < 6; ++i) work += Real(i < 3 ? 1.0 : 2.0) * p.s[i] * load_lanes(rows.step.strain[i] + lane);
    const V dead = Real(1.0) - alive, viscous = Real(-0.5) * p.q * p.volume_change * dead;
    const V given = work * (Real(0.25) * (p.volume + p.old_volume)) * dead -
                    Real(0.5) * p.p * (p.volume_change + p.swept_excess) * dead;
    add_lanes(entry_at(w.internal_energy, 1, block, 0, lane), -(given + viscous));
    add_lanes(entry_at(w.viscous_energy, 1, block, 0, lane), -viscous);
  }

  /// Which lanes erode, as a bit mask.
  unsigned judge_block(Work& w, int block, const Rows& law_rows, const Piece (&pieces)[pieces_of<Real>]) const {
    alignas(64) double stress[6][lane_width], pressure[lane_width], density[lane_width], volume[lane_width],
        time_step[lane_width];
    StepStrain<double> in_doubles;
    const StepStrain<double>& wide = widen(law_rows.step, in_doubles);
    each_piece<Real>([&](int lane) __attribute__((always_inline)) {
      const Piece& p = pieces[lane / lanes_of<Real>];
      const auto reference = static_cast<Real>(w.reference_density);
      for (int i = 0; i < 6; ++i) store_lanes(stress[i] + lane, i < 3 ? p.s[i] - p.p : p.s[i]);
      store_lanes(pressure + lane, p.p);
      store_lanes(density + lane, p.density / reference);
      store_lanes(volume + lane, p.k.volume * reference / p.mass);
      store_lanes(time_step + lane, p.stable);
    });
    ErosionBatch rows;
    detail::AskedRows asked;
    if (const unsigned inputs = w.judge->asked_inputs() & ~with_rotation; inputs != 0) [[unlikely]]
      detail::fill_asked(w, block, inputs, law_rows, asked, rows);
    rows.dt = w.dt;
    rows.time = w.time;
    rows.stress = stress;
    rows.strain_increment = wide.strain;
    rows.rotation = wide.rotation;
    rows.pressure = pressure;
    rows.density_ratio = density;
    rows.volume_ratio = volume;
    rows.time_step = time_step;
    const unsigned dead = w.judge->judge(rows, block);
    w.failed[block] = static_cast<std::uint8_t>(dead);
    return dead;
  }

  /// The last node takes minus the others' sum, so that an element's forces add up to nothing exactly.
  [[gnu::always_inline]] void add_forces(Work& w, int block, int lane, const Piece& p, const Strain& step, V alive,
                                         Totals& totals) const {
    V force[3][n_nodes];
    const V size = static_cast<const Formulation&>(*this).find_forces(w, block, lane, p, step, alive, totals, force);
    const std::int32_t* nodes = nodes_of(w, block, lane);
    if (mask_of(size < static_cast<Real>(small_limit)) == all_lanes_of<Real>) [[likely]]
      scatter_forces<true>(w, nodes, force);
    else if (!scatter_forces<false>(w, nodes, force) && w.bad_block < 0)
      w.bad_block = block;
  }

  bool free_element_, finds_elastic_share_, limited_viscosity_;
  Real linear_viscosity_, quadratic_viscosity_;
};

}  // namespace kerf
