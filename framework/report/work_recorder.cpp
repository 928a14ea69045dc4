// What ranks have to say about an interval, put together on rank 0.
#include "report/work_recorder.hpp"

#include <algorithm>
#include <cmath>
#include <map>
#include <numeric>

#include "core/diagnostics.hpp"
#include "output/collective.hpp"
#include "parallel/communicator.hpp"

namespace kerf {

namespace {

constexpr std::size_t n_corners = 8;

struct ElementFact {
  std::int64_t id = 0, nodes[n_corners] = {};
  double work = 0.0, loaded = 0.0;
};
struct NodeFact {
  std::int64_t id = 0;
  double position[3] = {};
};
struct SlaveFact {
  std::int64_t node = 0;
  double candidates = 0.0;
};
struct FacetFact {
  std::int64_t id = 0, nodes[4] = {};
};
struct PairFact {
  std::int64_t slave = 0, facet = 0, touches = 0;
};

/// The place of an id in a list of ids that is sorted, or -1.
std::int64_t place_in(const std::vector<std::int64_t>& sorted, std::int64_t id) {
  const auto at = std::lower_bound(sorted.begin(), sorted.end(), id);
  return at != sorted.end() && *at == id ? at - sorted.begin() : -1;
}

template <class Fact, class Id>
std::vector<std::int64_t> sort_by_id(std::vector<Fact>& facts, const Id& id) {
  std::sort(facts.begin(), facts.end(), [&](const Fact& a, const Fact& b) { return id(a) < id(b); });
  facts.erase(std::unique(facts.begin(), facts.end(), [&](const Fact& a, const Fact& b) { return id(a) == id(b); }),
              facts.end());
  std::vector<std::int64_t> ids;
  for (const Fact& f : facts) ids.push_back(id(f));
  return ids;
}

/// Every slave once, with the candidates that it has in all definitions. Returns their nodes.
std::vector<std::int64_t> join_slaves(std::vector<SlaveFact>& slaves) {
  std::map<std::int64_t, double> candidates;
  for (const SlaveFact& s : slaves) candidates[s.node] += s.candidates;
  slaves.clear();
  std::vector<std::int64_t> nodes;
  for (const auto& [node, n] : candidates) {
    slaves.push_back({node, n});
    nodes.push_back(node);
  }
  return nodes;
}

/// Shares of a total in proportion to weights; equal ones where no weight is positive.
std::vector<double> shares_of(double total, const std::vector<double>& weights) {
  const double sum = std::accumulate(weights.begin(), weights.end(), 0.0);
  std::vector<double> shares(weights.size(), weights.empty() ? 0.0 : total / static_cast<double>(weights.size()));
  if (sum > 0.0)
    for (std::size_t i = 0; i < weights.size(); ++i) shares[i] = total * weights[i] / sum;
  return shares;
}

constexpr std::size_t elements = TimerName("elements").index(), nodes = TimerName("nodes").index(),
                      contact_search = TimerName("contact_search").index(),
                      contact_forces = TimerName("contact_forces").index(), loads = TimerName("loads").index(),
                      erosion = TimerName("erosion").index();

/// Of all definitions.
ContactEngine::Counts searches_of(const Simulation& simulation) {
  ContactEngine::Counts all;
  for (const auto& c : simulation.contacts()) {
    all.searches += c->counts().searches;
    all.renewals += c->counts().renewals;
    all.refreshes += c->counts().refreshes;
  }
  return all;
}

ContactEngine::Renewed renewed_of(const Simulation& simulation) {
  ContactEngine::Renewed all;
  for (const auto& c : simulation.contacts()) {
    all.nodes += c->renewed().nodes;
    all.all += c->renewed().all;
  }
  return all;
}

/// The share of nodes that get new boxes at a renewal. Collective.
double renewed_share(const Simulation& simulation, const ContactEngine::Renewed& begun) {
  const ContactEngine::Renewed now = renewed_of(simulation);
  std::int64_t sums[2] = {now.nodes - begun.nodes, now.all - begun.all};
  MPI_Allreduce(MPI_IN_PLACE, sums, 2, MPI_INT64_T, MPI_SUM, simulation.model().comm);
  return sums[1] > 0 ? static_cast<double>(sums[0]) / static_cast<double>(sums[1]) : 0.0;
}

/// The share of contact definitions that have friction.
double friction_of(const Simulation& simulation) {
  double n = 0.0;
  for (const auto& c : simulation.contacts()) n += c->has_friction() ? 1.0 : 0.0;
  return simulation.contacts().empty() ? 0.0 : n / static_cast<double>(simulation.contacts().size());
}

}  // namespace

WorkRecorder::WorkRecorder(const std::string& path, const std::string& source, double interval, bool resume,
                           const Simulation& simulation)
    : source_(source), interval_(interval) {
  for (const PartModel& part : simulation.model().parts) {
    if (part.store->n_nodes() != static_cast<int>(n_corners))
      throw InputError({part.input->element->origin + ": error: a recording of work knows hexahedra only; take " +
                        "output.recording_interval out, or expected elements of eight nodes"});
    record_bytes_ = std::max(record_bytes_, static_cast<std::int64_t>(part.store->record_size() * sizeof(double)));
  }
  open(path, resume, simulation);
  begin(simulation);
}

void WorkRecorder::open(const std::string& path, bool resume, const Simulation& simulation) {
  const MPI_Comm comm = simulation.model().comm;
  on_root(comm, [&] {
    if (!resume) {
      file_ = RecordingFile::create(path);
      return;
    }
    const std::int64_t cycle = simulation.clock().cycle();
    file_ = RecordingFile::resume(path, cycle);
    node_seconds_ = file_.node_seconds();
    node_cycles_ = file_.node_cycles();
    if (const std::int64_t next = file_.next_cycle(); next <= cycle)
      gap_ = "warning: " + path + " has no record of the cycles " + std::to_string(next) + " to " +
             std::to_string(cycle) + ", before this start; a prediction does not count them";
  });
  broadcast_text(comm, gap_);
}

/// Of all ranks [s]. Collective.
WorkRecorder::Work WorkRecorder::work_of(const Simulation& simulation) {
  Work work{};
  for (std::size_t k = 0; k < work.size(); ++k) {
    const Timers::Time& t = simulation.timers().all()[k];
    work[k] = t.total - t.in_messages;
  }
  MPI_Allreduce(MPI_IN_PLACE, work.data(), static_cast<int>(work.size()), MPI_DOUBLE, MPI_SUM, simulation.model().comm);
  return work;
}

void WorkRecorder::begin(const Simulation& simulation) {
  moment_ = {};
  moment_.cycle = simulation.clock().cycle() + 1;
  moment_.time = simulation.clock().time();
  moment_.agreements = static_cast<double>(std::max<std::size_t>(simulation.contacts().size(), 1) - 1);
  moment_.friction = friction_of(simulation);
  n_rounds_ = 0;
  eroded_.clear();
  searches_begun_ = searches_of(simulation);
  renewed_begun_ = renewed_of(simulation);
  gather_elements(simulation);
  knows_contact_ = false;
  begun_ = work_of(simulation);
}

/// Live elements and all nodes, numbered anew in the order of their ids.
void WorkRecorder::gather_elements(const Simulation& simulation) {
  const Model& model = simulation.model();
  std::vector<ElementFact> element_facts;
  for (const PartModel& part : model.parts) {
    const PartStore& store = *part.store;
    const Field& loaded = store.field(PartStore::loaded_faces);
    for (int s = 0; s < store.n_slots(); ++s) {
      if (!store.live(s)) continue;
      ElementFact& f = element_facts.emplace_back();
      f.id = store.id(s);
      for (std::size_t k = 0; k < n_corners; ++k) f.nodes[k] = model.nodes.id[store.node(s, static_cast<int>(k))];
      f.work = part.work;
      for (int c = 0; c < loaded.n_components; ++c) f.loaded += loaded.at(s, c) != 0.0 ? 1.0 : 0.0;
    }
  }
  std::vector<NodeFact> node_facts;
  for (int i = 0; i < model.nodes.n(); ++i) {
    if (!model.nodes.owned[i] || !(model.nodes.mass[i] > 0.0)) continue;
    const Vec3 x = model.nodes.x(i);
    node_facts.push_back({model.nodes.id[i], {x.x, x.y, x.z}});
  }
  element_facts = gather_to_root(model.comm, element_facts);
  node_facts = gather_to_root(model.comm, node_facts);
  moment_.element = sort_by_id(element_facts, [](const ElementFact& f) { return f.id; });
  moment_.node = sort_by_id(node_facts, [](const NodeFact& f) { return f.id; });
  for (const NodeFact& f : node_facts)
    moment_.points.insert(moment_.points.end(), std::begin(f.position), std::end(f.position));
  element_work_.clear();
  element_loads_.clear();
  for (const ElementFact& f : element_facts) {
    for (const std::int64_t n : f.nodes) moment_.cells.push_back(place_in(moment_.node, n));
    element_work_.push_back(f.work);
    element_loads_.push_back(f.loaded);
    moment_.n_loads += std::llrint(f.loaded);
  }
}

/// The pairs of all definitions, by nodes of the beginning: none can have joined since. A node or a facet that several
/// definitions or ranks look at is there once.
void WorkRecorder::gather_contact(const Simulation& simulation) {
  knows_contact_ = true;
  gather_reaches(simulation);
  std::vector<SlaveFact> slaves;
  std::vector<FacetFact> facets;
  std::vector<PairFact> pairs;
  for (const auto& c : simulation.contacts()) {
    if (!c->has_candidates()) continue;
    const Candidates& found = c->candidates();
    std::vector<std::int64_t> touching;  // slave's node times the number of facets, plus the facet
    const auto n_facets = static_cast<std::int64_t>(found.facet_id.size());
    for (const ContactTouch& t : c->touches().touches()) touching.push_back(t.node * n_facets + t.facet);
    std::sort(touching.begin(), touching.end());
    for (const std::int64_t node : c->slave_ids(simulation.model())) slaves.push_back({node, 0.0});
    for (std::size_t row = 0; row < found.slave.size(); ++row) {
      const auto [begin, end] = found.candidates[row];
      const std::int64_t node = found.node_id[found.slave[row]];
      slaves.push_back({node, static_cast<double>(end - begin)});
      for (std::int32_t k = begin; k < end; ++k) {
        const std::int32_t facet = found.candidate[k];
        const bool touches = std::binary_search(touching.begin(), touching.end(), found.slave[row] * n_facets + facet);
        pairs.push_back({node, found.facet_id[facet], touches ? 1 : 0});
      }
    }
    std::vector<std::int32_t> used;  // the list holds facets that are gone, too
    for (const ContactRow& row : found.candidates)
      used.insert(used.end(), found.candidate.begin() + row.begin, found.candidate.begin() + row.end);
    std::sort(used.begin(), used.end());
    used.erase(std::unique(used.begin(), used.end()), used.end());
    for (const auto f : used) {
      FacetFact& fact = facets.emplace_back();
      fact.id = found.facet_id[f];
      for (std::size_t k = 0; k < 4; ++k)
        fact.nodes[k] = found.node_id[found.facet_nodes[4 * static_cast<std::size_t>(f) + k]];
    }
  }
  const MPI_Comm comm = simulation.model().comm;
  slaves = gather_to_root(comm, slaves);
  facets = gather_to_root(comm, facets);
  pairs = gather_to_root(comm, pairs);
  const std::vector<std::int64_t> slave_ids = join_slaves(slaves);
  std::sort(pairs.begin(), pairs.end(), [](const PairFact& a, const PairFact& b) {
    return a.slave != b.slave ? a.slave < b.slave : a.facet < b.facet;
  });
  const std::vector<std::int64_t> facet_ids = sort_by_id(facets, [](const FacetFact& f) { return f.id; });
  slave_candidates_.clear();
  for (const SlaveFact& s : slaves) {
    moment_.slaves.push_back(place_in(moment_.node, s.node));
    slave_candidates_.push_back(s.candidates);
  }
  for (const FacetFact& f : facets)
    for (const std::int64_t n : f.nodes) moment_.facets.push_back(place_in(moment_.node, n));
  for (const PairFact& p : pairs) {
    moment_.pair_slave.push_back(place_in(slave_ids, p.slave));
    moment_.pair_facet.push_back(place_in(facet_ids, p.facet));
    moment_.pair_touches.push_back(static_cast<std::uint8_t>(p.touches));
  }
}

/// How far boxes reach: of slaves the farthest, of facets the mean, over all definitions and ranks.
void WorkRecorder::gather_reaches(const Simulation& simulation) {
  double farthest = 0.0, sums[2] = {};
  for (const auto& c : simulation.contacts()) {
    const ContactEngine::Spread spread = c->spread();
    farthest = std::max(farthest, spread.slave);
    sums[0] += spread.facets;
    sums[1] += static_cast<double>(spread.n_facets);
  }
  const MPI_Comm comm = simulation.model().comm;
  MPI_Allreduce(MPI_IN_PLACE, &farthest, 1, MPI_DOUBLE, MPI_MAX, comm);
  MPI_Allreduce(MPI_IN_PLACE, sums, 2, MPI_DOUBLE, MPI_SUM, comm);
  moment_.slave_reach = farthest;
  moment_.facet_reach = sums[1] > 0.0 ? std::max(sums[0] / sums[1], 0.0) : 0.0;
}

void WorkRecorder::count(const Simulation& simulation) {
  ++moment_.n_cycles;
  std::int64_t rounds = 0;
  for (const ContactPlan& plan : simulation.contact_plans()) rounds += plan.pace.rounds;
  n_rounds_ += rounds;
  if (!knows_contact_ && simulation.clock().time() >= moment_.time + 0.5 * interval_) gather_contact(simulation);
  if (!simulation.any_eroded()) return;
  moment_.n_eroding += 1.0;
  for (const ErosionRecord& r : simulation.eroded_now()) eroded_.push_back(r.element);
}

/// How often candidates were looked for in the interval. On rank 0.
void WorkRecorder::count_searches(const ContactEngine::Counts& now) {
  moment_.n_searches = static_cast<double>(now.searches - searches_begun_.searches);
  moment_.n_renewals = static_cast<double>(now.renewals - searches_begun_.renewals);
  moment_.n_refreshes = static_cast<double>(now.refreshes - searches_begun_.refreshes);
}

/// Distributes what the interval has cost over elements and slaves. On rank 0.
void WorkRecorder::add_costs(const Work& spent, std::int64_t n_nodes) {
  const auto n_cycles = static_cast<double>(moment_.n_cycles);
  moment_.element_seconds = shares_of(spent[elements] / n_cycles, element_work_);
  moment_.load_seconds = shares_of(spent[loads] / n_cycles, element_loads_);
  const std::vector<double> equal(element_work_.size(), 1.0);
  moment_.erosion_seconds = shares_of(moment_.n_eroding > 0.0 ? spent[erosion] / moment_.n_eroding : 0.0, equal);
  std::vector<double> search_work;
  for (const double n : slave_candidates_) search_work.push_back(1.0 + ContactEngine::candidate_work * n);
  // What is looked for in every cycle is counted to searches and renewals, and to all cycles where there are none.
  const double n_searches = moment_.n_searches + moment_.n_renewals;
  moment_.search_seconds = shares_of(spent[contact_search] / (n_searches > 0.0 ? n_searches : n_cycles), search_work);
  moment_.force_seconds = shares_of(spent[contact_forces] / n_cycles, slave_candidates_);
  node_seconds_ += spent[nodes];
  node_cycles_ += n_cycles * static_cast<double>(n_nodes);
}

/// As many of the elements that have died as die in one cycle with erosion. On rank 0.
void WorkRecorder::add_eroded(const std::vector<std::int64_t>& ids) {
  if (!(moment_.n_eroding > 0.0)) return;
  const double in_one = static_cast<double>(ids.size()) / moment_.n_eroding;
  const auto n = std::min(static_cast<std::size_t>(in_one + 0.5), ids.size());
  for (std::size_t k = 0; k < n; ++k) moment_.eroded.push_back(place_in(moment_.element, ids[k * ids.size() / n]));
}

void WorkRecorder::write(const Simulation& simulation) {
  if (moment_.n_cycles == 0) return;
  end(simulation);
  begin(simulation);
}

void WorkRecorder::finish(const Simulation& simulation) {
  if (moment_.n_cycles > 0) end(simulation);
  moment_ = {};
}

/// Adds the moment to the file.
void WorkRecorder::end(const Simulation& simulation) {
  if (!knows_contact_) gather_contact(simulation);
  Work spent = work_of(simulation);
  for (std::size_t k = 0; k < spent.size(); ++k) spent[k] = std::max(spent[k] - begun_[k], 0.0);
  moment_.renewed = renewed_share(simulation, renewed_begun_);
  const MPI_Comm comm = simulation.model().comm;
  std::vector<std::int64_t> eroded = gather_to_root(comm, eroded_);
  std::sort(eroded.begin(), eroded.end());  // the same on any number of ranks
  on_root(comm, [&] {
    moment_.rounds = static_cast<double>(n_rounds_) / static_cast<double>(moment_.n_cycles);
    count_searches(searches_of(simulation));
    add_costs(spent, static_cast<std::int64_t>(moment_.node.size()));
    add_eroded(eroded);
    file_.append(moment_, {node_seconds_ / node_cycles_, record_bytes_, source_});
  });
}

}  // namespace kerf
