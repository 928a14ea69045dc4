// State to and from the restart container.
#include "report/checkpoint.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <sstream>

#include "core/assert.hpp"
#include "core/diagnostics.hpp"
#include "model/migrator.hpp"
#include "output/restart.hpp"
#include "parallel/fetch_by_id.hpp"

namespace kerf {

namespace {

constexpr int n_node_integers = 12, n_node_reals = 10;  // of one node
constexpr int first_contact_force = 6;  // of these integers, six are the force and friction of contact

/// Force and friction of each owned node, six numbers one after another.
std::vector<std::int64_t> forces_of(const NodeStore& nodes, const ContactLoad& load) {
  std::vector<std::array<std::int64_t, 6>> of_node(static_cast<std::size_t>(nodes.n()));
  for (std::size_t k = 0; k < load.nodes.size(); ++k)
    for (std::size_t d = 0; d < 3; ++d) {
      of_node[static_cast<std::size_t>(load.nodes[k])][d] = load.force[4 * k + d];
      of_node[static_cast<std::size_t>(load.nodes[k])][3 + d] = load.friction[4 * k + d];
    }
  std::vector<std::int64_t> all;
  for (std::size_t i = 0; i < of_node.size(); ++i)
    if (nodes.owned[i] != 0) all.insert(all.end(), of_node[i].begin(), of_node[i].end());
  return all;
}

void write_observers(RestartWriter& file, const Simulation& simulation,
                     const std::vector<ObserverProgress>& observers) {
  std::string names;
  for (const ObserverProgress& o : observers) {
    names += o.name + "\n";
    file.write_attribute("observer_" + o.name, o.numbers);
  }
  if (!observers.empty()) file.write_attribute("observers", names);
  const std::vector<std::int64_t> books = simulation.side_books().totals(simulation.model());
  if (!books.empty()) file.write_attribute("side_books", books);
}

std::vector<ObserverProgress> read_observers(RestartReader& file) {
  std::vector<ObserverProgress> all;
  if (!file.has_attribute("observers")) return all;
  std::istringstream names(file.text("observers"));
  for (std::string name; std::getline(names, name);) all.push_back({name, file.reals("observer_" + name)});
  return all;
}

/// Throws InputError where the file has other books than the observers of this run read.
void read_side_books(RestartReader& file, const std::string& path, Simulation& simulation) {
  std::vector<std::int64_t> books;
  if (file.has_attribute("side_books")) books = file.integers("side_books");
  if (simulation.model().rank() != 0) std::fill(books.begin(), books.end(), 0);
  if (!simulation.side_books().restore(books))
    throw InputError(
        {fmt::format("{}: error: the run that wrote this file had other observers of contacts or "
                     "reactions; resume with the observers that the run began with",
                     path)});
}

void write_nodes(RestartWriter& file, Simulation& simulation) {
  const Model& model = simulation.model();
  const NodeStore& nodes = model.nodes;
  std::vector<std::int64_t> ids, integers;
  std::vector<double> reals;
  std::vector<std::int64_t> external, external_of_owned;  // three per node
  external.assign(3 * static_cast<std::size_t>(nodes.n()), 0);
  const ExternalLoad& loads = simulation.external_load();
  for (std::size_t k = 0; k < loads.nodes.size(); ++k)
    std::copy_n(&loads.force[4 * k], 3, &external[3 * static_cast<std::size_t>(loads.nodes[k])]);
  const std::vector<std::int64_t> contact = forces_of(nodes, simulation.contact_load());
  for (int i = 0; i < nodes.n(); ++i) {
    if (!nodes.owned[i]) continue;
    const NodeRecord r = nodes.record(i);
    ids.push_back(r.id);
    integers.insert(integers.end(), {r.membership, r.part, r.free, r.force[0], r.force[1], r.force[2]});
    const auto force = contact.begin() + 6 * static_cast<std::ptrdiff_t>(ids.size() - 1);
    integers.insert(integers.end(), force, force + 6);
    const auto at = external.begin() + 3 * static_cast<std::ptrdiff_t>(i);
    external_of_owned.insert(external_of_owned.end(), at, at + 3);
    reals.insert(reals.end(),
                 {r.position[0], r.position[1], r.position[2], r.velocity[0], r.velocity[1], r.velocity[2], r.mass});
    reals.insert(reals.end(), r.reference, r.reference + 3);
  }
  std::vector<RestartColumn> columns{{"integers", n_node_integers, integers.data()},
                                     {"reals", n_node_reals, reals.data()}};
  if (model.input->has_external_forces()) columns.push_back({"loads", 3, external_of_owned.data()});
  std::vector<std::vector<std::int64_t>> of_contact;  // forces of single definitions, where books of them are kept
  for (const ContactLoad& one : simulation.side_books().loads()) of_contact.push_back(forces_of(nodes, one));
  for (std::size_t k = 0; k < of_contact.size(); ++k)
    columns.push_back({fmt::format("contact_{}", k + 1), 6, of_contact[k].data()});
  file.write_entities("nodes", model.n_nodes, ids, columns);
}

void write_elements(RestartWriter& file, const Model& model) {
  for (const PartModel& part : model.parts) {
    const PartStore& store = *part.store;
    std::vector<std::int64_t> ids, nodes;
    std::vector<double> records;
    for (int s = 0; s < store.n_slots(); ++s) {
      if (!store.live(s)) continue;
      ids.push_back(store.id(s) - part.first_element);
      for (int k = 0; k < store.n_nodes(); ++k) nodes.push_back(model.nodes.id[store.node(s, k)]);
      const std::size_t at = records.size();
      records.resize(at + store.record_size());
      store.pack(s, records.data() + at);
    }
    file.write_entities("elements_" + part.input->name, part.n_elements, ids,
                        {{"nodes", store.n_nodes(), nodes.data()}, {"state", store.record_size(), records.data()}});
  }
}

std::vector<std::int64_t> total_accounts(const Model& model, const Accounts& a) {
  AccountNumbers numbers = numbers_of(a);
  MPI_Allreduce(MPI_IN_PLACE, numbers.data(), static_cast<int>(numbers.size()), MPI_INT64_T, MPI_SUM, model.comm);
  return {numbers.begin(), numbers.end()};
}

/// Accounts that are younger than the file begin with zero.
Accounts accounts_from(const std::vector<std::int64_t>& stored) {
  AccountNumbers numbers{};
  std::copy_n(stored.begin(), std::min(stored.size(), numbers.size()), numbers.begin());
  return accounts_of(numbers);
}

/// Hands every rank the records of the nodes that its elements need, by way of each node's home rank.
std::vector<NodeRecord> deliver(const Model& model, const std::vector<NodeRecord>& share,
                                std::vector<std::int64_t> wanted) {
  std::sort(wanted.begin(), wanted.end());
  wanted.erase(std::unique(wanted.begin(), wanted.end()), wanted.end());
  const Fetched<NodeRecord> fetched = fetch_by_id(model.comm, share, wanted);
  KERF_ASSERT(fetched.wanted.size() == wanted.size(), "the file has every node of its elements");
  std::vector<NodeRecord> result;
  for (const NodeRecord& n : fetched.at_home)
    if (n.free != 0) result.push_back(n);  // nobody asks for free nodes: they stay at home
  result.insert(result.end(), fetched.wanted.begin(), fetched.wanted.end());
  return result;
}

/// Contact forces of owned nodes as the file has them, for all ranks, because nobody knows yet who will own a node:
/// those that are not zero are few. `force(i)` is where the six numbers of node `i` of this rank's share stand.
/// Collective.
template <class Force>
ForceByNode spread(const Model& model, const std::vector<NodeRecord>& share, const Force& force) {
  struct Load {
    std::int64_t id, force[6];  // of contact, and of friction
  };
  std::vector<Load> loads;
  for (std::size_t i = 0; i < share.size(); ++i) {
    Load load{share[i].id, {}};
    std::copy_n(force(i), 6, load.force);
    if (load.force[0] != 0 || load.force[1] != 0 || load.force[2] != 0) loads.push_back(load);
  }
  ForceByNode by_node;
  for (const auto& list : all_to_all(model.comm, std::vector(static_cast<std::size_t>(model.n_ranks()), loads)))
    for (const Load& l : list) std::copy_n(l.force, 6, by_node[l.id].begin());
  return by_node;
}

/// `n_contacts`: definitions of which books are kept.
ModelBundle read_bundle(RestartReader& file, const Model& model, std::size_t n_contacts,
                        Simulation::Progress& progress) {
  ModelBundle bundle;
  bundle.parts.resize(model.parts.size());
  std::vector<std::int64_t> wanted;
  for (std::size_t p = 0; p < model.parts.size(); ++p) {
    const PartModel& part = model.parts[p];
    const RestartEntities e = file.read_entities("elements_" + part.input->name);
    const int n_nodes = part.store->n_nodes();
    const auto& nodes = e.integer("nodes", n_nodes);
    bundle.parts[p].records = e.real("state", part.store->record_size());
    for (std::size_t i = 0; i < e.gids.size(); ++i) {
      bundle.parts[p].ids.push_back(part.first_element + e.gids[i]);
      ElementNodeIds n{};
      std::copy_n(nodes.begin() + static_cast<std::ptrdiff_t>(i) * n_nodes, n_nodes, n.begin());
      wanted.insert(wanted.end(), n.begin(), n.begin() + n_nodes);
      bundle.parts[p].nodes.push_back(n);
    }
  }
  const RestartEntities e = file.read_entities("nodes");
  const auto& integers = e.integer("integers", n_node_integers);
  const auto& reals = e.real("reals", n_node_reals);
  std::vector<NodeRecord> share(e.gids.size());
  for (std::size_t i = 0; i < share.size(); ++i) {
    NodeRecord& r = share[i];
    const std::int64_t* k = &integers[n_node_integers * i];
    const double* real = &reals[n_node_reals * i];
    r.id = e.gids[i];
    r.membership = static_cast<std::int32_t>(k[0]);
    r.part = static_cast<std::int32_t>(k[1]);
    r.free = static_cast<std::int32_t>(k[2]);
    std::copy_n(k + 3, 3, r.force);
    std::copy_n(real, 3, r.position);
    std::copy_n(real + 3, 3, r.velocity);
    r.mass = real[6];
    std::copy_n(real + 7, 3, r.reference);
  }
  if (model.input->has_external_forces()) {
    const auto& external = e.integer("loads", 3);
    for (std::size_t i = 0; i < e.gids.size(); ++i) {
      const std::int64_t* f = &external[3 * i];
      if (f[0] != 0 || f[1] != 0 || f[2] != 0) progress.external_force.push_back({e.gids[i], {f[0], f[1], f[2]}});
    }
  }
  for (std::size_t c = 0; c < n_contacts; ++c) {
    const auto& forces = e.integer(fmt::format("contact_{}", c + 1), 6);
    progress.force_of_contact.push_back(spread(model, share, [&](std::size_t i) { return &forces[6 * i]; }));
  }
  progress.contact_force =
      spread(model, share, [&](std::size_t i) { return &integers[n_node_integers * i + first_contact_force]; });
  bundle.nodes = deliver(model, share, std::move(wanted));
  return bundle;
}

}  // namespace

void write_checkpoint(const std::string& path, const std::string& input_digest, Simulation& simulation,
                      const OutputProgress& output) {
  const Model& model = simulation.model();
  Simulation::Progress p = simulation.progress();
  p.element_cycles = sum_of(model.comm, p.element_cycles);
  RestartWriter file(model.comm, path);
  file.write_attribute("input_digest", input_digest);
  file.write_attribute("clock",
                       std::vector<double>{p.time, p.last_dt, p.reduction.least_step, p.first_stable, p.contact_step});
  file.write_attribute("counters", std::vector<std::int64_t>{p.cycle, p.last_rebalance, p.element_cycles,
                                                             p.reduction.least_id, output.n_frames});
  file.write_attribute("due", std::vector<double>{output.next_results, output.next_history, output.next_restart});
  file.write_attribute("eroded_by", output.eroded_by);
  file.write_attribute("accounts", total_accounts(model, simulation.ledger().accounts));
  const LetGo let_go = total_of(model.comm, simulation.ledger().let_go);
  std::vector<std::int64_t> let_go_counts{let_go.nodes, let_go.mass};
  let_go_counts.insert(let_go_counts.end(), let_go.by_part.begin(), let_go.by_part.end());
  file.write_attribute("let_go", let_go_counts);
  file.write_attribute("contact", std::vector<double>{let_go.deepest, let_go.first_time});
  std::vector<double> paces;
  for (const ImpactPace& pace : p.paces)
    paces.insert(paces.end(), {static_cast<double>(pace.rounds), pace.first_excess});
  if (!paces.empty()) file.write_attribute("contact_paces", paces);
  file.write_attribute("contact_impacts",
                       std::vector<std::int64_t>{p.impacts.steps, p.impacts.unsettled, p.impacts.at_limit});
  file.write_attribute("balance_policy", p.balance_policy.type);
  if (!p.balance_policy.numbers.empty()) file.write_attribute("balance_policy_state", p.balance_policy.numbers);
  file.write_attribute("plugin_files", "plugins:\n" + output.plugin_files);  // no attribute is empty
  write_observers(file, simulation, output.observers);
  write_nodes(file, simulation);
  write_elements(file, model);
  file.finish();
}

OutputProgress read_checkpoint(const std::string& path, const std::string& input_digest, Simulation& simulation) {
  Model& model = simulation.model();
  RestartReader file(model.comm, path);
  if (file.text("input_digest") != input_digest)
    throw InputError({fmt::format(
        "{}: error: this restart file belongs to another model; resume with the input that "
        "wrote it (precision, materials, parts, joined, sets, initial_state, boundaries, loads, curves with "
        "their files, contacts, checks, and time but for its end, must be the same)",
        path)});
  Simulation::Progress p;
  const auto clock = file.reals("clock");
  const auto counters = file.integers("counters");
  const auto due = file.reals("due");
  p.time = clock.at(0);
  p.last_dt = clock.at(1);
  p.reduction.least_step = clock.at(2);
  p.first_stable = clock.at(3);
  p.contact_step = clock.at(4);
  p.cycle = counters.at(0);
  p.last_rebalance = counters.at(1);
  if (file.has_attribute("balance_policy")) p.balance_policy.type = file.text("balance_policy");
  if (file.has_attribute("balance_policy_state")) p.balance_policy.numbers = file.reals("balance_policy_state");
  if (file.has_attribute("contact_paces")) {
    const auto paces = file.reals("contact_paces");
    for (std::size_t k = 0; k + 1 < paces.size(); k += 2) p.paces.push_back({static_cast<int>(paces[k]), paces[k + 1]});
  }
  if (file.has_attribute("contact_impacts")) {
    const auto impacts = file.integers("contact_impacts");
    p.impacts = {impacts.at(0), impacts.at(1), impacts.at(2)};
  }
  p.element_cycles = counters.at(2);
  p.reduction.least_id = counters.at(3);
  read_side_books(file, path, simulation);
  assemble(model, read_bundle(file, model, simulation.side_books().loads().size(), p));
  simulation.ledger().accounts = model.rank() == 0 ? accounts_from(file.integers("accounts")) : Accounts{};
  const auto taken = file.reals("contact");
  simulation.ledger().let_go = {};
  if (model.rank() == 0) {
    const auto counts = file.integers("let_go");
    simulation.ledger().let_go = {.nodes = counts.at(0),
                                  .mass = counts.at(1),
                                  .by_part = {counts.begin() + 2, counts.end()},
                                  .deepest = taken.at(0),
                                  .first_time = taken.at(1)};
  }
  simulation.resume(p);
  const bool knows = file.has_attribute("plugin_files");
  const std::string plugin_files = knows ? file.text("plugin_files").substr(std::string("plugins:\n").size()) : "";
  return {counters.at(4),       due.at(0),    due.at(1), due.at(2), file.integers("eroded_by"),
          read_observers(file), plugin_files, knows};
}

}  // namespace kerf
