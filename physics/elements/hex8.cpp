// Eight-node hexahedron with one integration point: mean-gradient strain, Jaumann rate through the
// Hughes-Winget rotation, viscous or stiffness hourglass control, bulk viscosity.
//
// Sources: D.P. Flanagan & T. Belytschko, "A uniform strain hexahedron and quadrilateral with orthogonal
// hourglass control", IJNME 17 (1981) 679-706; T.J.R. Hughes & J. Winget, "Finite rotation effects in
// numerical integration of rate constitutive equations", IJNME 15 (1980) 1862-1867; J. von Neumann &
// R.D. Richtmyer, J. Appl. Phys. 21 (1950) 232 and R. Landshoff, LA-1930 (1955) for the bulk viscosity;
// D.P. Flanagan & T. Belytschko, J. Appl. Mech. 51 (1984) 35-40 for the eigenvalue bound of the time step.
#include <kerf/element.hpp>
#include <kerf/lanes.hpp>

#include <limits>

namespace {

using namespace kerf;

// Corner signs of the four hourglass base vectors (Flanagan & Belytschko 1981, eq. 25 and table 1).
constexpr int hourglass_base[4][8] = {{1, 1, -1, -1, -1, -1, 1, 1},
                                      {1, -1, -1, 1, -1, 1, 1, -1},
                                      {1, -1, 1, -1, 1, -1, 1, -1},
                                      {-1, 1, -1, 1, 1, -1, 1, -1}};

// Node renumberings under which the expression for the first node's gradient gives every other node's
// (Flanagan & Belytschko 1981, table 3).
constexpr int renumbered[8][8] = {{0, 1, 2, 3, 4, 5, 6, 7}, {1, 2, 3, 0, 5, 6, 7, 4}, {2, 3, 0, 1, 6, 7, 4, 5},
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

/// Projections of a nodal field on the four hourglass base vectors.
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

/// Geometry and kinematics of one block of elements at the end of a step.
struct Kinematics {
  Lanes x[3][8], v[3][8], b[3][8];
  Lanes volume, velocity_gradient[3][3];  // the latter with respect to the end of the step [1/s]
  Lanes gradient_norm;  // sum of all B squared [m4]
  Lanes length;  // V / sqrt(2 lambda_max(B B^T)): the length of the stable step [m]
};

[[gnu::always_inline]] inline void gather(const ElementWork& w, const std::int32_t* nodes, Kinematics& k) {
#pragma GCC unroll 8
  for (int i = 0; i < 8; ++i) {
    gather_vector(w.position, nodes + 8 * i, k.x[0][i], k.x[1][i], k.x[2][i]);
    gather_vector(w.velocity, nodes + 8 * i, k.v[0][i], k.v[1][i], k.v[2][i]);
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

/// Strain increment and rotation of the step, both zero/unity to round-off under rigid motion: the gradient
/// with respect to the end of the step, G, is carried to the mid-step configuration, G (I - G/2)^-1, and its
/// skew part W turned into the rotation (I - W/2)^-1 (I + W/2) (Hughes & Winget 1980, eqs. 28 and 36).
struct StepStrain {
  alignas(64) double strain[6][lane_width];
  alignas(64) double rotation[9][lane_width];
};

[[gnu::always_inline]] inline void strain_of_step(const Lanes (&l)[3][3], double dt, Lanes good, StepStrain& out) {
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
  store_lanes(out.strain[0], h[0][0]);
  store_lanes(out.strain[1], h[1][1]);
  store_lanes(out.strain[2], h[2][2]);
  store_lanes(out.strain[3], 0.5 * (h[0][1] + h[1][0]));
  store_lanes(out.strain[4], 0.5 * (h[1][2] + h[2][1]));
  store_lanes(out.strain[5], 0.5 * (h[2][0] + h[0][2]));
  // With w the half axial vector of W: R = I + 2/(1 + w.w) (w x + w x w x)
  const Lanes wx = 0.25 * (h[2][1] - h[1][2]), wy = 0.25 * (h[0][2] - h[2][0]), wz = 0.25 * (h[1][0] - h[0][1]);
  const Lanes f = 2.0 / (1.0 + wx * wx + wy * wy + wz * wz);
  store_lanes(out.rotation[0], 1.0 - f * (wy * wy + wz * wz));
  store_lanes(out.rotation[1], f * (wx * wy - wz));
  store_lanes(out.rotation[2], f * (wx * wz + wy));
  store_lanes(out.rotation[3], f * (wx * wy + wz));
  store_lanes(out.rotation[4], 1.0 - f * (wx * wx + wz * wz));
  store_lanes(out.rotation[5], f * (wy * wz - wx));
  store_lanes(out.rotation[6], f * (wx * wz - wy));
  store_lanes(out.rotation[7], f * (wy * wz + wx));
  store_lanes(out.rotation[8], 1.0 - f * (wx * wx + wy * wy));
}

[[gnu::always_inline]] inline void rotate_rows(const double (&r)[9][lane_width], Lanes (&s)[6]) {
  Lanes q[9];
  for (int i = 0; i < 9; ++i) q[i] = load_lanes(r[i]);
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
      Kinematics k;
      gather(w, w.nodes + 64 * block, k);
      measure(k);
      store_lanes(w.volume + 8 * block, k.volume);
      if (mask_of(~(k.volume > 0.0)) != 0 && w.inverted_block < 0) w.inverted_block = block;
      alignas(64) double strain[6][lane_width] = {}, modulus[lane_width], bulk[lane_width], energy[lane_width] = {};
      alignas(64) double density[lane_width];
      store_lanes(density, load_lanes(w.mass + 8 * block) / k.volume);
      double* state = w.material_state + static_cast<std::int64_t>(w.n_material_state) * 8 * block;
      MaterialBatch m;
      m.reference_density = w.reference_density;
      m.strain_increment = strain;
      m.density = density;
      m.specific_energy = energy;
      m.pressure = w.pressure + 8 * block;
      m.deviator = reinterpret_cast<double(*)[lane_width]>(w.deviator + 48 * block);
      m.state = state;
      m.shear_modulus = modulus;
      w.material->update(m);
      evaluate_eos(w, block, density, energy, w.pressure + 8 * block, bulk);
      const Lanes rho = load_lanes(density), shear = load_lanes(modulus);
      const Lanes c2 = (load_lanes(bulk) + (4.0 / 3.0) * shear) / rho, viscosity = linear_viscosity * sqrt_of(c2);
      const Lanes fastest2 = c2 + breathing(k, load_lanes(bulk), shear, rho);
      note_step(w, block, k.length / (viscosity + sqrt_of(viscosity * viscosity + fastest2)));
      add_initial_forces(w, block, k, load_lanes(w.pressure + 8 * block));
    }
  }

 private:
  /// An initial pressure pushes from the first kick on.
  static void add_initial_forces(ElementWork& w, int block, const Kinematics& k, Lanes pressure) {
    LanesInt last[3] = {};
    for (int n = 0; n < 8; ++n) {
      LanesInt quanta[3];
      for (int i = 0; i < 3; ++i) {
        quanta[i] = n < 7 ? round_to_int(pressure * k.b[i][n] * w.scale.per_quantum) : last[i];
        last[i] -= quanta[i];
      }
      scatter_add(w.force, w.nodes + 64 * static_cast<std::int64_t>(block) + 8 * n, quanta[0], quanta[1], quanta[2]);
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

  static void note_step(ElementWork& w, int block, Lanes step) {
    const Lanes least = load_lanes(w.least_step);
    const LanesInt less = step < least;
    store_lanes(w.least_step, less ? step : least);
    LanesInt where;
    std::memcpy(&where, w.least_block, sizeof where);
    where = less ? (LanesInt{} + static_cast<std::int64_t>(block)) : where;
    std::memcpy(w.least_block, &where, sizeof where);
  }

  static void evaluate_eos(ElementWork& w, int block, const double* density, const double* energy, double* pressure,
                           double* bulk) {
    EosBatch e;
    e.reference_density = w.reference_density;
    e.density = density;
    e.specific_energy = energy;
    e.state = w.eos_state + static_cast<std::int64_t>(w.n_eos_state) * 8 * block;
    e.pressure = pressure;
    e.bulk_modulus = bulk;
    w.eos->evaluate(e);
  }

  template <bool stiffness>
  void run(ElementWork& w) const {
    Lanes largest_force{};
    LanesInt hourglass_energy{};
    for (int block = 0; block < w.n_blocks; ++block) {
      fetch_ahead(w, block);
      const Lanes before = largest_force;
      update_block<stiffness>(w, block, largest_force, hourglass_energy);
      if (mask_of(~(largest_force < ForceScale::limit)) != 0) {
        if (w.bad_block < 0) w.bad_block = block;
        largest_force = before;
      }
    }
    for (int l = 0; l < lane_width; ++l) w.hourglass_energy += hourglass_energy[l];
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
  [[gnu::always_inline]] void update_block(ElementWork& w, int block, Lanes& largest_force,
                                           LanesInt& hourglass_energy) const {
    const std::int32_t* nodes = w.nodes + 64 * static_cast<std::int64_t>(block);
    const std::int64_t row = 8 * static_cast<std::int64_t>(block);
    Kinematics k;
    gather(w, nodes, k);
    measure(k);

    // An element without volume keeps its state; it is eroded below, or stops the run.
    const Lanes old_volume = load_lanes(w.volume + row);
    const LanesInt upright = k.volume > 0.0;
    const Lanes good = upright ? lanes(1.0) : lanes(0.0);
    const Lanes volume = upright ? k.volume : old_volume;
    const Lanes per_volume = 1.0 / volume;
    for (int i = 0; i < 3; ++i)
      for (int j = 0; j < 3; ++j) k.velocity_gradient[i][j] = dot8(k.v[i], k.b[j]) * per_volume;
    StepStrain step;
    strain_of_step(k.velocity_gradient, w.dt, good, step);

    // Deviator: rotate, update, and the work of the mean of old and new
    double* stored = w.deviator + 6 * row;
    Lanes s[6];
    for (int i = 0; i < 6; ++i) s[i] = load_lanes(stored + 8 * i);
    rotate_rows(step.rotation, s);
    alignas(64) double deviator[6][lane_width], density[lane_width], energy[lane_width], modulus[lane_width];
    for (int i = 0; i < 6; ++i) store_lanes(deviator[i], s[i]);
    const Lanes mass = load_lanes(w.mass + row), per_mass = 1.0 / mass;
    const Lanes rho = mass * per_volume;
    const Lanes old_energy = load_lanes(w.internal_energy + row);
    store_lanes(density, rho);
    store_lanes(energy, old_energy * per_mass);
    MaterialBatch m;
    m.dt = w.dt;
    m.reference_density = w.reference_density;
    m.strain_increment = step.strain;
    m.density = density;
    m.specific_energy = energy;
    m.pressure = w.pressure + row;
    m.deviator = deviator;
    m.state = w.material_state + static_cast<std::int64_t>(w.n_material_state) * row;
    m.shear_modulus = modulus;
    w.material->update(m);
    Lanes work{};
    for (int i = 0; i < 6; ++i) {
      const Lanes now = load_lanes(deviator[i]);
      work += (i < 3 ? 1.0 : 2.0) * (s[i] + now) * load_lanes(step.strain[i]);
      s[i] = now;
      store_lanes(stored + 8 * i, now);
    }
    const Lanes volume_change = volume - old_volume;
    work *= 0.25 * (volume + old_volume);

    // Pressure: energy predicted with the old pressure, then centred
    const Lanes old_pressure = load_lanes(w.pressure + row);
    alignas(64) double pressure_row[lane_width], bulk_row[lane_width];
    const bool uses_energy = w.eos->uses_energy();
    if (uses_energy) store_lanes(energy, (old_energy + work - old_pressure * volume_change) * per_mass);
    evaluate_eos(w, block, density, energy, pressure_row, bulk_row);
    const Lanes shear = load_lanes(modulus);
    Lanes wave = load_lanes(bulk_row) + (4.0 / 3.0) * shear;
    wave = wave > 0.0 ? wave : lanes(0.0);
    const Lanes c = sqrt_of(wave / rho) + 1e-300;

    // Bulk viscosity, in compression only (von Neumann & Richtmyer 1950; Landshoff 1955)
    const Lanes dilatation =
        (load_lanes(step.strain[0]) + load_lanes(step.strain[1]) + load_lanes(step.strain[2])) / w.dt;
    const Lanes closing = dilatation < 0.0 ? -dilatation : lanes(0.0);
    const Lanes viscosity = linear_viscosity * c + quadratic_viscosity * k.length * closing;
    const Lanes q = upright ? rho * k.length * closing * viscosity : lanes(0.0);
    double* element_state = w.element_state + static_cast<std::int64_t>(w.n_element_state) * row;
    const Lanes old_q = load_lanes(element_state);
    store_lanes(element_state, q);
    const Lanes viscous_work = -0.5 * (old_q + q) * volume_change;
    Lanes p = load_lanes(pressure_row);
    if (uses_energy) {
      const Lanes centred = old_energy + work + viscous_work - 0.5 * (old_pressure + p) * volume_change;
      store_lanes(energy, centred * per_mass);
      evaluate_eos(w, block, density, energy, pressure_row, bulk_row);
      p = load_lanes(pressure_row);
    }
    store_lanes(w.internal_energy + row, old_energy + work + viscous_work - 0.5 * (old_pressure + p) * volume_change);
    store_lanes(w.viscous_energy + row, load_lanes(w.viscous_energy + row) + viscous_work);
    store_lanes(w.pressure + row, p);
    store_lanes(w.volume + row, volume);

    // Stable step: largest eigenvalue of the element, with the viscosity's share
    const Lanes fastest2 = c * c + breathing(k, load_lanes(bulk_row), shear, rho);
    const Lanes stable = k.length / (viscosity + sqrt_of(viscosity * viscosity + fastest2));
    const Lanes element_step = upright ? stable : lanes(std::numeric_limits<double>::max());
    unsigned dead = 0;
    if (w.judge) dead = judge_block(w, block, step, s, p, rho, k.volume, stable);
    const unsigned inverted = mask_of(~upright) & ~dead;
    if (inverted != 0 && w.inverted_block < 0) w.inverted_block = block;
    alignas(64) double alive_row[lane_width];
    for (int l = 0; l < lane_width; ++l) alive_row[l] = (dead >> l & 1u) != 0 ? 0.0 : 1.0;
    const Lanes alive = load_lanes(alive_row) * good;
    note_step(w, block, alive > 0.0 ? element_step : lanes(std::numeric_limits<double>::max()));
    add_forces<stiffness>(w, row, nodes, k, step, s, p + q, c, wave, per_volume, mass, alive, largest_force,
                          hourglass_energy);
  }

  unsigned judge_block(ElementWork& w, int block, const StepStrain& step, const Lanes (&s)[6], Lanes p, Lanes rho,
                       Lanes signed_volume, Lanes stable) const {
    alignas(64) double stress[6][lane_width], pressure[lane_width], density[lane_width], volume[lane_width],
        time_step[lane_width];
    for (int i = 0; i < 6; ++i) store_lanes(stress[i], i < 3 ? s[i] - p : s[i]);
    store_lanes(pressure, p);
    store_lanes(density, rho / w.reference_density);
    store_lanes(volume,
                signed_volume * w.reference_density / load_lanes(w.mass + 8 * static_cast<std::int64_t>(block)));
    store_lanes(time_step, stable);
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
  [[gnu::always_inline]] void add_forces(ElementWork& w, std::int64_t row, const std::int32_t* nodes,
                                         const Kinematics& k, const StepStrain& step, const Lanes (&s)[6], Lanes total,
                                         Lanes c, Lanes wave, Lanes per_volume, Lanes mass, Lanes alive,
                                         Lanes& largest_force, LanesInt& hourglass_energy) const {
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
      resist_displacement(w, row, k, step, rate, wave, per_volume, alive, resist, hourglass_energy);
    else
      resist_velocity(w, row, k, rate, c, per_volume, mass, alive, resist, hourglass_energy);

    const Lanes scale = alive * w.scale.per_quantum;
    Lanes sigma[3][3] = {{s[0] - total, s[3], s[5]}, {s[3], s[1] - total, s[4]}, {s[5], s[4], s[2] - total}};
    Lanes force[3][8];
    for (int i = 0; i < 3; ++i) {
      for (int j = 0; j < 3; ++j) {
        Lanes correction{};
        for (int a = 0; a < 4; ++a) correction += resist[i][a] * shape[j][a];
        sigma[i][j] = (sigma[i][j] - correction * per_volume) * scale;
      }
      Lanes g[4];
      for (int a = 0; a < 4; ++a) g[a] = resist[i][a] * scale;
      spread_hourglass(g, force[i]);
      for (int n = 0; n < 8; ++n)
        force[i][n] = -(force[i][n] + sigma[i][0] * k.b[0][n] + sigma[i][1] * k.b[1][n] + sigma[i][2] * k.b[2][n]);
    }
    LanesInt last[3] = {};
    for (int n = 0; n < 7; ++n) {
      LanesInt quanta[3];
      for (int i = 0; i < 3; ++i) {
        // Written so that NaN ends up in the maximum.
        const Lanes size = abs_of(force[i][n]);
        largest_force = size <= largest_force ? largest_force : size;
        quanta[i] = round_to_int(force[i][n]);
        last[i] -= quanta[i];
      }
      scatter_add(w.force, nodes + 8 * n, quanta[0], quanta[1], quanta[2]);
    }
    scatter_add(w.force, nodes + 56, last[0], last[1], last[2]);
  }

  /// Viscous control: resistance = Q/4 rho c A g (Hallquist 1998, eq. 3.21, with A = sqrt(2/3 B:B), which is the
  /// face area of a cube). A force acts on the mean of the velocities before and after it, so half of its work is
  /// booked now and half in the next step, which knows the velocity after it.
  [[gnu::always_inline]] void resist_velocity(const ElementWork& w, std::int64_t row, const Kinematics& k,
                                              const Lanes (&rate)[3][4], Lanes c, Lanes per_volume, Lanes mass,
                                              Lanes alive, Lanes (&resist)[3][4], LanesInt& hourglass_energy) const {
    const Lanes area = sqrt_of(k.gradient_norm * (2.0 / 3.0));
    const Lanes coefficient = (0.25 * hourglass_coefficient) * mass * per_volume * c * area;
    double* stored = w.element_state + static_cast<std::int64_t>(w.n_element_state) * row + 8;
    Lanes work{};
    for (int a = 0; a < 4; ++a)
      for (int i = 0; i < 3; ++i) {
        resist[i][a] = coefficient * rate[i][a];
        work += (load_lanes(stored + 8 * (3 * a + i)) + resist[i][a]) * rate[i][a];
        store_lanes(stored + 8 * (3 * a + i), resist[i][a]);
      }
    book_hourglass(w, work, alive, hourglass_energy);
  }

  static void book_hourglass(const ElementWork& w, Lanes work, Lanes alive, LanesInt& hourglass_energy) {
    const Lanes energy = 0.5 * work * w.dt * alive * w.energy_per_quantum;
    hourglass_energy += round_to_int(max_of(min_of(energy, lanes(1e18)), lanes(-1e18)));
  }

  /// Stiffness control (Flanagan & Belytschko 1981, eqs. 63-67): resistance grows with k g dt and turns with the
  /// element; k = kappa/24 (K + 4G/3) B:B/V, so that kappa = 1 would give the hourglass modes of a cube the
  /// highest frequency of the element.
  [[gnu::always_inline]] void resist_displacement(const ElementWork& w, std::int64_t row, const Kinematics& k,
                                                  const StepStrain& step, const Lanes (&rate)[3][4], Lanes wave,
                                                  Lanes per_volume, Lanes alive, Lanes (&resist)[3][4],
                                                  LanesInt& hourglass_energy) const {
    const Lanes growth = (hourglass_coefficient / 24.0) * wave * k.gradient_norm * per_volume * w.dt;
    double* stored = w.element_state + static_cast<std::int64_t>(w.n_element_state) * row + 8;
    Lanes work{};
    Lanes r[9];
    for (int i = 0; i < 9; ++i) r[i] = load_lanes(step.rotation[i]);
    for (int a = 0; a < 4; ++a) {
      Lanes old[3];
      for (int i = 0; i < 3; ++i) old[i] = load_lanes(stored + 8 * (3 * a + i));
      for (int i = 0; i < 3; ++i) {
        const Lanes turned = r[3 * i] * old[0] + r[3 * i + 1] * old[1] + r[3 * i + 2] * old[2];
        resist[i][a] = turned + growth * rate[i][a];
        work += (turned + resist[i][a]) * rate[i][a];
        store_lanes(stored + 8 * (3 * a + i), resist[i][a]);
      }
    }
    book_hourglass(w, work, alive, hourglass_energy);
  }
};

}  // namespace

KERF_ELEMENT(Hex8, "hex8", "eight-node hexahedron, one integration point, hourglass control, bulk viscosity")
