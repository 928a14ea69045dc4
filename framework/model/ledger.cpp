// Opening and closing of the books.
#include "model/ledger.hpp"

#include <algorithm>
#include <cmath>

#include "core/fixed_sum.hpp"
#include "model/held_energy.hpp"
#include "parallel/communicator.hpp"

namespace kerf {

namespace {

/// Of all live elements of this rank [J].
std::vector<double> held_energies(const Model& model) {
  std::vector<double> all;
  for (const PartModel& part : model.parts)
    for (int s = 0; holds_energy(part) && s < part.store->n_slots(); ++s)
      if (part.store->live(s)) all.push_back(held_energy(part, s));
  return all;
}

}  // namespace

std::int64_t Ledger::energy_quanta(const Model& model, double joule) const {
  const double q = joule * model.quanta.per_energy;
  return std::fabs(q) < 0x1p62 ? std::llrint(q) : (q > 0.0 ? INT64_MAX / 2 : INT64_MIN / 2);
}

std::int64_t Ledger::momentum_quanta(double v) const { return std::llrint(v / momentum_quantum); }

void Ledger::open(Model& model) {
  std::vector<double> kinetic, px, py, pz, mass, stiff;
  const NodeStore& nodes = model.nodes;
  for (int i = 0; i < nodes.n(); ++i) {
    if (!nodes.owned[i]) continue;
    const Vec3 v = nodes.v(i);
    mass.push_back(nodes.mass[i]);
    kinetic.push_back(0.5 * nodes.mass[i] * dot(v, v));
    px.push_back(nodes.mass[i] * v.x);
    py.push_back(nodes.mass[i] * v.y);
    pz.push_back(nodes.mass[i] * v.z);
    const PartModel& part = model.parts[nodes.part[i]];
    stiff.push_back(nodes.mass[i] * (part.bulk_modulus + 4.0 / 3.0 * part.shear_modulus) / part.material->density);
  }
  std::vector<double> internal;
  for (const PartModel& part : model.parts)
    for (int s = 0; s < part.store->n_slots(); ++s)
      if (part.store->live(s))
        internal.push_back(part.store->field(PartStore::internal_energy).at(s, 0) +
                           part.initial_energy * part.store->field(PartStore::mass).at(s, 0));
  initial_internal = order_free_sum(model.comm, internal);
  initial_chemical = order_free_sum(model.comm, held_energies(model));
  initial_energy = order_free_sum(model.comm, kinetic) + initial_internal;
  initial_momentum = {order_free_sum(model.comm, px), order_free_sum(model.comm, py), order_free_sum(model.comm, pz)};
  initial_mass = order_free_sum(model.comm, mass);
  // A run that starts at rest is scaled by what its material could store: accounts hold up to 2048 times the scale,
  // which is twice the energy of a strain of one, and resolve the energy of a strain of a billionth.
  const double elastic = order_free_sum(model.comm, stiff);
  const double scale = std::max(std::fabs(initial_energy), 1e-3 * elastic);
  smallest_reference = std::fabs(initial_energy) > 0.0 ? 1e-300 : 1e-6 * elastic;
  model.quanta.energy = power_of_two_above(scale) * 0x1p-51;
  model.quanta.per_energy = 1.0 / model.quanta.energy;
  momentum_quantum = power_of_two_above(std::sqrt(2.0 * initial_mass * scale)) * 0x1p-51;
  mass_quantum = power_of_two_above(initial_mass) * 0x1p-51;
  model.quanta.mass = mass_quantum;
}

void Ledger::close(const Model& model, Balance& b) const {
  // Entries of empty slots stay zero.
  std::size_t n = 0, at = 0;
  for (const PartModel& part : model.parts) n += static_cast<std::size_t>(part.store->n_slots());
  std::vector<double> internal(n), viscous(n), mass(n);
  for (const PartModel& part : model.parts) {
    const PartStore& store = *part.store;
    const double* total = store.field(PartStore::internal_energy).data.data();  // of one component: slot by slot
    const double* q = store.field(PartStore::viscous_energy).data.data();
    const double* m = store.field(PartStore::mass).data.data();
    for (int s = 0; s < store.n_slots(); ++s, ++at) {
      const bool live = store.live(s);
      viscous[at] = live ? q[s] : 0.0;
      internal[at] = live ? total[s] - q[s] + part.initial_energy * m[s] : 0.0;
      mass[at] = live ? m[s] : 0.0;
    }
  }
  AccountNumbers numbers = numbers_of(accounts);
  MPI_Allreduce(MPI_IN_PLACE, numbers.data(), static_cast<int>(numbers.size()), MPI_INT64_T, MPI_SUM, model.comm);
  const Accounts all = b.totals = accounts_of(numbers);
  const std::vector<double> chemical = held_energies(model);
  const std::vector<double> totals = order_free_sums(model.comm, {internal, viscous, mass, chemical});
  b.energy_quantum = model.quanta.energy;
  b.initial = initial_energy;
  b.internal = totals[0] - totals[3];
  b.chemical = totals[3];
  b.eroded_chemical = b.joule(all.eroded_chemical);
  b.released = initial_chemical - b.chemical - b.eroded_chemical;
  b.bulk_viscosity = totals[1] + b.joule(all.eroded_viscous);
  b.hourglass = b.joule(all.hourglass);
  b.eroded = b.joule(all.eroded_internal + all.dropped_kinetic);
  const auto vector = [](const std::array<std::int64_t, 3>& q) {
    return Vec3{static_cast<double>(q[0]), static_cast<double>(q[1]), static_cast<double>(q[2])};
  };
  b.impulse = vector(all.impulse) * momentum_quantum;
  b.dropped_momentum = vector(all.dropped_momentum) * momentum_quantum;
  b.dropped_mass = static_cast<double>(all.dropped_mass) * mass_quantum;
  b.eroded_elements = all.eroded_elements;
  b.live_mass = totals[2];
  b.free_mass = initial_mass - b.live_mass - b.dropped_mass;
  b.error = (b.total() - initial_energy - b.external) / reference(b);
  b.let_go = total_of(model.comm, let_go);
}

double Ledger::reference(const Balance& b) const {
  return std::max({std::fabs(initial_energy), std::fabs(b.external), smallest_reference});
}

void Ledger::judge(Balance& b) {
  b.given_back = std::max(0.0, b.friction - b.contact);
  b.hourglass_given_back = std::max(0.0, -b.hourglass);
  const double given = b.given_back + b.hourglass_given_back;
  b.error += std::copysign(given / reference(b), b.error);  // never against an error of the other kind
}

void LetGo::add(int part, std::int64_t mass_quanta, double depth, double time) {
  if (nodes == 0) first_time = time;
  ++nodes;
  mass += mass_quanta;
  deepest = std::max(deepest, depth);
  by_part.resize(std::max(by_part.size(), static_cast<std::size_t>(part) + 1), 0);
  ++by_part[static_cast<std::size_t>(part)];
}

LetGo total_of(MPI_Comm comm, const LetGo& mine) {
  LetGo all;
  // The negative of the first time, infinitely early where there is none, and the other things that are greatest.
  double most[3] = {mine.deepest, mine.nodes > 0 ? -mine.first_time : -1e300, static_cast<double>(mine.by_part.size())};
  MPI_Allreduce(MPI_IN_PLACE, most, 3, MPI_DOUBLE, MPI_MAX, comm);
  std::vector<std::int64_t> sums = mine.by_part;
  sums.resize(static_cast<std::size_t>(most[2]), 0);
  sums.push_back(mine.nodes);
  sums.push_back(mine.mass);
  MPI_Allreduce(MPI_IN_PLACE, sums.data(), static_cast<int>(sums.size()), MPI_INT64_T, MPI_SUM, comm);
  all.mass = sums.back();
  sums.pop_back();
  all.nodes = sums.back();
  sums.pop_back();
  all.by_part = sums;
  all.deepest = most[0];
  all.first_time = all.nodes > 0 ? -most[1] : 0.0;
  return all;
}

}  // namespace kerf
