// The update of eight-node hexahedra, block by block, with numbers of type `Real`, double or float: strain, laws,
// energies, erosion, hourglass control, forces.
//
// In single precision stress and what the element keeps are floats, but masses, volumes, energies and what laws keep
// doubles; the nodes' motion relative to the element's first node is taken in doubles and then rounded. Equations of
// state and criteria get rows of doubles, materials rows of floats. Forces and energies are rounded to whole quanta of
// 64 bits in both.
//
// Sources: see ../hex8.cpp.
#pragma once

#include <algorithm>
#include <bit>
#include <limits>

#include "control.hpp"
#include "kinematics.hpp"

namespace kerf::hex8 {

template <class Real>
class Kernel {
 public:
  using Work = ElementArrays<Real>;
  using V = LanesOf<Real>;
  using Motion = Kinematics<Real>;
  using Strain = StepStrain<Real>;

  explicit Kernel(const Control& control)
      : free_element_(control.free_element),
        stiffness_(control.stiffness),
        limited_viscosity_(control.limited_viscosity),
        hourglass_coefficient_(static_cast<Real>(control.hourglass_coefficient)),
        linear_viscosity_(static_cast<Real>(control.linear_viscosity)),
        quadratic_viscosity_(static_cast<Real>(control.quadratic_viscosity)) {}

  void initialise(Work& w) const {
    for (int block = 0; block < w.n_blocks; ++block) {
      Motion k[pieces_of<Real>];
      Rows rows{};
      each_piece<Real>([&](int lane) __attribute__((always_inline)) {
        Motion& piece = k[lane / lanes_of<Real>];
        gather(w.position, w.velocity, nodes_of(w, block, lane), piece);
        measure(piece);
        for (int part = 0; part < n_wide<Real>; ++part) {
          const int l = lane + part * register_lanes;
          const Lanes volume = piece.exact_volume[part];
          store_lanes(at(w.volume, 1, block, 0, l), volume);
          store_lanes(rows.exact_density + l, load_lanes(at(w.mass, 1, block, 0, l)) / volume);
        }
        if (mask_of(~(piece.volume > Real(0.0))) != 0 && w.inverted_block < 0) w.inverted_block = block;
        store_lanes(rows.density + lane, load_lanes_as<Real>(at(w.mass, 1, block, 0, lane)) / piece.volume);
        for (int i = 0; i < 6; ++i) store_lanes(rows.deviator[i] + lane, load_lanes(at(w.deviator, 6, block, i, lane)));
      });
      update_material(w, block, rows);
      evaluate_eos(w, block, rows);
      each_piece<Real>([&](int lane) __attribute__((always_inline)) {
        const Motion& piece = k[lane / lanes_of<Real>];
        store_lanes(at(w.pressure, 1, block, 0, lane), load_lanes_as<Real>(rows.pressure + lane));
        for (int i = 0; i < 6; ++i) store_lanes(at(w.deviator, 6, block, i, lane), load_lanes(rows.deviator[i] + lane));
        const V rho = load_lanes(rows.density + lane), shear = load_lanes(rows.modulus + lane),
                K = load_lanes_as<Real>(rows.bulk + lane);
        store_free_share(w, block, lane);
        store_lanes(state_at(w, block, dilatation_rate, lane), initial_dilatation_rate(piece));
        note_step(w, block, lane, first_step(w, block, lane, piece, K, shear, rho));
        add_initial_forces(w, block, lane, piece);
      });
    }
  }

