// When a run that goes wrong is stopped: energy that comes from nowhere, nodes that race, nodes that contact lets go
// of.
#include <fmt/format.h>

#include <cmath>
#include <limits>

#include "core/physics_error.hpp"
#include "dynamics/simulation.hpp"
#include "model/names.hpp"
#include "parallel/communicator.hpp"

namespace kerf {

// A node that races is the more telling of the two: the energies it leads to may be no numbers any more.
void Simulation::check(const Balance& b) const {
  check_speeds(b.time);
  check_energy(b);
  const LetGo& l = b.let_go;
  if (!(static_cast<double>(l.mass) * ledger_.mass_quantum <= input_.checks.let_go * ledger_.initial_mass))
    throw PhysicsError(fmt::format(
        "contact has let go of {} nodes, which came to lie up to {:.4g} m inside a body, with more than checks.let_go "
        "({:.3g}) of the mass of the model, the first at time {:.6g} s; refine the mesh where bodies meet, or lower "
        "time.safety_factor; at time {:.6g} s, cycle {}",
        l.nodes, l.deepest, input_.checks.let_go, l.first_time, b.time, clock_.cycle()));
}

namespace {

struct Hottest {
  double energy = 0.0;  // [J/kg]
  std::int64_t id = -1;
};

/// The element that holds the most energy for its mass; of several the one with the lowest id. Collective.
Hottest hottest_element(const Model& model) {
  Hottest here{-std::numeric_limits<double>::infinity(), std::numeric_limits<std::int64_t>::max()};
  for (const PartModel& part : model.parts)
    for (int s = 0; s < part.store->n_slots(); ++s) {
      if (!part.store->live(s)) continue;
      double e = part.store->field(PartStore::internal_energy).at(s, 0) / part.store->field(PartStore::mass).at(s, 0);
      if (std::isnan(e)) e = std::numeric_limits<double>::infinity();
      const std::int64_t id = part.store->id(s);
      if (e > here.energy || (e == here.energy && id < here.id)) here = {e, id};
    }
  const double energy = greatest(model.comm, here.energy);
  const std::int64_t rival = here.energy == energy ? here.id : std::numeric_limits<std::int64_t>::max();
  return {energy, -greatest(model.comm, -rival)};
}

}  // namespace

void Simulation::check_energy(const Balance& b) const {
  if (!(std::fabs(b.error) <= input_.checks.energy_growth)) {
    // Where to look first.
    const Hottest hottest = hottest_element(model_);
    const bool any_left = hottest.id != std::numeric_limits<std::int64_t>::max();
    throw PhysicsError(fmt::format(
        "the energy balance is off by {:.2f} %, more than checks.energy_growth of {:.2f} %, at time {:.6g} s, cycle "
        "{}; "
        "the highest energy per mass, {:.4g} J/kg, is in {}",
        100.0 * b.error, 100.0 * input_.checks.energy_growth, b.time, clock_.cycle(), any_left ? hottest.energy : 0.0,
        any_left ? element_name(model_, hottest.id) : "no element, since none is left"));
  }
}

void Simulation::check_speeds(double time) const {
  double limit = input_.checks.maximum_speed;
  if (!(limit > 0.0))
    for (const PartModel& p : model_.parts)
      limit = std::max(limit, 100.0 * std::sqrt((p.bulk_modulus + 4.0 / 3.0 * p.shear_modulus) / p.material->density));
  std::string trouble;
  std::int64_t lowest = std::numeric_limits<std::int64_t>::max();
  bool fine = true;
  for (int i = 0; i < model_.nodes.n(); ++i) fine &= dot(model_.nodes.v(i), model_.nodes.v(i)) <= limit * limit;
  for (int i = 0; i < model_.nodes.n() && !fine; ++i) {
    if (dot(model_.nodes.v(i), model_.nodes.v(i)) <= limit * limit || !model_.nodes.owned[i]) continue;
    if (model_.nodes.id[i] >= lowest) continue;
    lowest = model_.nodes.id[i];
    trouble = fmt::format(
        "{} moves at {:.4g} m/s, faster than {:.4g} m/s, which is {}", node_name(model_, lowest),
        norm(model_.nodes.v(i)), limit,
        input_.checks.maximum_speed > 0.0
            ? "checks.maximum_speed"
            : "a hundred times the sound speed of the undeformed materials; give checks.maximum_speed where "
              "such speeds are meant");
  }
  const std::int64_t first = -greatest(model_.comm, -lowest);
  const std::string text = first_text(model_.comm, lowest == first ? trouble : std::string{});
  if (!text.empty()) throw PhysicsError(fmt::format("{} at time {:.6g} s, cycle {}", text, time, clock_.cycle()));
}

}  // namespace kerf
