// Eight-node hexahedron with one integration point: mean-gradient strain, Jaumann rate through the
// Hughes-Winget rotation, viscous or stiffness hourglass control, bulk viscosity.
//
// Sources: D.P. Flanagan & T. Belytschko, "A uniform strain hexahedron and quadrilateral with orthogonal
// hourglass control", IJNME 17 (1981) 679-706; T.J.R. Hughes & J. Winget, "Finite rotation effects in
// numerical integration of rate constitutive equations", IJNME 15 (1980) 1862-1867; J. von Neumann &
// R.D. Richtmyer, J. Appl. Phys. 21 (1950) 232 and R. Landshoff, LA-1930 (1955) for the bulk viscosity;
// D.P. Flanagan & T. Belytschko, J. Appl. Mech. 51 (1984) 35-40 for the eigenvalue bound of the time step.
#include "hex8_kinematics.hpp"

#include <limits>

namespace {

using namespace kerf;
using namespace kerf::hex8;

struct Hex8 final : Element {
  std::string hourglass, stable_step;
  double hourglass_coefficient = 0.0, linear_viscosity = 0.0, quadratic_viscosity = 0.0;

  struct State {
    double bulk_viscosity_pressure, resistance[12];
  };

  static void describe(Schema<Hex8>& s) {
    s.choice(&Hex8::hourglass, "hourglass", {"viscous", "stiffness"},
             "resistance to hourglass modes: proportional to their velocity, or to their displacement")
        .by_default("viscous");
    s.real(&Hex8::hourglass_coefficient, "hourglass_coefficient", "-", between(0.0, 0.15),
           "strength of the hourglass control; stable up to about 0.12 (viscous)")
        .by_default("0.05");
    s.real(&Hex8::linear_viscosity, "linear_viscosity", "-", between(0.0, 2.0), "linear bulk viscosity coefficient")
        .by_default("0.06");
    s.real(&Hex8::quadratic_viscosity, "quadratic_viscosity", "-", between(0.0, 10.0),
           "quadratic bulk viscosity coefficient")
        .by_default("1.5");
    s.choice(&Hex8::stable_step, "stable_step", {"plane_wave", "free_element"},
             "bound of the time step: for bodies of two or more cells in every direction, or for any body, bars and "
             "sheets of one cell included")
        .by_default("plane_wave");
    s.state(&State::bulk_viscosity_pressure, "bulk_viscosity_pressure", "Pa", 0.0, "bulk viscosity pressure");
  }

  std::vector<StateVariable> state_variables() const override {
    std::vector<StateVariable> all = description->state;
    for (int i = 0; i < 12; ++i)
      all.push_back({"hourglass_resistance_" + std::to_string(i + 1), "N", "generalised hourglass force", 0.0, 1 + i});
    return all;
  }

  void add_internal_forces(ElementWork& work) const override {
    if (hourglass == "stiffness")
      run<true>(work);
    else
      run<false>(work);
  }

  void initialise(ElementWork& w) const override {
    for (int block = 0; block < w.n_blocks; ++block) {
      Kinematics k[n_pieces];
      alignas(64) double strain[6][lane_width] = {}, modulus[lane_width], bulk[lane_width], energy[lane_width] = {};
      alignas(64) double density[lane_width];
      each_piece([&](int lane) {
        Kinematics& piece = k[lane / register_lanes];
        gather(w, nodes_of(w, block, lane), piece);
        measure(piece);
        store_lanes(at(w.volume, 1, block, 0, lane), piece.volume);
        if (mask_of(~(piece.volume > 0.0)) != 0 && w.inverted_block < 0) w.inverted_block = block;
        store_lanes(density + lane, load_lanes(at(w.mass, 1, block, 0, lane)) / piece.volume);
      });
      MaterialBatch m;
      m.reference_density = w.reference_density;
      m.strain_increment = strain;
      m.density = density;
      m.specific_energy = energy;
      m.pressure = at(w.pressure, 1, block, 0, 0);
      m.deviator = reinterpret_cast<double(*)[lane_width]>(at(w.deviator, 6, block, 0, 0));
      m.state = at(w.material_state, w.n_material_state, block, 0, 0);
      m.shear_modulus = modulus;
      w.material->update(m);
      evaluate_eos(w, block, density, energy, at(w.pressure, 1, block, 0, 0), bulk);
      each_piece([&](int lane) {
        const Kinematics& piece = k[lane / register_lanes];
        const Lanes rho = load_lanes(density + lane), shear = load_lanes(modulus + lane), K = load_lanes(bulk + lane);
        const Lanes c2 = (K + (4.0 / 3.0) * shear) / rho, viscosity = linear_viscosity * sqrt_of(c2);
        const Lanes fastest2 = c2 + breathing(piece, K, shear, rho);
        note_step(w, block, lane, piece.length / (viscosity + sqrt_of(viscosity * viscosity + fastest2)));
        add_initial_forces(w, block, lane, piece);
      });
    }
  }

