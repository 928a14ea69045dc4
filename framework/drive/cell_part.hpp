// Drives an element over a small mesh without the rest of the engine: the same store and the same view that the element
// loop uses, with nodes that the caller moves. What `kerf drive`, `kerf test-plugin` and the point tests run on.
#pragma once

#include <array>
#include <cmath>
#include <cstdint>
#include <limits>
#include <memory>
#include <random>
#include <stdexcept>
#include <string>
#include <vector>

#include "erosion/judge.hpp"
#include "input/model_input.hpp"
#include "kerf/element.hpp"
#include "model/law_reads.hpp"
#include "model/law_variables.hpp"
#include "model/part_store.hpp"

namespace kerf {

struct CellMesh {
  std::vector<Vec3> x;  // [m]
  std::vector<std::array<std::int32_t, 8>> elements;  // as many entries count as the shape has nodes
  const Shape* shape = &hexahedron;
};

/// Corners of the reference cube in the order of an element's nodes.
inline constexpr int corner[8][3] = {{-1, -1, -1}, {1, -1, -1}, {1, 1, -1}, {-1, 1, -1},
                                     {-1, -1, 1},  {1, -1, 1},  {1, 1, 1},  {-1, 1, 1}};

/// A block of `nx` x `ny` x `nz` cubes of edge `size`, every node moved by up to `distortion` edges per direction.
inline CellMesh distorted_block(int nx, int ny, int nz, double size, double distortion, unsigned seed) {
  CellMesh mesh;
  std::mt19937 random(seed);
  std::uniform_real_distribution<double> shift(-distortion, distortion);
  const auto node = [&](int i, int j, int k) { return (i * (ny + 1) + j) * (nz + 1) + k; };
  for (int i = 0; i <= nx; ++i)
    for (int j = 0; j <= ny; ++j)
      for (int k = 0; k <= nz; ++k)
        mesh.x.push_back(Vec3{i + shift(random), j + shift(random), k + shift(random)} * size);
  for (int i = 0; i < nx; ++i)
    for (int j = 0; j < ny; ++j)
      for (int k = 0; k < nz; ++k) {
        std::array<std::int32_t, 8> e;
        for (int n = 0; n < 8; ++n)
          e[n] = node(i + (corner[n][0] + 1) / 2, j + (corner[n][1] + 1) / 2, k + (corner[n][2] + 1) / 2);
        mesh.elements.push_back(e);
      }
  return mesh;
}

/// One element of that kind.
inline CellMesh distorted_element(double size, double distortion, unsigned seed) {
  return distorted_block(1, 1, 1, size, distortion, seed);
}

/// Volume of an element from its surface alone: a third of the integral of x . n over its bilinear faces. A triangle is
/// one of them whose last two corners coincide.
inline double volume_by_divergence(const CellMesh& mesh, const std::array<std::int32_t, 8>& element) {
  const double g = 1.0 / std::sqrt(3.0);  // two points integrate the products of bilinear functions exactly
  const Vec3 origin = mesh.x[element[0]];
  double sum = 0.0;
  for (int face = 0; face < mesh.shape->n_faces; ++face)
    for (const double a : {-g, g})
      for (const double b : {-g, g}) {
        Vec3 x, along_a, along_b;
        constexpr int at[4][2] = {{-1, -1}, {1, -1}, {1, 1}, {-1, 1}};
        for (int k = 0; k < 4; ++k) {
          const Vec3 p = mesh.x[element[mesh.shape->face[face][k]]] - origin;
          x = x + p * (0.25 * (1.0 + at[k][0] * a) * (1.0 + at[k][1] * b));
          along_a = along_a + p * (0.25 * at[k][0] * (1.0 + at[k][1] * b));
          along_b = along_b + p * (0.25 * at[k][1] * (1.0 + at[k][0] * a));
        }
        sum += dot(x, cross(along_a, along_b)) / 3.0;
      }
  return sum;
}

/// The elements of one part and their nodes, which compute with numbers of type `Real`. `x` and `v` are the test's to
/// set; `step` moves the nodes by v dt and integrates.
template <class Real>
class CellPart {
 public:
  std::vector<Vec3> x, v;  // [m], [m/s]
  ElementArrays<Real> work;  // of the last call
  double force_quantum = quantum;  // [N]
  const std::uint8_t* exposed_faces = nullptr;  // per element, for initialise

