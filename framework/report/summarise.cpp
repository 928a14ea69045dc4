// The summary of a run: totals, parts, measures, timers, and the table that closes the console output.
#include <fmt/format.h>

#include <algorithm>
#include <iterator>
#include <limits>

#include "core/assert.hpp"
#include "core/fixed_sum.hpp"
#include "kerf/measure.hpp"
#include "kerf/plugin.hpp"
#include "model/joining.hpp"
#include "parallel/communicator.hpp"
#include "report/measure_share.hpp"
#include "report/reporter.hpp"
#include "report/state_hash.hpp"

namespace kerf {

namespace {

std::array<double, 3> triple(Vec3 v) { return {v.x, v.y, v.z}; }

/// What elements have turned into heat by plastic flow: their internal energy, without what they started with and
/// without the bulk viscosity's share, less what they hold elastically and would give back. That is, with the
/// undeformed moduli, |s|^2 / (4 G) times the volume, and the work of compression from the pressure p0 that the
/// material started with, p0 (V0 - V) + (p - p0)^2 V / (2 K). A fluid gives back all that was done on it. Eroded
/// elements have taken with them what they held, less what they started with. Collective.
double dissipated_by_elements(const Model& model, double eroded) {
  std::vector<double> dissipated;
  double eroded_from_start = 0.0;
  for (const PartModel& part : model.parts) {
    const PartStore& store = *part.store;
    std::vector<double> mass;
    for (int s = 0; s < store.n_slots(); ++s) {
      if (!store.live(s)) continue;
      mass.push_back(store.field(PartStore::mass).at(s, 0));
      if (!(part.shear_modulus > 0.0)) continue;
      const auto field = [&](PartStore::FieldIndex f, int c = 0) { return store.field(f).at(s, c); };
      double square = 0.0;
      for (int c = 0; c < 6; ++c)
        square += (c < 3 ? 1.0 : 2.0) * field(PartStore::deviator, c) * field(PartStore::deviator, c);
      const double rise = field(PartStore::pressure) - part.initial_pressure, volume = field(PartStore::volume);
      double elastic = square / (4.0 * part.shear_modulus) * volume +
                       part.initial_pressure * (mass.back() / part.material->density - volume);
      if (part.bulk_modulus > 0.0) elastic += rise * rise / (2.0 * part.bulk_modulus) * volume;
      const double held = field(PartStore::internal_energy) - field(PartStore::viscous_energy);
      dissipated.push_back(std::max(held - std::max(elastic, 0.0), 0.0));
    }
    eroded_from_start += part.initial_energy * (part.initial_mass - order_free_sum(model.comm, mass));
  }
  return order_free_sum(model.comm, dissipated) + std::max(eroded - eroded_from_start, 0.0);
}

/// A sentence where hourglass control has taken more than a tenth of what was dissipated, and more than a hundredth of
/// what there was.
void warn_of_hourglass_share(Summary& s, const Balance& b) {
  const double present = std::max(b.initial, std::fabs(b.external));
  if (!(s.hourglass.share() > 0.1) || !(s.hourglass.energy > 0.01 * present)) return;
  s.warnings.push_back(fmt::format(
      "warning: hourglass control took {:.0f} % of all energy that was dissipated; expected less than 10 %: refine the "
      "mesh, spread concentrated loads, or choose another form of hourglass control or another hourglass_coefficient",
      100.0 * s.hourglass.share()));
}

/// A sentence for each law that has given more than a thousandth of what there was to the nodes.
void warn_of_gains(Summary& s, const Balance& b) {
  const double present = std::max(b.initial, std::fabs(b.external));
  if (b.given_back > 1e-3 * present)
    s.warnings.push_back(
        fmt::format("warning: contact has given {:.4g} J more to the nodes than it has taken, which is wrong by as "
                    "much; try a smaller "
                    "time.safety_factor, damping: 1, or cells of like size where bodies meet",
                    b.given_back));
  if (b.hourglass_given_back > 1e-3 * present)
    s.warnings.push_back(fmt::format(
        "warning: hourglass control has given {:.4g} J more to the nodes than it has taken, which is wrong by as much; "
        "choose hourglass: viscous for soft or badly deformed parts",
        b.hourglass_given_back));
}

/// A sentence where the balance of energy is open by more than a hundredth, which no sound run of the tests is.
void warn_of_balance(Summary& s, const Balance& b) {
  if (std::fabs(b.error) <= 0.01) return;
  s.warnings.push_back(
      fmt::format("warning: the energy balance is off by {:+.2g} % at the end; expected less than 1 %: try a smaller "
                  "time.safety_factor, and look in history.csv when it opened",
                  100.0 * b.error));
}

/// A sentence for each part of which nothing is left.
void warn_of_lost_parts(const Model& model, Summary& s) {
  for (const PartModel& part : model.parts)
    if (part.n_elements > 0 && sum_of(model.comm, static_cast<std::int64_t>(part.store->n_live())) == 0)
      s.warnings.push_back(
          fmt::format("warning: all elements of part {} have eroded; check its erosion criteria", part.input->name));
}

void warn_of_nodes_let_go(Summary& s) {
  if (s.contact_let_go.nodes == 0) return;
  s.warnings.push_back(
      fmt::format("warning: contact has let go of {} nodes, up to {:.4g} m deep, the first at {:.6g} s",
                  s.contact_let_go.nodes, s.contact_let_go.deepest, s.contact_let_go.first_time));
}

void add_impacts(Summary& s, const ImpactTally& impacts) {
  s.contact_impacts["steps"] = static_cast<double>(impacts.steps);
  s.contact_impacts["unsettled"] = static_cast<double>(impacts.unsettled);
  s.contact_impacts["at_limit"] = static_cast<double>(impacts.at_limit);
}

/// Elements that have failed and stayed. Collective.
void add_no_tension(const Model& model, Summary& s) {
  for (const PartModel& part : model.parts) {
    const PartStore& store = *part.store;
    const auto [field, component] = store.find_variable("no_tension");
    if (field == PartStore::n_fields) continue;
    std::int64_t n = 0;
    for (int slot = 0; slot < store.n_slots(); ++slot)
      if (store.live(slot) && store.field(field).at(slot, component) != 0.0) ++n;
    s.no_tension.elements += s.no_tension.by_part[part.input->name] = sum_of(model.comm, n);
  }
}

/// Collective.
void add_work_counts(const Model& model, const WorkCounts& mine, Summary& s) {
  const auto add = [&](const char* name, std::int64_t n) { s.work[name] = static_cast<double>(sum_of(model.comm, n)); };
  add("contact_nodes", mine.contact_nodes);
  add("contact_candidates", mine.contact_candidates);
  add("contact_touches", mine.contact_touches);
  add("eroded_elements", mine.eroded_elements);
}

std::string number_or_null(double value) { return std::isfinite(value) ? fmt::format("{:.6g}", value) : "null"; }

/// The measures, and below them why some are not known; equal reasons are told once.
std::string table_of_measures(const Summary& s) {
  std::string text = s.measures.empty() ? "" : "\nmeasures\n";
  for (const auto& [name, value] : s.measures) text += fmt::format("  {:<32}{:>14}\n", name, number_or_null(value));
  std::map<std::string, std::vector<std::string>> by_reason;
  for (const auto& [name, reason] : s.not_measured) by_reason[reason].push_back(name);
  for (const auto& [reason, names] : by_reason)
    text += fmt::format("  null: {} ({})\n", reason, fmt::join(names, ", "));
  return text;
}

}  // namespace

Summary Reporter::summarise(const std::string& exit) {
  const Model& model = simulation_.model();
  Summary s;
  s.kerf_version = KERF_VERSION;
  s.input = settings_.input_name;
  s.title = model.input->title;
  s.precision = model.input->precision;
  for (const LibraryUse& use : model.input->library_uses)
    s.library[use.material] = {use.set, use.file, use.hash, use.verified, use.overridden};
  const DeckNote& deck = model.input->deck;
  s.deck = {deck.units, deck.in_another_way, deck.left_out, deck.keywords};
  s.ranks = model.n_ranks();
  s.cycles = simulation_.clock().cycle();
  s.end_time = simulation_.clock().time();
  // The run proper: set-up and output are in the timers.
  const double elapsed = MPI_Wtime() - start_seconds_;
  s.wall_seconds = elapsed - since_begin(TimerName("output").index()).total;
  s.element_cycles = sum_of(model.comm, simulation_.element_cycles());
  const std::int64_t done_now = s.element_cycles - sum_of(model.comm, first_element_cycles_);
  s.element_cycles_per_second = s.wall_seconds > 0.0 ? static_cast<double>(done_now) / s.wall_seconds : 0.0;
  s.state_hash = state_hash(model);
  s.exit = exit;
  const Balance& b = last_;
  for (const unsigned shares : {0u, unsigned{is_share}})
    for (const BookLine& line : book_lines())
      if ((line.places & in_energy) != 0 && (line.places & is_share) == shares) s.energy[line.name] = line.value(b);
  s.contact_let_go = {b.let_go.nodes,
                      static_cast<double>(b.let_go.mass) * simulation_.ledger().mass_quantum,
                      b.let_go.deepest,
                      b.let_go.nodes > 0 ? b.let_go.first_time : std::numeric_limits<double>::quiet_NaN(),
                      {}};
  for (std::size_t p = 0; p < b.let_go.by_part.size(); ++p)
    if (b.let_go.by_part[p] > 0) s.contact_let_go.by_part[model.parts[p].input->name] = b.let_go.by_part[p];
  s.hourglass.energy = b.hourglass;
  s.hourglass.dissipated =
      dissipated_by_elements(model, b.eroded) + b.hourglass + b.bulk_viscosity + std::max(0.0, b.contact);
  s.momentum.initial = triple(simulation_.ledger().initial_momentum);
  s.momentum.final = triple(b.momentum);
  s.momentum.eroded = triple(b.dropped_momentum);
  s.momentum.external_impulse = triple(b.impulse);
  s.mass = {simulation_.ledger().initial_mass, b.live_mass, b.free_mass, b.dropped_mass};
  std::vector<std::int64_t> counts = eroded_by_;
  MPI_Allreduce(MPI_IN_PLACE, counts.data(), static_cast<int>(counts.size()), MPI_INT64_T, MPI_SUM, model.comm);
  s.eroded.elements = b.eroded_elements;
  for (std::size_t p = 0; p < model.parts.size(); ++p) {
    std::int64_t& of_part = s.eroded.by_part[model.parts[p].input->name];
    if (!model.parts[p].material->erosion) continue;
    const auto& criteria = model.parts[p].material->erosion->criteria;
    for (std::size_t c = 0; c < criteria.size(); ++c) {
      of_part += counts[8 * p + c];
      s.eroded.by_criterion[criteria[c]->type] += counts[8 * p + c];
    }
  }
  add_no_tension(model, s);
  s.warnings = simulation_.warnings();
  warn_of_hourglass_share(s, b);
  warn_of_gains(s, b);
  warn_of_balance(s, b);
  warn_of_lost_parts(model, s);
  warn_of_nodes_let_go(s);
  add_impacts(s, simulation_.impact_tally());
  add_parts(s);
  add_measures(s);
  observers_.add_to(s);
  add_timers(s);
  for (const BalanceMove& r : simulation_.balancer().records())
    s.rebalances.push_back({r.cycle, r.imbalance_before, r.imbalance_after, r.elements_moved, r.seconds});
  add_work_counts(model, simulation_.work_counts(), s);
  return s;
}

void Reporter::add_parts(Summary& summary) {
  const Model& model = simulation_.model();
  const NodeStore& nodes = model.nodes;
  const auto is_shared = [&](int i) { return model.memberships.is_shared(nodes.membership[i]); };
  std::vector<std::int64_t> shared;
  for (int i = 0; i < nodes.n(); ++i)
    if (nodes.owned[i] && !nodes.free[i] && is_shared(i)) shared.push_back(nodes.id[i]);
  const std::vector<NodeShare> shares = model.has_joined_parts() ? shares_of(model, shared) : std::vector<NodeShare>{};
  for (std::size_t p = 0; p < model.parts.size(); ++p) {
    const PartStore& store = *model.parts[p].store;
    std::vector<double> element_mass, mass, kinetic, momentum[3];
    for (int s = 0; s < store.n_slots(); ++s)
      if (store.live(s)) element_mass.push_back(store.field(PartStore::mass).at(s, 0));
    const auto add = [&](double of_node, Vec3 v) {
      mass.push_back(of_node);
      kinetic.push_back(0.5 * of_node * dot(v, v));
      for (int d = 0; d < 3; ++d) momentum[d].push_back(of_node * v[d]);
    };
    for (int i = 0; i < nodes.n(); ++i)
      if (nodes.owned[i] && nodes.part[i] == static_cast<int>(p) && !nodes.free[i] && !is_shared(i))
        add(nodes.mass[i], nodes.v(i));
    for (const NodeShare& s : shares)
      if (s.part == static_cast<std::int32_t>(p)) add(s.mass, nodes.v(model.local_node(s.node)));
    Summary::Part& out = summary.parts[model.parts[p].input->name];
    out.elements = model.parts[p].n_elements;
    out.alive = sum_of(model.comm, store.n_live());
    out.mass = order_free_sum(model.comm, element_mass);
    out.kinetic = order_free_sum(model.comm, kinetic);
    const double moving = order_free_sum(model.comm, mass);
    for (int d = 0; d < 3; ++d) {
      const double total = order_free_sum(model.comm, momentum[d]);
      out.velocity[d] = moving > 0.0 ? total / moving : std::numeric_limits<double>::quiet_NaN();
    }
  }
}

void Reporter::add_measures(Summary& summary) {
  if (input_.measures.empty()) return;
  const MeasureModel share = measure_share(simulation_.model());
  MeasuringRanks ranks(simulation_.model());
  for (const auto& m : input_.measures) {
    MeasuredValues values;
    const std::string failure = ranks.meeting().run([&] { values = m->evaluate(share, ranks); });
    if (!failure.empty()) {
      // The run itself is good: what was computed must not be lost for the sake of a measure.
      values = {{"", std::numeric_limits<double>::quiet_NaN(), "the measure has failed: " + failure}};
      summary.warnings.push_back(fmt::format("warning: measure {} ({}) has failed: {}", m->label, m->type, failure));
    }
    for (const auto& [name, value, reason] : values) {
      const std::string full = name.empty() ? m->label : m->label + "." + name;
      summary.measures[full] = value;
      if (!std::isfinite(value)) summary.not_measured[full] = reason;
    }
  }
}

namespace {

Summary::Spread spread_over_ranks(MPI_Comm comm, double mine) {
  double sum = mine;
  MPI_Allreduce(MPI_IN_PLACE, &sum, 1, MPI_DOUBLE, MPI_SUM, comm);
  return {least(comm, mine), sum / size_of(comm), greatest(comm, mine)};
}

}  // namespace

/// Time of a phase since the first step of this run.
Timers::Time Reporter::since_begin(std::size_t phase) const {
  const Timers::Time now = simulation_.timers().all()[phase], begun = timers_begun_[phase];
  return {now.total - begun.total, now.in_messages - begun.in_messages};
}

void Reporter::add_timers(Summary& summary) {
  const MPI_Comm comm = simulation_.model().comm;
  double work = 0.0, total = 0.0;
  for (std::size_t k = 0; k < std::size(timer_table); ++k) {
    // What the set-up does in the same phases is part of its own time already.
    const Timers::Time mine = timer_table[k].in_step ? since_begin(k) : simulation_.timers().all()[k];
    summary.timers[timer_table[k].name] = {spread_over_ranks(comm, mine.total),
                                           spread_over_ranks(comm, mine.total - mine.in_messages)};
    if (!timer_table[k].in_step) continue;
    total += mine.total;
    work += mine.total - mine.in_messages;
  }
  summary.steps = {spread_over_ranks(comm, total), spread_over_ranks(comm, work)};
}

std::string Reporter::table_of(const Summary& s) const {
  fmt::memory_buffer text;
  const auto out = std::back_inserter(text);
  fmt::format_to(out, "\n{}: {} cycles to {:.6g} s, {} rank{}, {:.2f} s ({:.3f} million element cycles per second)\n",
                 s.exit, s.cycles, s.end_time, s.ranks, s.ranks == 1 ? "" : "s", s.wall_seconds,
                 s.element_cycles_per_second * 1e-6);
  fmt::format_to(out, "state hash {}\n\nenergy [J]\n", s.state_hash);
  for (const BookLine& line : book_lines())
    if (line.label != nullptr) fmt::format_to(out, "  {:<16}{:>16.6g}\n", line.label, line.value(last_));
  fmt::format_to(out, "  {:<16}{:>15.4f} %\n", "balance error", 100.0 * last_.error);
  fmt::format_to(out, "  {:<16}{:>15.2f} %\n", "hourglass share", 100.0 * s.hourglass.share());
  // The simulation's own warnings have been printed already.
  for (std::size_t k = simulation_.warnings().size(); k < s.warnings.size(); ++k)
    fmt::format_to(out, "{}\n", s.warnings[k]);
  fmt::format_to(out, "\n{:<16}{:>10}{:>10}{:>14}{:>14}\n", "part", "elements", "alive", "mass [kg]", "speed [m/s]");
  for (const auto& [name, p] : s.parts)
    fmt::format_to(out, "{:<16}{:>10}{:>10}{:>14.6g}{:>14}\n", name, p.elements, p.alive, p.mass,
                   number_or_null(norm({p.velocity[0], p.velocity[1], p.velocity[2]})));
  if (s.eroded.elements > 0) {
    fmt::format_to(out, "\neroded by");
    for (const auto& [name, n] : s.eroded.by_criterion) fmt::format_to(out, "  {} {}", name, n);
    fmt::format_to(out, "\n");
  }
  if (s.no_tension.elements > 0) fmt::format_to(out, "\nfailed and kept without tension  {}\n", s.no_tension.elements);
  fmt::format_to(out, "{}", table_of_measures(s));
  fmt::format_to(out, "\ntime [s]\n");
  for (const auto& [name, t] : s.timers) fmt::format_to(out, "  {:<16}{:>10.3f}\n", name, t.total.mean);
  fmt::format_to(out, "output in {}\n", settings_.folder);
  return fmt::to_string(text);
}

}  // namespace kerf