  /// Stable step with the viscosity of the initial velocity gradient. What the first step will do is not yet seen: a
  /// wall may stop the nodes in it. So no node may cross more than `most_crossed` of its element's length in it, and
  /// the next steps grow from there.
  [[gnu::always_inline]] V first_step(const Work& w, int block, int lane, const Motion& k, V bulk, V shear,
                                      V rho) const {
    const V closing = max_of(-initial_dilatation_rate(k), V{});
    const V c2 = (bulk + Real(4.0 / 3.0) * shear) / rho;
    const V viscosity = linear_viscosity_ * sqrt_of(c2) + quadratic_viscosity_ * k.length * closing;
    const V stable = stable_step(w, block, lane, k, Real(1.0) / k.volume, viscosity, c2, bulk, shear, rho);
    V fastest{};
    for (int l = 0; l < lanes_of<Real>; ++l)
      for (int n = 0; n < 8; ++n) {
        const double* v = w.velocity + 4 * static_cast<std::int64_t>(nodes_of(w, block, lane)[lane_width * n + l]);
        const double speed = std::sqrt(v[0] * v[0] + v[1] * v[1] + v[2] * v[2]);
        if (speed > fastest[l]) fastest[l] = static_cast<Real>(speed);
      }
    return min_of(stable, Real(most_crossed) * k.length / (fastest + tiny<Real>));
  }

  [[gnu::always_inline]] static V initial_dilatation_rate(const Motion& k) {
    V dilatation{};
    for (int i = 0; i < 3; ++i) dilatation += dot6(k.v[i], k.b[i]);
    return dilatation / k.volume;
  }

  void run(Work& w) const {
    Totals totals;
    for (int block = 0; block < w.n_blocks; ++block) {
      fetch_ahead(w, block);
      update_block(w, block, totals);
    }
    for (int l = 0; l < lane_width; ++l) w.hourglass_energy += totals.hourglass_energy[l];
  }

 private:
  /// What a piece of a block carries from one phase of the update to the next.
  struct Piece {
    Motion k;
    V s[6];  // deviator: rotated to the end of the step, later updated [Pa]
    V good;  // 1 where the volume is positive, otherwise 0
    V volume, old_volume, volume_change, per_volume;  // the first one positive
    V mass, per_mass, density, old_energy, work;  // the latter of the deviator in this step [J]
    V wave, c;  // rho c^2 [Pa], c [m/s]
    V viscosity, q, viscous_work, p;  // linear and quadratic [m/s]; bulk viscosity pressure [Pa]; [J]; [Pa]
    V stable;  // step [s]
    V elastic_share, solid;  // of the deviator's change; 1 with a shear modulus; for hourglass control by stiffness
  };
  static constexpr bool is_single = std::is_same_v<Real, float>;
  static constexpr int free_share = 13, dilatation_rate = 14, shock_sensor = 15;  // in the state; see hex8.cpp
  /// What viscous hourglass control may take of an hourglass velocity in a step: all of it. Twice as much would be the
  /// limit of stability.
  static constexpr double most_effect = 1.0;
  /// Way of a node in the first step over the length of its element. A wall may stop the node in it, and the step then
  /// shrinks while the forces are large, which makes energy: 1.8 % of a soft block's at 0.3, 0.2 % at 0.05.
  static constexpr double most_crossed = 0.05;
  /// The sensor of shocks, of the square of the relative change of the dilatation rate per crossing of the element:
  /// its factor, its greatest value, and what it loses per crossing by a wave.
  static constexpr double sensor_factor = 2.0, most_sensed = 2.0, sensor_loss = 0.125;
  /// Where the velocity jumps by 1/400 of the wave speed across an element, all of the linear viscosity acts anyway.
  static constexpr double jump_factor = 400.0;
  static constexpr double least_rate = 1e-20;  // below it, a dilatation rate counts as zero [1/s]
  /// Square of frequency times step that hourglass control by stiffness may give to the modes of an element: half of
  /// the limit of stability.
  static constexpr double most_effect_of_growth = 2.0;
  /// Rows of a block, for laws and criteria.
  struct Rows {
    Strain step;
    alignas(64) Real deviator[6][lane_width], density[lane_width], energy[lane_width], modulus[lane_width];
    alignas(64) double exact_density[lane_width], pressure[lane_width], bulk[lane_width];  // for the EOS, and from it
  };
  /// Sums over blocks.
  struct Totals {
    alignas(64) std::int64_t hourglass_energy[lane_width] = {};  // in quanta
  };

