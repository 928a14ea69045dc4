// An element with a shape of its own, and a mesh of it: the six-node wedge with one integration point.
//
// The mean gradient is the derivative of the volume by the nodes, as in D.P. Flanagan & T. Belytschko, IJNME 17 (1981)
// 679-706. Six nodes have eighteen velocities; twelve are those of a linear field, the other six are hourglass modes:
// the two triangles turn and stretch against each other. They are resisted in proportion to their velocity.
#include <kerf/mesh.hpp>
#include <kerf/solid_kernel.hpp>

namespace {

using namespace kerf;

// VTK's order of the nodes: a triangle whose normal points outward, and the other one beyond it.
constexpr Shape wedge = completed({
    .name = "@NAME@",
    .n_nodes = 6,
    .n_faces = 5,
    .n_edges = 9,
    .face = {{0, 1, 2, 2}, {3, 5, 4, 4}, {0, 2, 5, 3}, {0, 3, 4, 1}, {1, 4, 5, 2}},
    .edge = {{0, 1}, {1, 2}, {2, 0}, {3, 4}, {4, 5}, {5, 3}, {0, 3}, {1, 4}, {2, 5}},
    .reference = {0, 3, 1, 4, 7, 5},
    .vtk_type = 13,
});

struct Motion : SolidMotion<double, wedge> {
  V x[3][6], v[3][6], b[3][6];
  template <class Number>
  [[gnu::always_inline]] static V product(const V (&a)[6], const Number (&c)[6]) {
    return ((a[0] * c[0] + a[1] * c[1]) + (a[2] * c[2] + a[3] * c[3])) + (a[4] * c[4] + a[5] * c[5]);
  }
  [[gnu::always_inline]] V rate(int i, int j) const { return product(v[i], b[j]); }
};

// Base vectors of the hourglass modes, orthogonal to each other and to constants; their square is four.
constexpr double third = 0.57735026918962576;  // 1 over the square root of 3
constexpr double base[2][6] = {{0, -1, 1, 0, 1, -1}, {-2 * third, third, third, 2 * third, -third, -third}};

using State = SolidState<6>;

class Kernel : public SolidKernel<double, Motion, State, Kernel> {
 public:
  Kernel(const SolidControl& control, double hourglass_coefficient)
      : SolidKernel(control), hourglass_coefficient_(hourglass_coefficient) {}

  [[gnu::always_inline]] static void measure(const double* position, const double* velocity, const std::int32_t* nodes,
                                             Motion& k) {
    gather_nodes(position, velocity, nodes, k.x, k.v);
    for (int i = 0; i < 3; ++i) mean_gradient(k.x[(i + 1) % 3], k.x[(i + 2) % 3], k.b[i]);
    k.exact_volume[0] = k.volume = k.product(k.x[0], k.b[0]);
    stable_length(k.product(k.b[0], k.b[0]), k.product(k.b[1], k.b[1]), k.product(k.b[2], k.b[2]),
                  k.product(k.b[0], k.b[1]), k.product(k.b[1], k.b[2]), k.product(k.b[2], k.b[0]), k);
  }

  [[gnu::always_inline]] static void forces_of_stress(const Motion& k, const V (&sigma)[3][3], V (&force)[3][6]) {
    for (int i = 0; i < 3; ++i)
      for (int n = 0; n < 6; ++n)
        force[i][n] = -(sigma[i][0] * k.b[0][n] + sigma[i][1] * k.b[1][n] + sigma[i][2] * k.b[2][n]);
  }

  /// With the base vectors Gamma_a, gamma_a = Gamma_a - B_j (x_j Gamma_a) / V does not see linear
  /// fields; its rate is Gamma_a v_i - L_ij (x_j Gamma_a). The force is at most half of what would stop a mode in a
  /// step.
  [[gnu::always_inline]] V find_forces(const Work& w, int block, int lane, const Piece& p, const Strain&, V alive,
                                       Totals& totals, V (&force)[3][6]) const {
    const Motion& k = p.k;
    const V area = sqrt_of(k.gradient_norm * (2.0 / 3.0));  // about that of a face
    const V coefficient =
        min_of(0.25 * hourglass_coefficient_ * p.density * p.c * area, p.mass * (1.0 / (48.0 * w.dt)));
    const V scale = alive * w.scale.per_quantum;
    V sigma[3][3], resist[3][2], power{};
    total_stress(p, sigma);
    for (int a = 0; a < 2; ++a) {
      V shape[3];
      for (int j = 0; j < 3; ++j) shape[j] = k.product(k.x[j], base[a]);
      for (int i = 0; i < 3; ++i) {
        V rate = k.product(k.v[i], base[a]);
        for (int j = 0; j < 3; ++j) rate -= k.velocity_gradient[i][j] * shape[j];
        resist[i][a] = coefficient * rate;
        for (int j = 0; j < 3; ++j) sigma[i][j] -= resist[i][a] * shape[j] * p.per_volume;
        double* stored = state_at(w, block, place_in_state(offsetof(State, resistance)) + 3 * a + i, lane);
        power += (load_lanes(stored) + alive * resist[i][a]) * rate;
        store_lanes(stored, resist[i][a]);
      }
    }
    book_hourglass(w, lane, power, p.good, totals);
    forces_of_stress(k, sigma, force);
    for (int i = 0; i < 3; ++i)
      for (int n = 0; n < 6; ++n)
        force[i][n] = (force[i][n] - resist[i][0] * base[0][n] - resist[i][1] * base[1][n]) * scale;
    return sizes_of(force[0]) + sizes_of(force[1]) + sizes_of(force[2]);
  }

