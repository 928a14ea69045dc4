// Accounts for energy, momentum and mass: what was put in, what is there, what was taken out.
//
// Everything that is summed over time is kept in whole quanta, so that its total does not depend on which rank
// added what.
#pragma once

#include <mpi.h>

#include <cstdint>

#include "kerf/math.hpp"
#include "model/accounts.hpp"
#include "model/model.hpp"
#include "model/step.hpp"

namespace kerf {

/// What all ranks have let go of together. Collective.
LetGo total_of(MPI_Comm comm, const LetGo& mine);

class Ledger {
 public:
  /// Fixes the quanta of energy, momentum and mass from the model at rest in time zero. Collective.
  void open(Model& model);

  Accounts accounts;
  LetGo let_go;  // by this rank
  double initial_energy = 0.0, initial_internal = 0.0, initial_mass = 0.0;  // [J], [J] part of it, [kg]
  double initial_chemical = 0.0;  // part of the initial internal energy that laws hold back [J]
  Vec3 initial_momentum;
  double smallest_reference = 1e-300;  // of the balance error [J]
  double momentum_quantum = 1.0, mass_quantum = 1.0;

  std::int64_t energy_quanta(const Model& model, double joule) const;
  std::int64_t momentum_quanta(double v) const;
  /// Completes a balance from the terms that are sums over elements and accounts. Collective.
  void close(const Model& model, Balance& balance) const;
  /// Contact stores nothing, and hourglass control no more than it was given: what they give to the nodes beyond what
  /// they have taken counts as an error of the balance.
  void judge(Balance& balance);

 private:
  /// What errors are compared with: with neither energy nor work, the elastic energy of a strain of a thousandth [J].
  double reference(const Balance& balance) const;
};

}  // namespace kerf