  /// The row itself, or its copy in double precision.
  [[gnu::always_inline]] static const double* widen(const double* row, double*) { return row; }
  [[gnu::always_inline]] static const double* widen(const float* row, double* wide) {
    for (int lane = 0; lane < lane_width; lane += single_lanes) store_lanes(wide + lane, load_lanes(row + lane));
    return wide;
  }
  /// The step as criteria see it.
  [[gnu::always_inline]] static const StepStrain<double>& widen(const Strain& step, StepStrain<double>& wide) {
    if constexpr (!is_single) {
      return step;
    } else {
      for (int i = 0; i < 6; ++i) widen(step.strain[i], wide.strain[i]);
      for (int i = 0; i < 9; ++i) widen(step.rotation[i], wide.rotation[i]);
      for (int i = 0; i < 9; i += 4)
        for (int l = 0; l < lane_width; ++l) wide.rotation[i][l] += 1.0;
      return wide;
    }
  }

  /// Entry of a blocked array: [block][n_components][lane].
  template <class Number>
  [[gnu::always_inline]] static Number* at(Number* array, int n_components, int block, int component, int lane) {
    return array + (static_cast<std::int64_t>(block) * n_components + component) * lane_width + lane;
  }
  [[gnu::always_inline]] static Real* state_at(const Work& w, int block, int component, int lane) {
    return at(w.element_state, w.n_element_state, block, component, lane);
  }
  [[gnu::always_inline]] static const std::int32_t* nodes_of(const Work& w, int block, int lane) {
    return at(w.nodes, 8, block, 0, lane);
  }

  /// An initial pressure pushes from the first kick on.
  static void add_initial_forces(Work& w, int block, int lane, const Motion& k) {
    const V pressure = load_lanes(at(w.pressure, 1, block, 0, lane)) * static_cast<Real>(w.scale.per_quantum);
    V force[3][8];
    for (int i = 0; i < 3; ++i) {
      V along[n_modes] = {};
      for (int m = 0; m < n_gradient_modes; ++m) along[m] = pressure * k.b[i][m];
      spread(along, force[i]);
    }
    scatter_forces<false>(w, nodes_of(w, block, lane), force);
  }

  /// Freedom to breathe: an element has 3 K where a plane wave has K + 4G/3. With neighbours behind all its faces it
  /// has none. Corners of bodies that are thicker than a cell have 3 faces exposed, and at Poisson's ratio 1/2 a
  /// quarter of the freedom; corners of sheets have 4 and two quarters, ends of bars 5 and three, single cells 6 and
  /// all of it.
  [[gnu::always_inline]] void store_free_share(Work& w, int block, int lane) const {
    V share{};
    for (int l = 0; l < lanes_of<Real>; ++l) {
      const int exposed = w.exposed_faces ? w.exposed_faces[block * lane_width + lane + l] : 0;
      share[l] = free_element_ ? Real(1.0) : Real(0.25) * static_cast<Real>(std::max(exposed - 2, 0));
    }
    store_lanes(at(w.element_state, w.n_element_state, block, free_share, lane), share);
  }

