// Central differences: velocities at mid-step, positions at step ends; boundary conditions and their work.
//
// Every rank moves all its copies of nodes, with equal forces and hence equal bits. Work and impulse are counted
// by the owner of a node only.
#pragma once

#include <cstdint>
#include <vector>

#include "contact/load.hpp"
#include "core/quad.hpp"
#include "dynamics/side_books.hpp"
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
  /// Lets these books see what every single condition does. They must outlive this.
  void split_reactions(SideBooks& books) { books_ = &books; }
  /// v += F/m dt, constraints, x += v dt, F = 0.
  void kick_and_drift(Model& model, const Step& step, const ForceShares& shares, Ledger& ledger);
  /// Kinetic energy and momentum at the start of `next`, and the work of contact, loads and boundaries up to there.
  /// Changes nothing. Collective.
  Balance sample(const Model& model, const Step& next, const ForceShares& shares, const Ledger& ledger) const;
  /// The terms of the kinetic energy in sample(), per node; zero for ghosts [J]. Local.
  std::vector<double> kinetic_energies(const Model& model, const Step& next, const Ledger& ledger) const {
    return look_ahead(model, next, ledger).kinetic;
  }

 private:
  /// What nodes have at the start of `next`, ghosts with zeros, and the work that conditions will do per share of it.
  struct Outlook {
    std::vector<double> kinetic, momentum[3];  // [J], [kg m/s]
    std::int64_t external = 0;  // [energy quanta]
  };
  Outlook look_ahead(const Model& model, const Step& next, const Ledger& ledger) const;
  /// A node on its way through a step, when its conditions have been asked.
  struct Passage {
    int node = 0;
    Vec3 before, free_flight, after;  // [m/s]
  };
  void count(const Model& model, const Step& step, const std::vector<HalfSpace>& planes, const Passage& p,
             Ledger& ledger) const;
  void count_shares(const Model& model, const Step& step, const ForceShares& shares, Ledger& ledger) const;
  void advance_guarded(Model& model, const Step& step, const std::vector<HalfSpace>& planes, Ledger& ledger);

  const Constraints& constraints_;
  SideBooks* books_ = nullptr;
  std::vector<double> saved_, old_contact_velocity_, old_external_velocity_;
};

}  // namespace kerf
