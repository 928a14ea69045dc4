// Counting what single boundary conditions and contact definitions do.
#include "dynamics/side_books.hpp"

#include <mpi.h>

namespace kerf {

namespace {

Vec3 impulse_of(const Model& model, const std::int64_t* force, double kick_dt) {
  const double q = model.quanta.force.quantum * kick_dt;
  return {static_cast<double>(force[0]) * q, static_cast<double>(force[1]) * q, static_cast<double>(force[2]) * q};
}

}  // namespace

void SideBooks::keep_reactions(const Model& model) { reactions_.resize(model.input->boundaries.size()); }

void SideBooks::keep_contacts(const Model& model) {
  const std::size_t n = model.input->contacts.size();
  contacts_.resize(n);
  loads_.resize(n);
  velocity_before_.resize(n);
  for (Contact& c : contacts_) c.impulse.resize(model.parts.size());
}

void SideBooks::count_reaction(const Ledger& ledger, const Model& model, std::size_t boundary, double mass,
                               Vec3 free_flight, Vec3 left, Vec3 before, Vec3 after) {
  const Vec3 impulse = (left - free_flight) * mass;
  Reaction& r = reactions_[boundary];
  for (int d = 0; d < 3; ++d) r.impulse[d] += ledger.momentum_quanta(impulse[d]);
  r.work += ledger.energy_quanta(model, 0.5 * dot(impulse, before + after));
}

void SideBooks::take_contacts(const std::vector<std::unique_ptr<ContactEngine>>& contacts) {
  for (std::size_t k = 0; k < contacts_.size(); ++k) loads_[k] = contacts[k]->load();
}

void SideBooks::before_kick(const Model& model) {
  for (std::size_t k = 0; k < loads_.size(); ++k) {
    velocity_before_[k].clear();
    for (const std::int32_t node : loads_[k].nodes) velocity_before_[k].push_back(model.nodes.v(node));
  }
}

void SideBooks::after_kick(const Model& model, const Step& step, const Ledger& ledger) {
  for (std::size_t k = 0; k < loads_.size(); ++k) {
    const ContactLoad& load = loads_[k];
    for (std::size_t i = 0; i < load.nodes.size(); ++i) {
      const Vec3 impulse = impulse_of(model, &load.force[4 * i], step.kick_dt());
      const Vec3 by_friction = impulse_of(model, &load.friction[4 * i], step.kick_dt());
      const Vec3 mean = (velocity_before_[k][i] + model.nodes.v(load.nodes[i])) * 0.5;
      auto& on_part = contacts_[k].impulse[static_cast<std::size_t>(model.nodes.part[load.nodes[i]])];
      for (int d = 0; d < 3; ++d) on_part[d] += ledger.momentum_quanta(impulse[d]);
      contacts_[k].work -= ledger.energy_quanta(model, dot(impulse, mean));
      contacts_[k].friction -= ledger.energy_quanta(model, dot(by_friction, mean));
    }
  }
}

std::vector<std::int64_t> SideBooks::numbers() const {
  std::vector<std::int64_t> all;
  for (const Reaction& r : reactions_) {
    all.insert(all.end(), r.impulse.begin(), r.impulse.end());
    all.push_back(r.work);
  }
  for (const Contact& c : contacts_) {
    all.push_back(c.work);
    all.push_back(c.friction);
    for (const auto& impulse : c.impulse) all.insert(all.end(), impulse.begin(), impulse.end());
  }
  return all;
}

std::vector<std::int64_t> SideBooks::totals(const Model& model) const {
  std::vector<std::int64_t> all = numbers();
  MPI_Allreduce(MPI_IN_PLACE, all.data(), static_cast<int>(all.size()), MPI_INT64_T, MPI_SUM, model.comm);
  return all;
}

bool SideBooks::restore(const std::vector<std::int64_t>& totals) {
  if (totals.size() != numbers().size()) return false;
  const std::int64_t* next = totals.data();
  for (Reaction& r : reactions_) {
    for (std::int64_t& i : r.impulse) i = *next++;
    r.work = *next++;
  }
  for (Contact& c : contacts_) {
    c.work = *next++;
    c.friction = *next++;
    for (auto& impulse : c.impulse)
      for (std::int64_t& i : impulse) i = *next++;
  }
  return true;
}

std::vector<SideBooks::Reaction> SideBooks::reactions(const Model& model) const {
  SideBooks all = *this;
  all.restore(totals(model));
  return all.reactions_;
}

std::vector<SideBooks::Contact> SideBooks::contacts(const Model& model) const {
  SideBooks all = *this;
  all.restore(totals(model));
  return all.contacts_;
}

std::vector<SideBooks::ContactWork> SideBooks::contact_work(const Model& model, const Step& next,
                                                            const Ledger& ledger) const {
  const double share = next.last_dt / (next.last_dt + next.dt);
  std::vector<std::int64_t> sums;  // done, and what the whole coming kick would do at the present velocities
  for (std::size_t k = 0; k < contacts_.size(); ++k) {
    std::int64_t coming = 0, coming_friction = 0;
    const ContactLoad& load = loads_[k];
    for (std::size_t i = 0; i < load.nodes.size(); ++i) {
      const Vec3 v = model.nodes.v(load.nodes[i]);
      coming -= ledger.energy_quanta(model, dot(impulse_of(model, &load.force[4 * i], next.kick_dt()), v));
      coming_friction -= ledger.energy_quanta(model, dot(impulse_of(model, &load.friction[4 * i], next.kick_dt()), v));
    }
    sums.insert(sums.end(), {contacts_[k].work, contacts_[k].friction, coming, coming_friction});
  }
  MPI_Allreduce(MPI_IN_PLACE, sums.data(), static_cast<int>(sums.size()), MPI_INT64_T, MPI_SUM, model.comm);
  std::vector<ContactWork> all;
  const auto joule = [&](std::size_t done, std::size_t coming) {
    return (static_cast<double>(sums[done]) + share * static_cast<double>(sums[coming])) * model.quanta.energy;
  };
  for (std::size_t k = 0; k < contacts_.size(); ++k)
    all.push_back({joule(4 * k, 4 * k + 2), joule(4 * k + 1, 4 * k + 3)});
  return all;
}

std::vector<std::vector<std::array<std::int64_t, 3>>> SideBooks::contact_forces(const Model& model) const {
  std::vector<std::vector<std::array<std::int64_t, 3>>> forces(
      loads_.size(), std::vector<std::array<std::int64_t, 3>>(model.parts.size()));
  for (std::size_t k = 0; k < loads_.size(); ++k) {
    for (std::size_t i = 0; i < loads_[k].nodes.size(); ++i)
      for (int d = 0; d < 3; ++d)
        forces[k][static_cast<std::size_t>(model.nodes.part[loads_[k].nodes[i]])][d] += loads_[k].force[4 * i + d];
    MPI_Allreduce(MPI_IN_PLACE, forces[k].data(), static_cast<int>(3 * forces[k].size()), MPI_INT64_T, MPI_SUM,
                  model.comm);
  }
  return forces;
}

}  // namespace kerf