  /// `compression` is the mass of the elements over density times volume. Material and element must outlive this.
  CellPart(const CellMesh& mesh, const MaterialInput& material, Element& element, double compression = 1.0)
      : x(mesh.x),
        v(mesh.x.size()),
        elements_(mesh.elements),
        element_(element),
        laws_(material),
        store_(0, element, variables(laws_, first_criterion_),
               is_single ? Precision::single_precision : Precision::double_precision),
        density_(material.density) {
    std::vector<double> record(static_cast<std::size_t>(store_.record_size()));
    store_.make_room(static_cast<int>(elements_.size()));
    for (std::size_t e = 0; e < elements_.size(); ++e) {
      const double volume = volume_by_divergence(mesh, elements_[e]);
      store_.initial_record(compression * density_ * volume, record.data());
      start(mesh, elements_[e], kerf::pow(volume, 1.0 / 3.0), record.data());
      store_.put(static_cast<int>(e), static_cast<std::int64_t>(e), elements_[e].data(), record.data());
    }
    // The dummy nodes form a cube that is larger than any element, so that it never sets the time step.
    const double edge = 16.0 * kerf::pow(volume_by_divergence(mesh, elements_[0]), 1.0 / 3.0);
    const double volume = element_.volume(reference_cell(element_.shape(), edge));
    store_.set_dummies(static_cast<std::int32_t>(x.size()), density_ * volume, volume);
    position_.resize(4 * (x.size() + 8));
    velocity_.resize(position_.size());
    force_.resize(position_.size());
    for (int n = 0; n < 8; ++n)
      for (int d = 0; d < 3; ++d) position_[4 * (x.size() + n) + d] = 0.5 * edge * (1 + corner[n][d]);
  }

  void initialise() {
    prepare(0.0);
    work.exposed_faces = exposed_faces;
    if constexpr (is_single)
      element_.initialise_single(work);
    else
      element_.initialise(work);
  }
  /// Moves the nodes by v dt, then computes the forces from nothing.
  void step(double dt) {
    for (std::size_t n = 0; n < x.size(); ++n) x[n] = x[n] + v[n] * dt;
    prepare(dt);
    integrate();
  }
  /// Takes the nodes to `target` in one step at constant velocity.
  void move_to(const std::vector<Vec3>& target, double dt) {
    for (std::size_t n = 0; n < x.size(); ++n) v[n] = (target[n] - x[n]) * (1.0 / dt);
    x = target;
    prepare(dt);
    integrate();
  }

  /// All that a step changes; restore() takes the part back to it.
  struct Snapshot {
    std::vector<Vec3> x, v;
    std::vector<std::vector<double>> records;
    double time = 0.0;
    std::int64_t cycle = 0;
  };
  Snapshot save() const {
    Snapshot s{x, v, {}, time_, cycle_};
    for (int e = 0; e < n_elements(); ++e) {
      s.records.emplace_back(static_cast<std::size_t>(store_.record_size()));
      store_.pack(e, s.records.back().data());
    }
    return s;
  }
  void restore(const Snapshot& s) {
    x = s.x;
    v = s.v;
    time_ = s.time;
    cycle_ = s.cycle;
    for (int e = 0; e < n_elements(); ++e) store_.put(e, e, elements_[e].data(), s.records[e].data());
  }

  int n_elements() const { return static_cast<int>(elements_.size()); }
  const std::array<std::int32_t, 8>& nodes(int e) const { return elements_[e]; }
  double get(PartStore::FieldIndex field, int e, int component = 0) const {
    return store_.field(field).at(e, component);
  }
  void set(PartStore::FieldIndex field, int e, int component, double value) {
    store_.field(field).set(e, component, value);
  }
  SymTensor deviator(int e) const {
    const auto s = [&](int c) { return get(PartStore::deviator, e, c); };
    return {s(0), s(1), s(2), s(3), s(4), s(5)};
  }
  void set_deviator(int e, SymTensor s) {
    const double c[6] = {s.xx, s.yy, s.zz, s.xy, s.yz, s.zx};
    for (int i = 0; i < 6; ++i) set(PartStore::deviator, e, i, c[i]);
  }
  double pressure(int e) const { return get(PartStore::pressure, e); }
  SymTensor stress(int e) const {
    const double p = pressure(e);
    return deviator(e) + SymTensor{-p, -p, -p, 0.0, 0.0, 0.0};
  }
  /// Sum over elements of the force on a node [N], and in quanta.
  Vec3 force(int node) const {
    return {quanta(node, 0) * force_quantum, quanta(node, 1) * force_quantum, quanta(node, 2) * force_quantum};
  }
  std::int64_t quanta(int node, int d) const { return force_[4 * static_cast<std::size_t>(node) + d]; }
  /// Least stable step of the last call [s].
  double stable_step() const {
    double least = work.least_step[0];
    for (const Real s : work.least_step) least = min_of(static_cast<double>(s), least);
    return least;
  }
  double hourglass_energy() const { return static_cast<double>(work.hourglass_energy) / work.energy_per_quantum; }
  /// A state variable by name.
  double variable(const std::string& name, int e) const {
    const auto [field, component] = store_.find_variable(name);
    if (field == PartStore::n_fields) throw std::runtime_error("no state variable " + name);
    return get(field, e, component);
  }
  void set_variable(const std::string& name, int e, double value) {
    const auto [field, component] = store_.find_variable(name);
    if (field == PartStore::n_fields) throw std::runtime_error("no state variable " + name);
    set(field, e, component, value);
  }
  /// Whether the last step has judged that an element is to be deleted. It is not.
  bool failed(int e) const { return (judge_->flags[e / lane_width] >> (e % lane_width) & 1u) != 0; }
  double element_mass(int e) const { return get(PartStore::mass, e); }