  /// The plane wave's bound, with what a free element adds to it. With P_i the eigenvalues of B B^T, deformation along
  /// its axes has the stiffness 2 G P_i delta_ij + lambda sqrt(P_i P_j), whose largest eigenvalue is at most
  /// 2 G P_max + lambda tr P; the plane wave's is (2 G + lambda) P_max. The bulk viscosity's is tr P in place of P_max.
  /// Neighbours keep each other from breathing in all directions at once, so most elements do not need it.
  [[gnu::always_inline]] static V stable_step(const Work& w, int block, int lane, const Motion& k, V per_volume,
                                              V viscosity, V c2, V bulk, V shear, V rho) {
    const V share = load_lanes(at(w.element_state, w.n_element_state, block, free_share, lane));
    V fastest2 = c2;
    if (mask_of(share > Real(0.0)) != 0) [[unlikely]] {
      const V lambda = max_of(bulk - Real(2.0 / 3.0) * shear, V{});
      const V per_area = k.length * per_volume;  // 1 / sqrt(2 P_max)
      const V others = share * max_of(Real(2.0) * k.gradient_norm * per_area * per_area - Real(1.0), V{});
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

  static void evaluate_eos(Work& w, int block, Rows& rows) {
    alignas(64) double wide[lane_width];
    EosBatch e;
    e.reference_density = w.reference_density;
    e.density = rows.exact_density;
    e.specific_energy = widen(rows.energy, wide);
    e.state = at(w.eos_state, w.n_eos_state, block, 0, 0);
    e.pressure = rows.pressure;
    e.bulk_modulus = rows.bulk;
    w.eos->evaluate(e);
  }

  /// Asks for what the next blocks will read: a part has more arrays than the hardware can foresee, and nodes are
  /// known by their numbers alone. Worth half of the speed of large models.
  [[gnu::always_inline]] static void fetch_ahead(const Work& w, int block) {
    constexpr int fields_ahead = 3, nodes_ahead = 2;  // blocks; 2 to 8 and 1 to 4 are much the same
    const std::int64_t far = std::min(block + fields_ahead, w.n_blocks - 1);
    // Always in line: as a function that does nothing but ask, it would be left out.
    const auto fetch = [far](const auto* array, int n_components) __attribute__((always_inline)) {
      constexpr int step = 64 / sizeof(*array);  // entries of a cache line
      for (int i = 0; i < n_components * lane_width; i += step)
        __builtin_prefetch(array + far * n_components * lane_width + i);
    };
    for (int line = 0; line < 4; ++line) __builtin_prefetch(w.nodes + 64 * far + 16 * line);
    fetch(w.mass, 1);
    fetch(w.volume, 1);
    fetch(w.pressure, 1);
    fetch(w.internal_energy, 1);
    fetch(w.viscous_energy, 1);
    fetch(w.deviator, 6);
    fetch(w.element_state, w.n_element_state);
    fetch(w.material_state, w.n_material_state);
    fetch(w.eos_state, w.n_eos_state);
    // Along the curve that elements stand on, the corner farthest from the origin is the newest one.
    const std::int64_t near = std::min(block + nodes_ahead, w.n_blocks - 1);
    for (int l = 0; l < lane_width; ++l) {
      const std::int64_t newest = 4 * static_cast<std::int64_t>(w.nodes[64 * near + 6 * lane_width + l]);
      __builtin_prefetch(w.position + newest);
      __builtin_prefetch(w.velocity + newest);
      __builtin_prefetch(w.force + newest, 1);
    }
  }

  [[gnu::always_inline]] void update_block(Work& w, int block, Totals& totals) const {
    Piece pieces[pieces_of<Real>];
    Rows rows;
    const auto piece = [&pieces](int lane) -> Piece& { return pieces[lane / lanes_of<Real>]; };
    each_piece<Real>([&](int lane) __attribute__((always_inline)) { deform(w, block, lane, piece(lane), rows); });
    update_material(w, block, rows);
    const bool uses_energy = w.eos->uses_energy();
    each_piece<Real>([&](int lane) __attribute__((always_inline)) {
      predict_energy(w, block, lane, uses_energy, piece(lane), rows);
    });
    evaluate_eos(w, block, rows);
    each_piece<Real>([&](int lane) __attribute__((always_inline)) {
      add_viscosity(w, block, lane, uses_energy, piece(lane), rows);
    });
    if (uses_energy) evaluate_eos(w, block, rows);
    each_piece<Real>([&](int lane) __attribute__((always_inline)) { finish_state(w, block, lane, piece(lane), rows); });
    const unsigned dead = w.judge ? judge_block(w, block, rows.step, pieces) : 0;
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
      double* stored = at(w.volume, 1, block, 0, l);
      old_volume[part] = load_lanes(stored);
      volume[part] = p.k.exact_volume[part] > 0.0 ? p.k.exact_volume[part] : old_volume[part];
      change[part] = volume[part] - old_volume[part];
      store_lanes(stored, volume[part]);
      per_volume[part] = 1.0 / volume[part];
      store_lanes(rows.exact_density + l, load_lanes(at(w.mass, 1, block, 0, l)) * per_volume[part]);
    }
    p.per_volume = joined(per_volume);
    p.volume = joined(volume);
    p.old_volume = joined(old_volume);
    p.volume_change = joined(change);
  }
  /// In the precision of the kernel.
  [[gnu::always_inline]] static V joined(const Lanes (&v)[n_wide<Real>]) {
    if constexpr (is_single)
      return narrowed(v);
    else
      return v[0];
  }

  /// From nodal motion to the strain of the step and the rotated deviator.
  [[gnu::always_inline]] static void deform(const Work& w, int block, int lane, Piece& p, Rows& rows) {
    gather(w.position, w.velocity, nodes_of(w, block, lane), p.k);
    measure(p.k);
    update_volume(w, block, lane, p, rows);
    for (int i = 0; i < 3; ++i)
      for (int j = 0; j < 3; ++j) p.k.velocity_gradient[i][j] = dot6(p.k.v[i], p.k.b[j]) * p.per_volume;
    strain_of_step<Real>(p.k.velocity_gradient, static_cast<Real>(w.dt), p.good, rows.step, lane);
    for (int i = 0; i < 6; ++i) p.s[i] = load_lanes(at(w.deviator, 6, block, i, lane));
    rotate_rows<Real>(rows.step.rotation, lane, p.s);
    for (int i = 0; i < 6; ++i) store_lanes(rows.deviator[i] + lane, p.s[i]);
    p.mass = load_lanes_as<Real>(at(w.mass, 1, block, 0, lane));
    p.per_mass = Real(1.0) / p.mass;
    p.density = p.mass * p.per_volume;
    p.old_energy = load_lanes_as<Real>(at(w.internal_energy, 1, block, 0, lane));
    store_lanes(rows.density + lane, p.density);
    store_lanes(rows.energy + lane, p.old_energy * p.per_mass);
  }

  static void update_material(Work& w, int block, Rows& rows) {
    MaterialRows<Real> m;
    m.dt = w.dt;
    m.reference_density = w.reference_density;
    m.strain_increment = rows.step.strain;
    m.density = rows.density;
    m.specific_energy = rows.energy;
    m.pressure = at(w.pressure, 1, block, 0, 0);
    m.deviator = rows.deviator;
    m.state = at(w.material_state, w.n_material_state, block, 0, 0);
    m.shear_modulus = rows.modulus;
    if constexpr (is_single)
      w.material->update_single(m);
    else
      w.material->update(m);
  }

  /// Change of the deviator over that of an elastic step, |s - R s R^T| / (2 G |dev strain|): one in elastic steps,
  /// little where the material flows.
  [[gnu::always_inline]] static V elastic_share(int lane, const Piece& p, const Rows& rows) {
    const auto& strain = rows.step.strain;
    const V mean =
        (load_lanes(strain[0] + lane) + load_lanes(strain[1] + lane) + load_lanes(strain[2] + lane)) * Real(1.0 / 3.0);
    V change2{}, strain2{};
    for (int i = 0; i < 6; ++i) {
      const V e = load_lanes(strain[i] + lane) - (i < 3 ? mean : V{});
      const V change = load_lanes(rows.deviator[i] + lane) - p.s[i];
      strain2 += Real(i < 3 ? 1.0 : 2.0) * e * e;
      change2 += Real(i < 3 ? 1.0 : 2.0) * change * change;
    }
    const V modulus = Real(2.0) * load_lanes(rows.modulus + lane);
    const V elastic2 = modulus * modulus * strain2;
    return change2 < elastic2 ? sqrt_of(change2 / (elastic2 + tiny<Real>)) : lanes(Real(1.0));
  }

  /// Work of the mean of the old and the new deviator; energy with the old pressure, for the EOS.
  [[gnu::always_inline]] void predict_energy(Work& w, int block, int lane, bool uses_energy, Piece& p,
                                             Rows& rows) const {
    if (stiffness_) {
      p.elastic_share = elastic_share(lane, p, rows);
      p.solid = load_lanes(rows.modulus + lane) > Real(0.0) ? lanes(Real(1.0)) : V{};
    }
    V work{};
    for (int i = 0; i < 6; ++i) {
      const V now = load_lanes(rows.deviator[i] + lane);
      work += Real(i < 3 ? 1.0 : 2.0) * (p.s[i] + now) * load_lanes(rows.step.strain[i] + lane);
      p.s[i] = now;
      store_lanes(at(w.deviator, 6, block, i, lane), now);
    }
    p.work = work * (Real(0.25) * (p.volume + p.old_volume));
    if (!uses_energy) return;
    const V old_pressure = load_lanes(at(w.pressure, 1, block, 0, lane));
    const V predicted = p.old_energy + p.work - old_pressure * p.volume_change;
    store_lanes(rows.energy + lane, predicted * p.per_mass);
  }

  /// Wave speed, bulk viscosity in compression only (von Neumann & Richtmyer 1950; Landshoff 1955), and the centred
  /// energy.
  [[gnu::always_inline]] void add_viscosity(const Work& w, int block, int lane, bool uses_energy, Piece& p,
                                            Rows& rows) const {
    const V wave = load_lanes_as<Real>(rows.bulk + lane) + Real(4.0 / 3.0) * load_lanes(rows.modulus + lane);
    p.wave = wave > Real(0.0) ? wave : V{};
    p.c = sqrt_of(p.wave / p.density) + tiny<Real>;
    const auto& strain = rows.step.strain;
    const Real per_dt = Real(1.0) / static_cast<Real>(w.dt);
    const V dilatation =
        (load_lanes(strain[0] + lane) + load_lanes(strain[1] + lane) + load_lanes(strain[2] + lane)) * per_dt;
    const V closing = dilatation < Real(0.0) ? -dilatation : V{};
    const V quadratic = quadratic_viscosity_ * p.k.length * closing;
    V linear = linear_viscosity_ * p.c;
    p.viscosity = linear + quadratic;
    if (limited_viscosity_) linear *= shock_share(w, block, lane, p, dilatation, per_dt);
    p.q = p.k.volume > Real(0.0) ? p.density * p.k.length * closing * (linear + quadratic) : V{};
    Real* stored = at(w.element_state, w.n_element_state, block, 0, lane);
    const V old_q = load_lanes(stored);
    store_lanes(stored, p.q);
    p.viscous_work = Real(-0.5) * (old_q + p.q) * p.volume_change;
    if (!uses_energy) return;
    const V old_pressure = load_lanes(at(w.pressure, 1, block, 0, lane));
    const V centred = p.old_energy + p.work + p.viscous_work -
                      Real(0.5) * (old_pressure + load_lanes_as<Real>(rows.pressure + lane)) * p.volume_change;
    store_lanes(rows.energy + lane, centred * p.per_mass);
  }

  /// The share of the linear viscosity that acts. Where a wave is smooth, the dilatation rate changes little while the
  /// wave crosses an element. In a shock that is captured over a few elements, and in the oscillations behind it, it
  /// changes by as much as it is. The sensor follows these changes at once and forgets them slowly. Fronts that have
  /// widened to many elements do not show in it; if they are strong, they do in the jump of velocity per element.
  [[gnu::always_inline]] static V shock_share(const Work& w, int block, int lane, const Piece& p, V rate, Real per_dt) {
    Real *last_rate = state_at(w, block, dilatation_rate, lane), *sensor = state_at(w, block, shock_sensor, lane);
    const V length2 = p.k.length * p.k.length, size = abs_of(rate) + Real(least_rate);
    const V inverse = Real(1.0) / (p.c * p.k.length * size);  // divisions are slow: one serves three quotients
    // Way of a wave in the step over the length of the element.
    const V crossed = static_cast<Real>(w.dt) * (p.c * p.c) * size * inverse;
    const V change = (rate - load_lanes(last_rate)) * (length2 * inverse) * per_dt;
    const V jump = Real(-jump_factor) * rate * length2 * (size * inverse);
    const V forgotten = load_lanes(sensor) - Real(sensor_loss) * crossed;
    const V sensed = min_of(max_of(forgotten, Real(sensor_factor) * change * change), lanes(Real(most_sensed)));
    store_lanes(last_rate, rate);
    store_lanes(sensor, sensed);
    return min_of(max_of(sensed, jump), lanes(Real(1.0)));
  }

  /// Energies and pressure at the end of the step, and the stable step with the viscosity's share.
  [[gnu::always_inline]] void finish_state(Work& w, int block, int lane, Piece& p, const Rows& rows) const {
    p.p = load_lanes_as<Real>(rows.pressure + lane);
    const V old_pressure = load_lanes(at(w.pressure, 1, block, 0, lane));
    double *internal_energy = at(w.internal_energy, 1, block, 0, lane),
           *viscous_energy = at(w.viscous_energy, 1, block, 0, lane);
    const V pressure_work = Real(0.5) * (old_pressure + p.p) * p.volume_change;
    if constexpr (is_single) {
      add_lanes(internal_energy, p.work + p.viscous_work - pressure_work);
      add_lanes(viscous_energy, p.viscous_work);
    } else {
      store_lanes(internal_energy, p.old_energy + p.work + p.viscous_work - pressure_work);
      store_lanes(viscous_energy, load_lanes(viscous_energy) + p.viscous_work);
    }
    store_lanes(at(w.pressure, 1, block, 0, lane), p.p);
    p.stable = stable_step(w, block, lane, p.k, p.per_volume, p.viscosity, p.c * p.c,
                           load_lanes_as<Real>(rows.bulk + lane), load_lanes(rows.modulus + lane), p.density);
  }

  /// The stress that an element dies with never acts on its nodes: of the work of the step only the share of the old
  /// stress was given by them, and the share of the new one is taken back.
  static void take_back_work(Work& w, int block, int lane, V alive, const Piece& p, const Rows& rows) {
    V work{};
    for (int i = 0; i < 6; ++i) work += Real(i < 3 ? 1.0 : 2.0) * p.s[i] * load_lanes(rows.step.strain[i] + lane);
    const V dead = Real(1.0) - alive, viscous = Real(-0.5) * p.q * p.volume_change * dead;
    const V given = work * (Real(0.25) * (p.volume + p.old_volume)) * dead - Real(0.5) * p.p * p.volume_change * dead;
    add(at(w.internal_energy, 1, block, 0, lane), -(given + viscous));
    add(at(w.viscous_energy, 1, block, 0, lane), -viscous);
  }
  static void add(double* sum, V term) {
    if constexpr (is_single)
      add_lanes(sum, term);
    else
      store_lanes(sum, load_lanes(sum) + term);
  }

  unsigned judge_block(Work& w, int block, const Strain& step, const Piece (&pieces)[pieces_of<Real>]) const {
    alignas(64) double stress[6][lane_width], pressure[lane_width], density[lane_width], volume[lane_width],
        time_step[lane_width];
    StepStrain<double> in_doubles;
    const StepStrain<double>& wide = widen(step, in_doubles);
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

  /// f_I = -(sigma - hourglass correction) B_I - hourglass, in quanta; the last node takes minus the others'
  /// sum, so that an element's forces add up to nothing exactly.
  [[gnu::always_inline]] void add_forces(Work& w, int block, int lane, const Piece& p, const Strain& step, V alive,
                                         Totals& totals) const {
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

    const V scale = alive * static_cast<Real>(w.scale.per_quantum), total = p.p + p.q;
    const V(&s)[6] = p.s;
    V sigma[3][3] = {{s[0] - total, s[3], s[5]}, {s[3], s[1] - total, s[4]}, {s[5], s[4], s[2] - total}};
    V force[3][8], size{};
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
      for (int n = 0; n < 7; ++n) size += abs_of(force[i][n]);
    }
    const std::int32_t* nodes = nodes_of(w, block, lane);
    if (mask_of(size < static_cast<Real>(small_limit)) == all_lanes_of<Real>) [[likely]]
      scatter_forces<true>(w, nodes, force);
    else if (!scatter_forces<false>(w, nodes, force) && w.bad_block < 0)
      w.bad_block = block;
  }

  /// False where a force is not finite or too large.
  template <bool small>
  [[gnu::always_inline]] static bool scatter_forces(Work& w, const std::int32_t* nodes, const V (&force)[3][8]) {
    bool sound = scatter_part<small, 0>(w, nodes, force);
    if constexpr (n_wide<Real> == 2) sound &= scatter_part<small, 1>(w, nodes, force);
    return sound;
  }
  template <bool small, int part>
  [[gnu::always_inline]] static bool scatter_part(Work& w, const std::int32_t* first, const V (&force)[3][8]) {
    const std::int32_t* nodes = first + part * register_lanes;
    LanesInt last[3] = {}, sound = ~LanesInt{};
    for (int n = 0; n < 7; ++n) {
      LanesInt quanta[3];
      for (int i = 0; i < 3; ++i) {
        const Lanes f = widened<part>(force[i][n]);
        if constexpr (!small) sound &= abs_of(f) < ForceScale::limit;
        quanta[i] = small ? round_small_to_int(f) : round_to_int(f);
        last[i] -= quanta[i];
      }
      scatter_add(w.force, nodes + lane_width * n, quanta[0], quanta[1], quanta[2]);
    }
    scatter_add(w.force, nodes + lane_width * 7, last[0], last[1], last[2]);
    return mask_of(sound) == all_lanes;
  }

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
        Real* stored = at(w.element_state, w.n_element_state, block, 1 + 3 * a + i, lane);
        work += (load_lanes(stored) + alive * resist[i][a]) * rate[i][a];
        store_lanes(stored, resist[i][a]);
      }
    book_hourglass(w, lane, work, p.good, totals);
  }

