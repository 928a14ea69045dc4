// Accounts for energy, momentum and mass: what was put in, what is there, what was taken out.
//
// Everything that is summed over time is kept in whole quanta, so that its total does not depend on which rank
// added what.
#pragma once

#include <mpi.h>

#include <array>
#include <cstdint>
#include <vector>

#include "kerf/math.hpp"
#include "model/model.hpp"
#include "model/step.hpp"

namespace kerf {

/// Sums over the run; additive over ranks.
struct Accounts {
  std::int64_t hourglass = 0;  // dissipated or stored by hourglass control [energy quanta]
  std::int64_t contact = 0;  // taken from the nodes by contact [energy quanta]
  std::int64_t friction = 0;  // the share of friction in it [energy quanta]
  std::int64_t external = 0;  // work of boundary conditions and loads [energy quanta]
  std::int64_t eroded_internal = 0;  // internal energy of eroded elements, without the viscous share
  std::int64_t eroded_viscous = 0;  // work of bulk viscosity in eroded elements
  std::int64_t dropped_kinetic = 0;  // of dropped free nodes
  std::array<std::int64_t, 3> impulse{};  // of boundary conditions and loads [momentum quanta]
  std::array<std::int64_t, 3> dropped_momentum{};  // [momentum quanta]
  std::int64_t dropped_mass = 0;  // [mass quanta]
  std::int64_t eroded_elements = 0;
};

/// Nodes that contact has let go of.
struct LetGo {
  std::int64_t nodes = 0, mass = 0;  // [mass quanta]
  std::vector<std::int64_t> by_part;
  double deepest = 0.0, first_time = 0.0;  // [m], [s]; 0 where there is none

  void add(int part, std::int64_t mass_quanta, double depth, double time);
  /// What all ranks have let go of together. Collective.
  LetGo total(MPI_Comm comm) const;
};

/// The state of the books at one time, the same on all ranks.
struct Balance {
  double time = 0.0;
  double kinetic = 0.0, internal = 0.0, hourglass = 0.0, bulk_viscosity = 0.0, contact = 0.0, external = 0.0,
         eroded = 0.0;  // [J]
  double friction = 0.0;  // the share of friction in contact [J]
  double given_back = 0.0;  // by contact, without friction, more than it has taken [J]
  double hourglass_given_back = 0.0;  // by hourglass control, more than it has taken [J]
  Vec3 momentum, impulse, dropped_momentum;  // [kg m/s]
  double live_mass = 0.0, free_mass = 0.0, dropped_mass = 0.0;  // [kg]
  std::int64_t eroded_elements = 0;
  LetGo let_go;
  double error = 0.0;

  double total() const { return kinetic + internal + hourglass + bulk_viscosity + contact + eroded; }
};

class Ledger {
 public:
  /// Fixes the quanta of energy, momentum and mass from the model at rest in time zero. Collective.
  void open(Model& model);

  Accounts accounts;
  LetGo let_go;  // by this rank
  double initial_energy = 0.0, initial_internal = 0.0, initial_mass = 0.0;  // [J], [J] part of it, [kg]
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