  /// 2^-33 N: forces up to 1.6e7 N are resolved to a tenth of a nanonewton.
  static constexpr double quantum = 0x1p-33;

 private:
  static constexpr bool is_single = std::is_same_v<Real, float>;

  static PartStore::Variables variables(const MaterialInput& laws, int& first_criterion) {
    PartStore::Variables all = variables_of(laws, first_criterion);
    all.place = true;
    return all;
  }
  /// State of an element before the first step.
  void start(const CellMesh& mesh, const std::array<std::int32_t, 8>& nodes, double length, double* record) const {
    InitialPoint point{{}, length, density_};
    for (int k = 0; k < mesh.shape->n_nodes; ++k)
      point.position = point.position + mesh.x[nodes[k]] * (1.0 / mesh.shape->n_nodes);
    laws_.stress_law().initialise(point, record + store_.offset(PartStore::material_state));
    if (laws_.eos) laws_.eos->initialise(point, record + store_.offset(PartStore::eos_state));
    double* criterion = record + store_.offset(PartStore::erosion_state) + first_criterion_;
    for (std::size_t k = 0; laws_.erosion && k < laws_.erosion->criteria.size(); ++k) {
      laws_.erosion->criteria[k]->initialise(point, criterion);
      criterion += laws_.erosion->criteria[k]->state_variables().size();
    }
    double* place = record + store_.offset(PartStore::place);
    for (int d = 0; d < 3; ++d) place[d] = point.position[d];
    place[3] = length;
  }

  void integrate() {
    if constexpr (is_single)
      element_.add_internal_forces_single(work);
    else
      element_.add_internal_forces(work);
  }
  void prepare(double dt) {
    for (std::size_t n = 0; n < x.size(); ++n)
      for (int d = 0; d < 3; ++d) {
        position_[4 * n + d] = x[n][d];
        velocity_[4 * n + d] = v[n][d];
      }
    std::fill(force_.begin(), force_.end(), 0);
    const auto reals = [&](PartStore::FieldIndex f) { return store_.field(f).template entries<Real>(); };
    const auto doubles = [&](PartStore::FieldIndex f) { return store_.field(f).template entries<double>(); };
    work = {};
    work.position = position_.data();
    work.velocity = velocity_.data();
    work.force = force_.data();
    work.scale = {force_quantum, 1.0 / force_quantum};
    work.dt = dt;
    work.time = time_ += dt;
    work.material = laws_.strength.get();
    work.eos = laws_.eos.get();
    work.solid = laws_.solid.get();
    work.of_material = material_reads_.access(store_);
    if (work.eos) work.of_eos = eos_reads_.access(store_);
    work.place = doubles(PartStore::place);
    work.reference_density = density_;
    work.n_blocks = store_.n_blocks();
    work.nodes = store_.nodes();
    work.mass = doubles(PartStore::mass);
    work.volume = doubles(PartStore::volume);
    work.deviator = reals(PartStore::deviator);
    work.pressure = reals(PartStore::pressure);
    work.internal_energy = doubles(PartStore::internal_energy);
    work.viscous_energy = doubles(PartStore::viscous_energy);
    work.element_state = reals(PartStore::element_state);
    work.material_state = doubles(PartStore::material_state);
    work.eos_state = doubles(PartStore::eos_state);
    work.n_element_state = store_.field(PartStore::element_state).n_components;
    work.n_material_state = store_.field(PartStore::material_state).n_components;
    work.n_eos_state = store_.field(PartStore::eos_state).n_components;
    if (judge_) {
      judge_->begin(store_, ++cycle_);
      work.judge = judge_.get();
      work.failed = judge_->flags.data();
    }
    if (store_.field(PartStore::softening).n_components > 0) work.softening = doubles(PartStore::softening);
    work.energy_per_quantum = 0x1p60;
    std::fill(work.least_step, work.least_step + lane_width, std::numeric_limits<Real>::max());
    std::fill(work.least_block, work.least_block + lane_width, 0);
  }

  std::vector<std::array<std::int32_t, 8>> elements_;
  Element& element_;
  int first_criterion_ = 0;
  const MaterialInput& laws_;
  PartStore store_;
  std::unique_ptr<PartJudge> judge_ =
      laws_.erosion ? std::make_unique<PartJudge>(*laws_.erosion, store_, first_criterion_) : nullptr;
  std::int64_t cycle_ = 0;
  LawReads material_reads_{laws_.stress_law(), store_};
  LawReads eos_reads_ = laws_.eos ? LawReads(*laws_.eos, store_) : LawReads();
  double density_, time_ = 0.0;
  AlignedVector<double> position_, velocity_;
  AlignedVector<std::int64_t> force_;
};
}  // namespace kerf