 private:
  /// What a piece of a block carries from one phase of the update to the next.
  struct Piece {
    Kinematics k;
    Lanes s[6];  // deviator: rotated to the end of the step, later updated [Pa]
    Lanes good;  // 1 where the volume is positive, otherwise 0
    Lanes volume, old_volume, per_volume;  // the first one positive
    Lanes mass, per_mass, density, old_energy, work;  // the latter of the deviator in this step [J]
    Lanes wave, c;  // rho c^2 [Pa], c [m/s]
    Lanes viscosity, q, viscous_work, p;  // linear and quadratic [m/s]; bulk viscosity pressure [Pa]; [J]; [Pa]
    Lanes stable;  // step [s]
  };
  /// Rows of a block, for laws and judges.
  struct Rows {
    StepStrain step;
    alignas(64) double deviator[6][lane_width], density[lane_width], energy[lane_width], modulus[lane_width];
    alignas(64) double pressure[lane_width], bulk[lane_width];
  };
  /// Sums over blocks.
  struct Totals {
    alignas(64) std::int64_t hourglass_energy[lane_width] = {};  // in quanta
  };

  /// Entry of a blocked array: [block][n_components][lane].
  template <class Number>
  [[gnu::always_inline]] static Number* at(Number* array, int n_components, int block, int component, int lane) {
    return array + (static_cast<std::int64_t>(block) * n_components + component) * lane_width + lane;
  }
  [[gnu::always_inline]] static const std::int32_t* nodes_of(const ElementWork& w, int block, int lane) {
    return at(w.nodes, 8, block, 0, lane);
  }

  /// An initial pressure pushes from the first kick on.
  static void add_initial_forces(ElementWork& w, int block, int lane, const Kinematics& k) {
    const Lanes pressure = load_lanes(at(w.pressure, 1, block, 0, lane));
    LanesInt last[3] = {};
    for (int n = 0; n < 8; ++n) {
      LanesInt quanta[3];
      for (int i = 0; i < 3; ++i) {
        quanta[i] = n < 7 ? round_to_int(pressure * k.b[i][n] * w.scale.per_quantum) : last[i];
        last[i] -= quanta[i];
      }
      scatter_add(w.force, nodes_of(w, block, lane) + lane_width * n, quanta[0], quanta[1], quanta[2]);
    }
  }

  /// What a free element adds to the square of the plane wave's speed, for the time step. With P_i the eigenvalues of
  /// B B^T, deformation along its axes has the stiffness 2 G P_i delta_ij + lambda sqrt(P_i P_j), whose largest
  /// eigenvalue is at most 2 G P_max + lambda tr P; the plane wave's is (2 G + lambda) P_max. Neighbours keep each
  /// other from breathing in all directions at once, so bodies of several cells do not need it.
  [[gnu::always_inline]] Lanes breathing(const Kinematics& k, Lanes bulk, Lanes shear, Lanes rho) const {
    if (stable_step != "free_element") return Lanes{};
    const Lanes lambda = max_of(bulk - (2.0 / 3.0) * shear, lanes(0.0));
    const Lanes per_area = k.length / k.volume;  // 1 / sqrt(2 P_max)
    return lambda * max_of(2.0 * k.gradient_norm * per_area * per_area - 1.0, lanes(0.0)) / rho;
  }

  [[gnu::always_inline]] static void note_step(ElementWork& w, int block, int lane, Lanes step) {
    const Lanes least = load_lanes(w.least_step + lane);
    const LanesInt less = step < least;
    store_lanes(w.least_step + lane, less ? step : least);
    const LanesInt where = load_lanes(w.least_block + lane);
    store_lanes(w.least_block + lane, less ? (LanesInt{} + static_cast<std::int64_t>(block)) : where);
  }

