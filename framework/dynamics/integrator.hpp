// Central differences: velocities at mid-step, positions at step ends; boundary conditions and their work.
//
// Every rank moves all its copies of nodes, with equal forces and hence equal bits. Work and impulse are counted
// by the owner of a node only.
#pragma once

#include <cstdint>
#include <vector>

#include "core/quad.hpp"
#include "dynamics/ledger.hpp"
#include "dynamics/names.hpp"
#include "dynamics/step.hpp"
#include "state/model.hpp"

namespace kerf {

/// Contact forces on owned nodes of this rank in the current step, for their work.
struct ContactLoad {
  std::vector<std::int32_t> nodes;
  std::vector<std::int64_t> force;  // four per node, in force quanta
  std::vector<std::int64_t> friction;  // the share of friction in it; the same length
};

class Integrator;

/// What nodes will do in the coming step under the forces that are known, boundary conditions included.
class Prediction {
 public:
  /// All must outlive this.
  Prediction(const Integrator& integrator, const Model& model, const Step& next);
  /// Velocity in the coming step [m/s].
  Quad velocity(int node) const;
  /// Position at its end [m].
  Quad position(int node) const { return from(node) + velocity(node) * next_.dt; }
  /// Both, and the axes along which boundary conditions keep a node from following a force, as bits. A condition that
  /// is oblique to the axes does not count.
  struct Flight {
    Quad velocity, position;
    unsigned held_axes = 0;
  };
  Flight flight(int node) const;
  const Step& step() const { return next_; }

 private:
  Quad from(int node) const { return row_of(model_.nodes.position.data(), node); }
  bool is_free(int node, const Quad& velocity) const;
  unsigned held_axes(int node, Vec3 kicked, Vec3 constrained) const;

  const Integrator& integrator_;
  const Model& model_;
  Step next_;
  double factor_;  // from force quanta times inverse mass to velocity
  std::vector<HalfSpace> planes_;
};

class Integrator {
 public:
  /// Resolves which nodes are constrained; to be called again whenever nodes are renumbered. Local.
  void resolve(const Model& model);
  /// Sets velocities at time zero. Collective only in that all ranks do it to all copies.
  void initialise(Model& model) const;
  /// One error line for every boundary condition with nodes that cannot start as they stand. Collective.
  std::vector<std::string> complaints(const Model& model) const;
  /// v += F/m dt, constraints, x += v dt, F = 0.
  void kick_and_drift(Model& model, const Step& step, const ContactLoad& load, Ledger& ledger);
  /// Kinetic energy and momentum at the start of `next`, and the work of contact and boundaries up to there.
  /// Changes nothing. Collective.
  Balance sample(const Model& model, const Step& next, const ContactLoad& load, const Ledger& ledger) const;

 private:
  struct Constrained {
    std::int32_t node = 0;
    std::uint64_t always = 0;  // conditions that are asked in every step, a bit per condition of the input
  };
  static std::vector<HalfSpace> regions(const Model& model, const Step& step);
  Vec3 constrain(const Model& model, int node, std::uint64_t always, const Step& step,
                 const std::vector<HalfSpace>& planes, Vec3 old_velocity, Vec3 velocity) const;
  void count(const Model& model, int node, Vec3 before, Vec3 free_flight, Vec3 after, Ledger& ledger) const;
  void advance_guarded(Model& model, const Step& step, const std::vector<HalfSpace>& planes, Ledger& ledger);

  friend class Prediction;

  std::vector<Constrained> constrained_;  // by node
  std::vector<std::uint64_t> always_;  // per node, what constrained_ lists; empty where there is no condition at all
  // Per node: conditions that are asked only if the free flight ends in their region, which is tested in the pass over
  // all nodes. Empty where there is no condition at all.
  std::vector<std::uint64_t> near_;
  std::vector<double> saved_, old_load_velocity_;
};

}  // namespace kerf