 private:
  /// The derivative of `volume_by_faces`.
  [[gnu::always_inline]] static void mean_gradient(const V (&y)[6], const V (&z)[6], V (&b)[6]) {
    const auto cross = [&](int m, int n) __attribute__((always_inline)) { return y[m] * z[n] - y[n] * z[m]; };
    for (V& entry : b) entry = V{};
#pragma GCC unroll 5
    for (int face = 0; face < wedge.n_faces; ++face) {
      const auto& f = wedge.face[face];
      const V ab = cross(f[0], f[1]), bc = cross(f[1], f[2]), cd = cross(f[2], f[3]), da = cross(f[3], f[0]),
              ac = cross(f[0], f[2]), bd = cross(f[1], f[3]);
      b[f[0]] += (bc + cd + bd) * (1.0 / 12.0);
      b[f[1]] += (cd + da - ac) * (1.0 / 12.0);
      b[f[2]] += (da + ab - bd) * (1.0 / 12.0);
      b[f[3]] += (ab + bc + ac) * (1.0 / 12.0);
    }
  }
  double hourglass_coefficient_;
};

struct @TYPE@ final : SolidElement {
  using State = ::State;
  double hourglass_coefficient = 0.0;

  static void describe(Schema<@TYPE@>& s) {
    s.real(&@TYPE@::hourglass_coefficient, "hourglass_coefficient", "-", between(0.0, 0.5),
           "strength of the viscous hourglass control")
        .by_default("0.05");
    describe_solid<State>(s);
  }
  const Shape& shape() const override { return wedge; }
  void initialise(ElementWork& w) const override { Kernel(solid_control(), hourglass_coefficient).initialise(w); }
  void add_internal_forces(ElementWork& w) const override { Kernel(solid_control(), hourglass_coefficient).run(w); }
};

/// A box of bricks, each of which is two wedges; x runs fastest in the numbering.
struct @TYPE@Block final : MeshGenerator {
  Vec3 size, origin;  // [m]
  std::vector<std::int64_t> cells;

  static void describe(Schema<@TYPE@Block>& s) {
    s.vector(&@TYPE@Block::size, "size", "m", positive, "edges of the box");
    s.vector(&@TYPE@Block::origin, "origin", "m", any_value, "corner of the box").by_default("[0, 0, 0]");
    s.integers(&@TYPE@Block::cells, "cells", positive, "bricks along x, y and z");
  }
  std::vector<std::string> prepare() override {
    if (cells.size() == 3) return {};
    return {"cells: expected three numbers, along x, y and z"};
  }
  const Shape& shape() const override { return wedge; }
  std::int64_t n_nodes() const override { return (cells[0] + 1) * (cells[1] + 1) * (cells[2] + 1); }
  std::int64_t n_elements() const override { return 2 * cells[0] * cells[1] * cells[2]; }
  Vec3 node(std::int64_t i) const override {
    Vec3 x = origin;
    for (int d = 0; d < 3; ++d) x[d] += size[d] * static_cast<double>(line(i, d)) / static_cast<double>(cells[d]);
    return x;
  }
  ElementNodeIds element(std::int64_t e) const override {
    const std::int64_t i = e / 2 % cells[0], j = e / 2 / cells[0] % cells[1], k = e / 2 / (cells[0] * cells[1]);
    const std::int64_t row = cells[0] + 1, up = row * (cells[1] + 1), a = k * up + j * row + i;
    const std::int64_t b = a + 1, c = a + row + 1, d = a + row;
    if (e % 2 == 0) return {a, d, b, a + up, d + up, b + up};
    return {c, b, d, c + up, b + up, d + up};
  }
  std::vector<std::string> face_names() const override {
    return {"x_min", "x_max", "y_min", "y_max", "z_min", "z_max"};
  }
  bool on_face(std::int64_t i, int face) const override {
    return line(i, face / 2) == (face % 2 == 0 ? 0 : cells[face / 2]);
  }

 private:
  std::int64_t line(std::int64_t i, int axis) const {
    const std::int64_t row = cells[0] + 1, up = row * (cells[1] + 1);
    return axis == 0 ? i % row : axis == 1 ? i % up / row : i / up;
  }
};

}  // namespace

KERF_REGISTER(KERF_TYPE(@TYPE@, "element", "@NAME@", "six-node wedge with one integration point")
                  KERF_TYPE(@TYPE@Block, "mesh", "@NAME@_block", "axis-aligned box of wedges"))