  static void book_hourglass(const Work& w, int lane, V work, V good, Totals& totals) {
    book_part<0>(w, lane, work, good, totals);
    if constexpr (n_wide<Real> == 2) book_part<1>(w, lane, work, good, totals);
  }
  template <int part>
  [[gnu::always_inline]] static void book_part(const Work& w, int lane, V work, V good, Totals& totals) {
    const Lanes energy = 0.5 * widened<part>(work) * w.dt * widened<part>(good) * w.energy_per_quantum;
    const bool small = mask_of(abs_of(energy) < small_limit) == all_lanes;
    const LanesInt quanta =
        small ? round_small_to_int(energy) : round_to_int(max_of(min_of(energy, lanes(1e18)), lanes(-1e18)));
    std::int64_t* total = totals.hourglass_energy + lane + part * register_lanes;
    store_lanes(total, load_lanes(total) + quanta);
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
        const V old = load_lanes(at(w.element_state, w.n_element_state, block, 1 + 3 * a + i, lane));
        // What falls does so with the full stiffness, down to nothing: it must not give back more than it has taken.
        const V full = abs_of(elastic * rate[i][a]), zero{};
        const V falling = old * rate[i][a] < zero ? min_of(abs_of(old) / (full + tiny<Real>), lanes(Real(1.0))) : zero;
        const V growth = flowing + (elastic - flowing) * falling;
        grown[i] = p.solid * old + growth * rate[i][a];
        work += (old + alive * grown[i]) * rate[i][a];
      }
      for (int i = 0; i < 3; ++i) {
        resist[i][a] = r[3 * i] * grown[0] + r[3 * i + 1] * grown[1] + r[3 * i + 2] * grown[2];
        if constexpr (is_single) resist[i][a] += grown[i];
        store_lanes(at(w.element_state, w.n_element_state, block, 1 + 3 * a + i, lane), resist[i][a]);
      }
    }
    book_hourglass(w, lane, work, p.good, totals);
  }

  bool free_element_, stiffness_, limited_viscosity_;
  Real hourglass_coefficient_, linear_viscosity_, quadratic_viscosity_;
};

}  // namespace kerf::hex8
