// The view of observers, from the stores of the model.
#include "report/observed_model.hpp"

#include <fmt/format.h>

#include <bit>
#include <cmath>
#include <limits>
#include <utility>

#include "model/joining.hpp"
#include "parallel/communicator.hpp"
#include "report/field_values.hpp"

namespace kerf {

namespace {

constexpr double nothing = std::numeric_limits<double>::quiet_NaN();

template <class Field>
std::vector<ObservedColumn> columns_named(const Field& field) {
  std::vector<ObservedColumn> columns;
  for (const std::string& name : component_names(field.name, field.n_components))
    columns.push_back({name, field.unit, field.doc});
  return columns;
}

const NodeField& require_node_field(const std::string& name) {
  const NodeField* field = find_node_field(name);
  if (field == nullptr) throw std::runtime_error("there is no node field \"" + name + "\"");
  return *field;
}

}  // namespace

SimulationView::SimulationView(Simulation& simulation)
    : simulation_(simulation), meeting_(simulation.model().comm), listed_(simulation.model().parts.size()) {
  for (const PartModel& part : simulation.model().parts) {
    std::vector<std::string> kept;
    for (const Law* law : part.material->laws())
      for (const StateVariable& v : law->state_variables()) kept.push_back(v.name);
    parts.push_back({part.input->name, &part.store->shape(), part.n_elements, part.initial_mass, part.material->density,
                     part.initial_energy, part.body, std::move(kept)});
  }
}

void SimulationView::refresh(double at_time, double of_step, std::int64_t at_cycle) {
  time = at_time;
  dt = of_step;
  cycle = at_cycle;
  kinetic_known_ = contact_known_ = loads_known_ = shares_known_ = false;
  const Model& model = simulation_.model();
  const NodeStore& n = model.nodes;
  nodes = {.n = n.n(),
           .id = n.id.data(),
           .part = n.part.data(),
           .owned = n.owned.data(),
           .free = n.free.data(),
           .mass = n.mass.data(),
           .position = n.position.data(),
           .velocity = n.velocity.data(),
           .force_quanta = n.force.data(),
           .force_quantum = model.quanta.force.quantum};
  list_elements();
}

void SimulationView::list_elements() {
  const Model& model = simulation_.model();
  bool changed = node_arrangement_ != model.node_arrangement();
  node_arrangement_ = model.node_arrangement();
  for (std::size_t p = 0; p < listed_.size(); ++p) {
    const PartStore& s = *model.parts[p].store;
    Listed& list = listed_[p];
    if (list.arrangement == s.arrangement()) continue;
    changed = true;
    list.arrangement = s.arrangement();
    list.ids.clear();
    list.slots.clear();
    for (int slot = 0; slot < s.n_slots(); ++slot) {
      if (!s.live(slot)) continue;
      list.ids.push_back(s.id(slot));
      list.slots.push_back(slot);
    }
  }
  if (changed) ++number_;
}

std::size_t SimulationView::index(int part) const {
  if (part < 0 || part >= static_cast<int>(listed_.size()))
    throw std::runtime_error(fmt::format("there is no part number {}", part));
  return static_cast<std::size_t>(part);
}

int SimulationView::slot(int part, int i) const { return listed_[index(part)].slots.at(static_cast<std::size_t>(i)); }

Vec3 SimulationView::reference(int node) const { return simulation_.model().nodes.reference_position(node); }

bool SimulationView::belongs_to(int node, int part) const { return simulation_.model().belongs_to(node, part); }

std::span<const double> SimulationView::kinetic_energy() {
  if (!kinetic_known_) kinetic_ = simulation_.kinetic_energies();
  kinetic_known_ = true;
  return kinetic_;
}

std::span<const Vec3> SimulationView::contact_force() {
  if (std::exchange(contact_known_, true)) return contact_force_;
  const ContactLoad& load = simulation_.contact_load();
  return contact_force_ = on_nodes(load.nodes, load.force);
}

std::span<const Vec3> SimulationView::load_force() {
  if (std::exchange(loads_known_, true)) return load_force_;
  const ExternalLoad& load = simulation_.external_load();
  return load_force_ = on_nodes(load.nodes, load.force);
}

/// Forces of some nodes [force quanta], spread to a list of all nodes of this rank [N].
std::vector<Vec3> SimulationView::on_nodes(const std::vector<std::int32_t>& which,
                                           const std::vector<std::int64_t>& force) const {
  std::vector<Vec3> all(static_cast<std::size_t>(nodes.n));
  for (std::size_t k = 0; k < which.size(); ++k)
    all[static_cast<std::size_t>(which[k])] =
        Vec3{static_cast<double>(force[4 * k]), static_cast<double>(force[4 * k + 1]),
             static_cast<double>(force[4 * k + 2])} *
        nodes.force_quantum;
  return all;
}

std::int32_t SimulationView::element_node(int part, int i, int k) const { return store(part).node(slot(part, i), k); }

int SimulationView::n_components(const std::string& field) const {
  const ElementField* known = find_element_field(field);
  return known == nullptr ? 1 : known->n_components;
}

std::vector<ObservedColumn> SimulationView::columns_of_field(const std::string& name) const {
  if (const ElementField* known = find_element_field(name)) return columns_named(*known);
  for (const PartModel& part : simulation_.model().parts) {
    const auto [place, component] = part.store->find_variable(name);
    if (place == PartStore::n_fields) continue;
    const StateVariable& v = part.store->field(place).components[static_cast<std::size_t>(component)];
    return {{name, v.unit, v.doc}};
  }
  return {{name, "-", "no part has this field"}};
}

std::vector<ObservedColumn> SimulationView::columns_of_node_field(const std::string& name) const {
  return columns_named(require_node_field(name));
}

std::vector<double> SimulationView::field(int part, const std::string& name) const {
  const FieldOfPart field(store(part), name, nothing);
  std::vector<double> values(listed_[index(part)].ids.size() * static_cast<std::size_t>(field.n_components()));
  field.of_all(values.data());
  return values;
}

std::vector<double> SimulationView::field_of(int part, int i, const std::string& name) const {
  const FieldOfPart field(store(part), name, nothing);
  std::vector<double> values(static_cast<std::size_t>(field.n_components()));
  field.of_slot(slot(part, i), values.data());
  return values;
}

std::vector<double> SimulationView::node_field(int node, const std::string& name) const {
  const NodeField* field = &require_node_field(name);
  const NodeStore& n = simulation_.model().nodes;
  const auto i = static_cast<std::size_t>(node);
  std::vector<double> values(static_cast<std::size_t>(field->n_components));
  field->fill({reference(node), n.x(node), n.v(node), n.mass[i]}, values.data());
  return values;
}

std::vector<double> SimulationView::mass_in(int part) {
  const auto place = static_cast<std::int32_t>(index(part));  // throws before the ranks meet
  meeting_.come_to(MeetingPoint::mass_in);
  const Model& model = simulation_.model();
  const NodeStore& n = model.nodes;
  const auto is_shared = [&](int i) { return model.memberships.is_shared(n.membership[i]); };
  if (!std::exchange(shares_known_, true) && model.has_joined_parts()) {
    std::vector<std::int64_t> shared;
    for (int i = 0; i < n.n(); ++i)
      if (n.owned[i] && is_shared(i)) shared.push_back(n.id[i]);
    shares_ = shares_of(model, shared);
  }
  std::vector<double> masses(static_cast<std::size_t>(n.n()), 0.0);
  for (int i = 0; i < n.n(); ++i)
    if (n.owned[i] && n.part[i] == place && !is_shared(i)) masses[static_cast<std::size_t>(i)] = n.mass[i];
  for (const NodeShare& s : shares_) {
    const std::int32_t i = model.local_node(s.node);
    if (s.part == place && n.mass[i] > 0.0) masses[static_cast<std::size_t>(i)] = s.mass;
  }
  return masses;
}

std::vector<double> SimulationView::sums(const std::vector<std::span<const double>>& lists) {
  return meeting_.add_up(lists);
}

std::vector<double> SimulationView::greatest(std::vector<double> values) {
  return meeting_.greatest_of(std::move(values));
}

std::vector<double> SimulationView::least(std::vector<double> values) { return meeting_.least_of(std::move(values)); }

std::pair<double, std::int64_t> SimulationView::nearest(double value, std::int64_t id) {
  meeting_.come_to(MeetingPoint::nearest);
  const MPI_Comm comm = simulation_.model().comm;
  if (std::isnan(value)) value = std::numeric_limits<double>::infinity();
  const double least = kerf::least(comm, value);
  constexpr std::int64_t none = std::numeric_limits<std::int64_t>::max();
  const std::int64_t first = -kerf::greatest(comm, value == least && std::isfinite(value) ? -id : -none);
  return {least, first == none ? -1 : first};
}

std::vector<double> SimulationView::from_holder(bool mine, std::vector<double> values) {
  meeting_.come_to(MeetingPoint::from_holder);
  // Whole numbers carry the bits: all ranks but one add zero.
  std::vector<std::int64_t> bits(values.size() + 1, 0);
  bits.back() = mine ? 1 : 0;
  for (std::size_t i = 0; i < values.size() && mine; ++i) bits[i] = std::bit_cast<std::int64_t>(values[i]);
  MPI_Allreduce(MPI_IN_PLACE, bits.data(), static_cast<int>(bits.size()), MPI_INT64_T, MPI_SUM,
                simulation_.model().comm);
  if (bits.back() > 1) throw std::runtime_error("from_holder: more than one rank has passed values");
  for (std::size_t i = 0; i < values.size(); ++i)
    values[i] = bits.back() == 1 ? std::bit_cast<double>(bits[i]) : nothing;
  return values;
}

std::vector<ObservedReaction> SimulationView::reactions() {
  meeting_.come_to(MeetingPoint::reactions);
  const SideBooks& books = simulation_.side_books();
  if (!books.keeps_reactions() && !simulation_.model().input->boundaries.empty())
    throw std::runtime_error("reactions() was called, but calls() did not ask for reactions");
  std::vector<ObservedReaction> all;
  const double q = simulation_.ledger().momentum_quantum;
  for (const SideBooks::Reaction& r : books.reactions(simulation_.model())) {
    const std::size_t place = all.size();
    const Vec3 impulse{static_cast<double>(r.impulse[0]), static_cast<double>(r.impulse[1]),
                       static_cast<double>(r.impulse[2])};
    all.push_back({fmt::format("{}_{}", simulation_.model().input->boundaries[place]->type, place + 1), impulse * q,
                   static_cast<double>(r.work) * simulation_.model().quanta.energy});
  }
  return all;
}

std::vector<ObservedContact> SimulationView::contacts() {
  meeting_.come_to(MeetingPoint::contacts);
  const Model& model = simulation_.model();
  const SideBooks& books = simulation_.side_books();
  if (!books.keeps_contacts() && !model.input->contacts.empty())
    throw std::runtime_error("contacts() was called, but calls() did not ask for contacts");
  const auto vector = [](const std::array<std::int64_t, 3>& q, double quantum) {
    return Vec3{static_cast<double>(q[0]), static_cast<double>(q[1]), static_cast<double>(q[2])} * quantum;
  };
  const auto totals = books.contacts(model);
  const auto forces = books.contact_forces(model);
  const auto work = books.contact_work(model, simulation_.next_step(), simulation_.ledger());
  std::vector<ObservedContact> all;
  for (std::size_t k = 0; k < totals.size(); ++k) {
    ObservedContact c;
    c.name = fmt::format("{}_{}", model.input->contacts[k]->type, k + 1);
    c.work = work[k].work;
    c.friction_work = work[k].friction;
    for (std::size_t p = 0; p < model.parts.size(); ++p) {
      c.force.push_back(vector(forces[k][p], model.quanta.force.quantum));
      c.impulse.push_back(vector(totals[k].impulse[p], simulation_.ledger().momentum_quantum));
    }
    all.push_back(std::move(c));
  }
  return all;
}

}  // namespace kerf
