// Central differences: velocities at mid-step, positions at step ends; boundary conditions and their work.
//
// Every rank moves all its copies of nodes, with equal forces and hence equal bits. Work and impulse are counted
// by the owner of a node only.
#pragma once

#include <cstdint>
#include <vector>

#include "contact/load.hpp"
#include "core/quad.hpp"
#include "loads/external_load.hpp"
#include "model/constraints.hpp"
#include "model/ledger.hpp"
#include "model/model.hpp"
#include "model/step.hpp"

namespace kerf {

/// What the force of a node holds, apart from that of its elements, in the books.
struct ForceShares {
  const ContactLoad& contact;
  const ExternalLoad& external;
};

class Integrator {
 public:
  /// The conditions must outlive this.
  explicit Integrator(const Constraints& constraints) : constraints_(constraints) {}
  /// v += F/m dt, constraints, x += v dt, F = 0.
  void kick_and_drift(Model& model, const Step& step, const ForceShares& shares, Ledger& ledger);
  /// Kinetic energy and momentum at the start of `next`, and the work of contact, loads and boundaries up to there.
  /// Changes nothing. Collective.
  Balance sample(const Model& model, const Step& next, const ForceShares& shares, const Ledger& ledger) const;

 private:
  void count(const Model& model, int node, Vec3 before, Vec3 free_flight, Vec3 after, Ledger& ledger) const;
  void count_shares(const Model& model, const Step& step, const ForceShares& shares, Ledger& ledger) const;
  void advance_guarded(Model& model, const Step& step, const std::vector<HalfSpace>& planes, Ledger& ledger);

  const Constraints& constraints_;
  std::vector<double> saved_, old_contact_velocity_, old_external_velocity_;
};

}  // namespace kerf
