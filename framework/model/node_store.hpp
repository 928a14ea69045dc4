// Owns every array of the nodes that one rank touches.
//
// Every rank keeps, and moves, a copy of each node that its elements touch; forces are made equal on all copies
// before they are used, so all copies hold the same bits. One rank owns the node and counts it in sums. After
// the last node come eight dummy nodes, a cube at rest that empty element slots refer to.
#pragma once

#include <cstdint>
#include <vector>

#include "kerf/shape.hpp"
#include "model/aligned.hpp"

namespace kerf {

/// What travels with a node; plain data.
struct NodeRecord {
  std::int64_t id = 0;
  std::int32_t membership = 0;  // number in the model's table of combinations of parts and sets
  std::int32_t part = 0;  // the first of the parts whose elements touch it in the undeformed model
  std::int32_t free = 0;  // 1: no live element anywhere touches it
  double reference[3] = {};  // position in the undeformed model [m]
  double position[3] = {}, velocity[3] = {};
  double mass = 0.0;
  std::int64_t force[3] = {};
};

struct NodeStore {
  std::vector<std::int64_t> id;
  std::vector<std::int32_t> membership, part;
  std::vector<std::uint8_t> free, owned;
  std::vector<double> reference;  // three per node [m]
  AlignedVector<double> position, velocity;  // four per node [m], [m/s] (mid-step)
  AlignedVector<std::int64_t> force;  // four per node, in force quanta
  std::vector<double> mass, inverse_mass;  // [kg], [1/kg]; the latter zero for dropped nodes

  static constexpr int n_dummies = 8;  // corners of a cube
  int n() const { return static_cast<int>(id.size()); }
  std::int32_t first_dummy() const { return static_cast<std::int32_t>(id.size()); }

  void resize(int n) {
    const std::size_t m = static_cast<std::size_t>(n);
    id.assign(m, -1);
    membership.assign(m, 0);
    part.assign(m, 0);
    free.assign(m, 0);
    owned.assign(m, 0);
    reference.assign(3 * m, 0.0);
    position.assign(4 * (m + n_dummies), 0.0);
    velocity.assign(4 * (m + n_dummies), 0.0);
    force.assign(4 * (m + n_dummies), 0);
    mass.assign(m, 0.0);
    inverse_mass.assign(m, 0.0);
  }
  Vec3 x(int i) const { return {position[4 * i], position[4 * i + 1], position[4 * i + 2]}; }
  /// Position in the undeformed model [m].
  Vec3 reference_position(int i) const {
    const double* x0 = &reference[3 * static_cast<std::size_t>(i)];
    return {x0[0], x0[1], x0[2]};
  }
  Vec3 v(int i) const { return {velocity[4 * i], velocity[4 * i + 1], velocity[4 * i + 2]}; }
  void set_x(int i, Vec3 a) {
    position[4 * i] = a.x;
    position[4 * i + 1] = a.y;
    position[4 * i + 2] = a.z;
  }
  void set_v(int i, Vec3 a) {
    velocity[4 * i] = a.x;
    velocity[4 * i + 1] = a.y;
    velocity[4 * i + 2] = a.z;
  }
  NodeRecord record(int i) const {
    NodeRecord r;
    r.id = id[i];
    r.membership = membership[i];
    r.part = part[i];
    r.free = free[i];
    for (int d = 0; d < 3; ++d) {
      r.reference[d] = reference[3 * static_cast<std::size_t>(i) + d];
      r.position[d] = position[4 * i + d];
      r.velocity[d] = velocity[4 * i + d];
      r.force[d] = force[4 * i + d];
    }
    r.mass = mass[i];
    return r;
  }
  void assign(int i, const NodeRecord& r) {
    id[i] = r.id;
    membership[i] = r.membership;
    part[i] = r.part;
    free[i] = static_cast<std::uint8_t>(r.free);
    for (int d = 0; d < 3; ++d) {
      reference[3 * static_cast<std::size_t>(i) + d] = r.reference[d];
      position[4 * i + d] = r.position[d];
      velocity[4 * i + d] = r.velocity[d];
      force[4 * i + d] = r.force[d];
    }
    set_mass(i, r.mass);
  }
  void set_mass(int i, double m) {
    mass[i] = m;
    inverse_mass[i] = m > 0.0 ? 1.0 / m : 0.0;
  }
  /// Places the dummies, the corners of a cube of which every shape's reference element takes some; `edge` [m].
  void place_dummies(double edge) {
    for (int k = 0; k < n_dummies; ++k)
      for (int d = 0; d < 3; ++d) position[4 * (first_dummy() + k) + d] = edge * unit_cube[k][d];
  }
};

}  // namespace kerf