  static void evaluate_eos(ElementWork& w, int block, const double* density, const double* energy, double* pressure,
                           double* bulk) {
    EosBatch e;
    e.reference_density = w.reference_density;
    e.density = density;
    e.specific_energy = energy;
    e.state = at(w.eos_state, w.n_eos_state, block, 0, 0);
    e.pressure = pressure;
    e.bulk_modulus = bulk;
    w.eos->evaluate(e);
  }

  template <bool stiffness>
  void run(ElementWork& w) const {
    Totals totals;
    for (int block = 0; block < w.n_blocks; ++block) {
      fetch_ahead(w, block);
      update_block<stiffness>(w, block, totals);
    }
    for (int l = 0; l < lane_width; ++l) w.hourglass_energy += totals.hourglass_energy[l];
  }

  /// Asks for what the next blocks will read: a part has more arrays than the hardware can foresee, and nodes are
  /// known by their numbers alone. Worth half of the speed of large models.
  [[gnu::always_inline]] static void fetch_ahead(const ElementWork& w, int block) {
    constexpr int fields_ahead = 3, nodes_ahead = 2;  // blocks; 2 to 8 and 1 to 4 are much the same
    const std::int64_t far = std::min(block + fields_ahead, w.n_blocks - 1);
    const auto fetch = [far](const double* array, int n_components) {
      for (int c = 0; c < n_components; ++c) __builtin_prefetch(array + (far * n_components + c) * lane_width);
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

  template <bool stiffness>
  [[gnu::always_inline]] void update_block(ElementWork& w, int block, Totals& totals) const {
    Piece pieces[n_pieces];
    Rows rows;
    const auto piece = [&pieces](int lane) -> Piece& { return pieces[lane / register_lanes]; };
    each_piece([&](int lane) { deform(w, block, lane, piece(lane), rows); });
    update_material(w, block, rows);
    const bool uses_energy = w.eos->uses_energy();
    each_piece([&](int lane) { predict_energy(w, block, lane, uses_energy, piece(lane), rows); });
    evaluate_eos(w, block, rows.density, rows.energy, rows.pressure, rows.bulk);
    each_piece([&](int lane) { add_viscosity(w, block, lane, uses_energy, piece(lane), rows); });
    if (uses_energy) evaluate_eos(w, block, rows.density, rows.energy, rows.pressure, rows.bulk);
    each_piece([&](int lane) { finish_state(w, block, lane, piece(lane), rows); });
    const unsigned dead = w.judge ? judge_block(w, block, rows.step, pieces) : 0;
    alignas(64) double alive[lane_width];
    for (int l = 0; l < lane_width; ++l) alive[l] = (dead >> l & 1u) != 0 ? 0.0 : 1.0;
    each_piece([&](int lane) {
      const Piece& p = piece(lane);
      const unsigned inverted = mask_of(~(p.k.volume > 0.0)) & ~(dead >> lane);
      if (inverted != 0 && w.inverted_block < 0) w.inverted_block = block;
      const Lanes live = load_lanes(alive + lane) * p.good;
      note_step(w, block, lane, live > 0.0 ? p.stable : lanes(std::numeric_limits<double>::max()));
      add_forces<stiffness>(w, block, lane, p, rows.step, live, totals);
    });
  }

  /// From nodal motion to the strain of the step and the rotated deviator.
  [[gnu::always_inline]] static void deform(const ElementWork& w, int block, int lane, Piece& p, Rows& rows) {
    gather(w, nodes_of(w, block, lane), p.k);
    measure(p.k);
    // An element without volume keeps its state; it is eroded below, or stops the run.
    p.old_volume = load_lanes(at(w.volume, 1, block, 0, lane));
    const LanesInt upright = p.k.volume > 0.0;
    p.good = upright ? lanes(1.0) : lanes(0.0);
    p.volume = upright ? p.k.volume : p.old_volume;
    p.per_volume = 1.0 / p.volume;
    for (int i = 0; i < 3; ++i)
      for (int j = 0; j < 3; ++j) p.k.velocity_gradient[i][j] = dot8(p.k.v[i], p.k.b[j]) * p.per_volume;
    strain_of_step(p.k.velocity_gradient, w.dt, p.good, rows.step, lane);
    for (int i = 0; i < 6; ++i) p.s[i] = load_lanes(at(w.deviator, 6, block, i, lane));
    rotate_rows(rows.step.rotation, lane, p.s);
    for (int i = 0; i < 6; ++i) store_lanes(rows.deviator[i] + lane, p.s[i]);
    p.mass = load_lanes(at(w.mass, 1, block, 0, lane));
    p.per_mass = 1.0 / p.mass;
    p.density = p.mass * p.per_volume;
    p.old_energy = load_lanes(at(w.internal_energy, 1, block, 0, lane));
    store_lanes(rows.density + lane, p.density);
    store_lanes(rows.energy + lane, p.old_energy * p.per_mass);
  }

  static void update_material(ElementWork& w, int block, Rows& rows) {
    MaterialBatch m;
    m.dt = w.dt;
    m.reference_density = w.reference_density;
    m.strain_increment = rows.step.strain;
    m.density = rows.density;
    m.specific_energy = rows.energy;
    m.pressure = at(w.pressure, 1, block, 0, 0);
    m.deviator = rows.deviator;
    m.state = at(w.material_state, w.n_material_state, block, 0, 0);
    m.shear_modulus = rows.modulus;
    w.material->update(m);
  }

  /// Work of the mean of the old and the new deviator; energy with the old pressure, for the EOS.
  [[gnu::always_inline]] static void predict_energy(ElementWork& w, int block, int lane, bool uses_energy, Piece& p,
                                                    Rows& rows) {
    Lanes work{};
    for (int i = 0; i < 6; ++i) {
      const Lanes now = load_lanes(rows.deviator[i] + lane);
      work += (i < 3 ? 1.0 : 2.0) * (p.s[i] + now) * load_lanes(rows.step.strain[i] + lane);
      p.s[i] = now;
      store_lanes(at(w.deviator, 6, block, i, lane), now);
    }
    p.work = work * (0.25 * (p.volume + p.old_volume));
    if (!uses_energy) return;
    const Lanes old_pressure = load_lanes(at(w.pressure, 1, block, 0, lane));
    const Lanes predicted = p.old_energy + p.work - old_pressure * (p.volume - p.old_volume);
    store_lanes(rows.energy + lane, predicted * p.per_mass);
  }

  /// Wave speed, bulk viscosity in compression only (von Neumann & Richtmyer 1950; Landshoff 1955), and the centred
  /// energy.
  [[gnu::always_inline]] void add_viscosity(const ElementWork& w, int block, int lane, bool uses_energy, Piece& p,
                                            Rows& rows) const {
    const Lanes wave = load_lanes(rows.bulk + lane) + (4.0 / 3.0) * load_lanes(rows.modulus + lane);
    p.wave = wave > 0.0 ? wave : lanes(0.0);
    p.c = sqrt_of(p.wave / p.density) + 1e-300;
    const auto& strain = rows.step.strain;
    const Lanes dilatation =
        (load_lanes(strain[0] + lane) + load_lanes(strain[1] + lane) + load_lanes(strain[2] + lane)) / w.dt;
    const Lanes closing = dilatation < 0.0 ? -dilatation : lanes(0.0);
    p.viscosity = linear_viscosity * p.c + quadratic_viscosity * p.k.length * closing;
    p.q = p.k.volume > 0.0 ? p.density * p.k.length * closing * p.viscosity : lanes(0.0);
    double* stored = at(w.element_state, w.n_element_state, block, 0, lane);
    const Lanes old_q = load_lanes(stored), volume_change = p.volume - p.old_volume;
    store_lanes(stored, p.q);
    p.viscous_work = -0.5 * (old_q + p.q) * volume_change;
    if (!uses_energy) return;
    const Lanes old_pressure = load_lanes(at(w.pressure, 1, block, 0, lane));
    const Lanes centred = p.old_energy + p.work + p.viscous_work -
                          0.5 * (old_pressure + load_lanes(rows.pressure + lane)) * volume_change;
    store_lanes(rows.energy + lane, centred * p.per_mass);
  }

  /// Energies, pressure and volume at the end of the step, and the stable step with the viscosity's share.
  [[gnu::always_inline]] void finish_state(ElementWork& w, int block, int lane, Piece& p, const Rows& rows) const {
    p.p = load_lanes(rows.pressure + lane);
    const Lanes old_pressure = load_lanes(at(w.pressure, 1, block, 0, lane));
    store_lanes(at(w.internal_energy, 1, block, 0, lane),
                p.old_energy + p.work + p.viscous_work - 0.5 * (old_pressure + p.p) * (p.volume - p.old_volume));
    double* viscous_energy = at(w.viscous_energy, 1, block, 0, lane);
    store_lanes(viscous_energy, load_lanes(viscous_energy) + p.viscous_work);
    store_lanes(at(w.pressure, 1, block, 0, lane), p.p);
    store_lanes(at(w.volume, 1, block, 0, lane), p.volume);
    const Lanes fastest2 =
        p.c * p.c + breathing(p.k, load_lanes(rows.bulk + lane), load_lanes(rows.modulus + lane), p.density);
    p.stable = p.k.length / (p.viscosity + sqrt_of(p.viscosity * p.viscosity + fastest2));
  }

  unsigned judge_block(ElementWork& w, int block, const StepStrain& step, const Piece (&pieces)[n_pieces]) const {
    alignas(64) double stress[6][lane_width], pressure[lane_width], density[lane_width], volume[lane_width],
        time_step[lane_width];
    each_piece([&](int lane) {
      const Piece& p = pieces[lane / register_lanes];
      for (int i = 0; i < 6; ++i) store_lanes(stress[i] + lane, i < 3 ? p.s[i] - p.p : p.s[i]);
      store_lanes(pressure + lane, p.p);
      store_lanes(density + lane, p.density / w.reference_density);
      store_lanes(volume + lane, p.k.volume * w.reference_density / p.mass);
      store_lanes(time_step + lane, p.stable);
    });
    ErosionBatch rows;
    rows.stress = stress;
    rows.strain_increment = step.strain;
    rows.rotation = step.rotation;
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
  template <bool stiffness>
  [[gnu::always_inline]] void add_forces(ElementWork& w, int block, int lane, const Piece& p, const StepStrain& step,
                                         Lanes alive, Totals& totals) const {
    const Kinematics& k = p.k;
    Lanes shape[3][4], rate[3][4];
    for (int d = 0; d < 3; ++d) {
      project_hourglass(k.x[d], shape[d]);
      project_hourglass(k.v[d], rate[d]);
    }
    for (int i = 0; i < 3; ++i)
      for (int a = 0; a < 4; ++a)
        for (int j = 0; j < 3; ++j) rate[i][a] -= k.velocity_gradient[i][j] * shape[j][a];

    Lanes resist[3][4];
    if constexpr (stiffness)
      resist_displacement(w, block, lane, p, step, rate, alive, resist, totals);
    else
      resist_velocity(w, block, lane, p, rate, alive, resist, totals);

    const Lanes scale = alive * w.scale.per_quantum, total = p.p + p.q;
    const Lanes(&s)[6] = p.s;
    Lanes sigma[3][3] = {{s[0] - total, s[3], s[5]}, {s[3], s[1] - total, s[4]}, {s[5], s[4], s[2] - total}};
    Lanes force[3][8], size{};
    for (int i = 0; i < 3; ++i) {
      for (int j = 0; j < 3; ++j) {
        Lanes correction{};
        for (int a = 0; a < 4; ++a) correction += resist[i][a] * shape[j][a];
        sigma[i][j] = (sigma[i][j] - correction * p.per_volume) * scale;
      }
      Lanes g[4];
      for (int a = 0; a < 4; ++a) g[a] = resist[i][a] * scale;
      spread_hourglass(g, force[i]);
      for (int n = 0; n < 7; ++n) {
        force[i][n] = -(force[i][n] + sigma[i][0] * k.b[0][n] + sigma[i][1] * k.b[1][n] + sigma[i][2] * k.b[2][n]);
        size += abs_of(force[i][n]);
      }
    }
    const std::int32_t* nodes = nodes_of(w, block, lane);
    if (mask_of(size < small_limit) == all_lanes) [[likely]]
      scatter_forces<true>(w, nodes, force);
    else if (!scatter_forces<false>(w, nodes, force) && w.bad_block < 0)
      w.bad_block = block;
  }

  /// False where a force is not finite or too large.
  template <bool small>
  [[gnu::always_inline]] static bool scatter_forces(ElementWork& w, const std::int32_t* nodes,
                                                    const Lanes (&force)[3][8]) {
    LanesInt last[3] = {}, sound = ~LanesInt{};
    for (int n = 0; n < 7; ++n) {
      LanesInt quanta[3];
      for (int i = 0; i < 3; ++i) {
        if constexpr (!small) sound &= abs_of(force[i][n]) < ForceScale::limit;
        quanta[i] = small ? round_small_to_int(force[i][n]) : round_to_int(force[i][n]);
        last[i] -= quanta[i];
      }
      scatter_add(w.force, nodes + lane_width * n, quanta[0], quanta[1], quanta[2]);
    }
    scatter_add(w.force, nodes + lane_width * 7, last[0], last[1], last[2]);
    return mask_of(sound) == all_lanes;
  }

  /// Viscous control: resistance = Q/4 rho c A g (Hallquist 1998, eq. 3.21, with A = sqrt(2/3 B:B), which is the
  /// face area of a cube). A force acts on the mean of the velocities before and after it, so half of its work is
  /// booked now and half in the next step, which knows the velocity after it.
  [[gnu::always_inline]] void resist_velocity(const ElementWork& w, int block, int lane, const Piece& p,
                                              const Lanes (&rate)[3][4], Lanes alive, Lanes (&resist)[3][4],
                                              Totals& totals) const {
    const Lanes area = sqrt_of(p.k.gradient_norm * (2.0 / 3.0));
    const Lanes coefficient = (0.25 * hourglass_coefficient) * p.mass * p.per_volume * p.c * area;
    Lanes work{};
    for (int a = 0; a < 4; ++a)
      for (int i = 0; i < 3; ++i) {
        resist[i][a] = coefficient * rate[i][a];
        double* stored = at(w.element_state, w.n_element_state, block, 1 + 3 * a + i, lane);
        work += (load_lanes(stored) + resist[i][a]) * rate[i][a];
        store_lanes(stored, resist[i][a]);
      }
    book_hourglass(w, lane, work, alive, totals);
  }

  static void book_hourglass(const ElementWork& w, int lane, Lanes work, Lanes alive, Totals& totals) {
    const Lanes energy = 0.5 * work * w.dt * alive * w.energy_per_quantum;
    const LanesInt quanta = round_to_int(max_of(min_of(energy, lanes(1e18)), lanes(-1e18)));
    store_lanes(totals.hourglass_energy + lane, load_lanes(totals.hourglass_energy + lane) + quanta);
  }

  /// Stiffness control (Flanagan & Belytschko 1981, eqs. 63-67): resistance grows with k g dt and turns with the
  /// element; k = kappa/24 (K + 4G/3) B:B/V, so that kappa = 1 would give the hourglass modes of a cube the
  /// highest frequency of the element.
  [[gnu::always_inline]] void resist_displacement(const ElementWork& w, int block, int lane, const Piece& p,
                                                  const StepStrain& step, const Lanes (&rate)[3][4], Lanes alive,
                                                  Lanes (&resist)[3][4], Totals& totals) const {
    const Lanes growth = (hourglass_coefficient / 24.0) * p.wave * p.k.gradient_norm * p.per_volume * w.dt;
    Lanes work{};
    Lanes r[9];
    for (int i = 0; i < 9; ++i) r[i] = load_lanes(step.rotation[i] + lane);
    for (int a = 0; a < 4; ++a) {
      Lanes old[3];
      for (int i = 0; i < 3; ++i)
        old[i] = load_lanes(at(w.element_state, w.n_element_state, block, 1 + 3 * a + i, lane));
      for (int i = 0; i < 3; ++i) {
        const Lanes turned = r[3 * i] * old[0] + r[3 * i + 1] * old[1] + r[3 * i + 2] * old[2];
        resist[i][a] = turned + growth * rate[i][a];
        work += (turned + resist[i][a]) * rate[i][a];
        store_lanes(at(w.element_state, w.n_element_state, block, 1 + 3 * a + i, lane), resist[i][a]);
      }
    }
    book_hourglass(w, lane, work, alive, totals);
  }
};

}  // namespace

KERF_ELEMENT(Hex8, "hex8", "eight-node hexahedron, one integration point, hourglass control, bulk viscosity")
