// The time loop and the phases that it calls.
#include "dynamics/simulation.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <csignal>
#include <limits>

#include "core/activity.hpp"
#include "core/diagnostics.hpp"
#include "core/fixed_sum.hpp"
#include "core/physics_error.hpp"
#include "erosion/record.hpp"
#include "model/copies.hpp"
#include "model/names.hpp"
#include "model/setup.hpp"
#include "parallel/communicator.hpp"
#include "review/model_warnings.hpp"

namespace kerf {

namespace {

enum Flag : std::int64_t { flag_trouble = 1, flag_failed = 2, flag_signal = 4 };

constexpr double overlap_at_end = 0.1;  // cells that parts in contact may share

volatile std::sig_atomic_t signal_seen = 0;
extern "C" void note_signal(int number) { signal_seen = number; }

}  // namespace

Simulation::Simulation(MPI_Comm comm, const ModelInput& input)
    : input_(input), loads_(input), clock_(input.time), balancer_(input.balance) {
  const auto scope = timers_.measure("setup");
  create_parts(model_, comm, input);
  activity::beat();
  generate_mesh(model_);
  activity::beat();
  balancer_.distribute(model_);
  activity::beat();
  for (const auto& law : input.contacts) {
    std::unique_ptr<SpatialDecomposition> space;
    if (model_.n_ranks() > 1) space = input.balance.contact_partitioner->spatial();
    contacts_.push_back(std::make_unique<ContactEngine>(model_, *law, std::move(space)));
  }
  balancer_.watch(contacts_);
  contact_plans_.resize(contacts_.size());
  agreement_ = std::make_unique<StepAgreement>(model_.comm, contacts_.size());
  erosion_ = std::make_unique<Erosion>(model_);
  constraints_.initialise(model_);
  ledger_.open(model_);
  loads_.begin(model_);
  renumbered();
  activity::beat();

  const ContactCover cover(model_);
  warnings_ = input.warnings;
  refuse_bad_start(cover);
  activity::beat();

  at_start_.report = initialise_elements(model_);
  activity::beat();
  sum_over_copies(model_, model_.nodes.force.data(), 4);
  at_start_.force.assign(model_.nodes.force.begin(), model_.nodes.force.end());
  start_forces();
  for (std::string& line : model_warnings(model_, cover, loads_.count_targets(model_)))
    warnings_.push_back(std::move(line));
  warnings_.insert(warnings_.end(), loads_.late().begin(), loads_.late().end());
  for (PartModel& part : model_.parts) {
    std::vector<double> mass;
    for (int s = 0; s < part.store->n_slots(); ++s) mass.push_back(part.store->field(PartStore::mass).at(s, 0));
    part.initial_mass = order_free_sum(comm, mass);
  }
}

/// Forces of time zero, beside those of the elements.
void Simulation::start_forces() {
  std::copy(at_start_.force.begin(), at_start_.force.end(), model_.nodes.force.begin());
  const Step none;
  loads_.add_forces(model_, none);
  // What contact has seen in an earlier try must not shorten the first step.
  resumed_contact_step_ = std::numeric_limits<double>::max();
  for (ContactPlan& plan : contact_plans_) plan.pace = {};
  keeps_paces_ = true;
  reduce(none, at_start_.report);
  first_stable_ = reduction_.least_step;
  if (!contacts_.empty()) start_contact(at_start_.report);
}

void Simulation::add_source(ForceSource& source) {
  const auto scope = timers_.measure("setup");
  loads_.add_source(source);
  if (source.adds_forces()) start_forces();
  at_start_ = {};
}

/// Throws where nodes cannot start as they stand, or bodies that may touch overlap.
void Simulation::refuse_bad_start(const ContactCover& cover) {
  std::vector<std::string> errors = constraints_.complaints(model_);
  for (std::string& line : loads_.complaints(model_)) errors.push_back(std::move(line));
  std::vector<bool> reported(contacts_.size(), false);
  for (const Overlap& o : find_overlaps(model_)) {
    const int contact = cover.between(o.first, o.second);
    if (contact < 0) {
      overlaps_.emplace_back(o.first, o.second);
      warnings_.push_back(fmt::format(
          "{}: warning: {}, and no contact keeps them apart; move the parts apart, or join them in one mesh",
          model_.parts[static_cast<std::size_t>(o.second)].input->mesh->origin, o.sentence(model_)));
      continue;
    }
    errors.push_back(fmt::format("{}: error: {}; move the parts apart",
                                 input_.contacts[static_cast<std::size_t>(contact)]->origin, o.sentence(model_)));
    reported[static_cast<std::size_t>(contact)] = true;
  }
  // What is not deep enough to be seen in a warped cell's volume is seen at its surface.
  for (std::size_t k = 0; k < contacts_.size(); ++k)
    if (!reported[k])
      for (std::string& line : contacts_[k]->initial_penetrations(model_)) errors.push_back(std::move(line));
  if (!errors.empty()) throw InputError(errors);
}

/// The least mean volume of an undeformed cell of two parts [m3].
double Simulation::lesser_cell(int first, int second) const {
  double least = std::numeric_limits<double>::max();
  for (const int p : {first, second}) {
    const PartModel& part = model_.parts[static_cast<std::size_t>(p)];
    least = std::min(least, part.initial_mass / part.material->density /
                                static_cast<double>(std::max(part.n_elements, std::int64_t{1})));
  }
  return least;
}

std::vector<std::string> Simulation::judge_end() {
  std::vector<std::string> lines;
  const ContactCover cover(model_);
  for (const Overlap& o : find_overlaps(model_)) {
    const int contact = cover.between(o.first, o.second);
    const double cells = o.volume / lesser_cell(o.first, o.second);
    if (!(cells > overlap_at_end)) continue;
    if (contact < 0) {
      if (std::find(overlaps_.begin(), overlaps_.end(), std::pair(o.first, o.second)) != overlaps_.end()) continue;
      lines.push_back(fmt::format("{}: warning: {}, {:.3g} cells, and no contact definition covers both",
                                  model_.parts[o.first].input->mesh->origin, o.sentence(model_, "at the end"), cells));
      continue;
    }
    lines.push_back(fmt::format(
        "{}: warning: {}, {:.3g} cells: contact did not keep them apart, do not trust the result; "
        "use cells of like size where bodies meet, or a smaller time.safety_factor",
        input_.contacts[static_cast<std::size_t>(contact)]->origin, o.sentence(model_, "at the end"), cells));
  }
  warnings_.insert(warnings_.end(), lines.begin(), lines.end());
  return lines;
}

void Simulation::renumbered() {
  constraints_.resolve(model_);
  loads_.renumbered(model_);
  for (auto& c : contacts_) c->renumbered(model_);
}

void Simulation::keep_side_books(bool of_reactions, bool of_contacts) {
  if (of_reactions) {
    side_books_.keep_reactions(model_);
    integrator_.split_reactions(side_books_);
  }
  if (!of_contacts) return;
  side_books_.keep_contacts(model_);
  side_books_.take_contacts(contacts_);
}

std::string Simulation::setter_name(StepLimit limit, std::int64_t id) const {
  switch (limit) {
    case StepLimit::growth:
      return "time.growth";
    case StepLimit::initial_step:
      return "time.initial_step";
    case StepLimit::maximum_step:
      return "time.maximum_step";
    case StepLimit::end:
      return "time.end";
    case StepLimit::stable:
      break;
  }
  return id >= 0 ? element_name(model_, id) : "contact";
}

void Simulation::run() {
  std::signal(SIGINT, &note_signal);
  std::signal(SIGTERM, &note_signal);
  std::signal(SIGUSR1, &note_signal);  // which mpirun passes on, while SIGTERM makes it end its ranks
  while (clock_.running() && !signalled_) {
    const Step step = clock_.advance(reduction_.least_step);
    activity::begin_cycle(step.cycle);
    marks::begin_cycle(step.cycle);
    last_limit_ = step.limit;
    last_id_ = reduction_.least_id;
    {
      const auto scope = timers_.measure("nodes");
      side_books_.before_kick(model_);
      integrator_.kick_and_drift(model_, step, {load_, loads_.acting()}, ledger_);
      side_books_.after_kick(model_, step, ledger_);
      erosion_->drop_free_nodes(model_, ledger_);
    }
    rebalance(step);
    for (StepObserver* o : observers_) o->before_forces(model_, step);
    add_forces(step);
    for (StepObserver* o : observers_) o->after_forces(model_, step);
    erode(step);
    erosion_->average(model_);
    // A node that races from the start makes steps so short that no other check would ever come.
    if (step.cycle == 1) check_speeds(step.end());
    for (StepObserver* o : observers_) o->after_step(*this, step);
  }
  marks::enter(marks::beside);  // what follows belongs to no step
}

/// Between the drift and the forces, when the old forces have done their work and nothing but state has to move.
void Simulation::rebalance(const Step& step) {
  double left = (input_.time.end - step.end()) / step.dt;
  if (input_.time.maximum_cycles > 0)
    left = std::min(left, static_cast<double>(input_.time.maximum_cycles - step.cycle));
  // Elements have died since the ranks have told each other their work.
  const RankWork* known = any_eroded() ? nullptr : &reduction_.work;
  if (!balancer_.due(model_, step, left, known)) return;
  const auto scope = timers_.measure("rebalance");
  balancer_.move(model_, step.cycle);
  erosion_->rearranged();
  renumbered();
}

void Simulation::add_forces(const Step& step) {
  ElementReport report;
  {
    const auto scope = timers_.measure("elements");
    report = add_internal_forces(model_, step, *erosion_, ledger_);
    element_cycles_ += model_.n_live_local();
  }
  {
    const auto scope = timers_.measure("halo");
    sum_over_copies(model_, model_.nodes.force.data(), 4);
  }
  {
    const auto scope = timers_.measure("loads");
    loads_.add_forces(model_, step);
  }
  reduce(step, report);
  add_contact_forces(step);
}

void Simulation::reduce(const Step& step, ElementReport report) {
  StepReduction mine;
  mine.least_step = report.least_step;
  mine.least_id = report.least_id;
  mine.speeds = contact_speeds();
  mine.work = RankWork::of(model_);
  for (const auto& c : contacts_)
    if (report.trouble.empty()) report.trouble = c->trouble();
  if (report.trouble.empty()) report.trouble = loads_.trouble();
  if (!report.trouble.empty()) mine.flags |= flag_trouble;
  if (report.failed) mine.flags |= flag_failed;
  if (signal_seen != 0) mine.flags |= flag_signal;
  agree(step, mine, report.least_step);
  double allowed = contact_step(reduction_.speeds);
  if (resumed_contact_step_ > 0.0) allowed = resumed_contact_step_;
  resumed_contact_step_ = 0.0;
  if (allowed < input_.time.safety_factor * reduction_.least_step) {
    reduction_.least_step = allowed / input_.time.safety_factor;
    reduction_.least_id = -1;
  }
  if ((reduction_.flags & flag_trouble) != 0) stop(report.trouble, report.trouble_id, step);
  signalled_ = (reduction_.flags & flag_signal) != 0;
  const double first = first_stable_ > 0.0 ? first_stable_ : reduction_.least_step;
  const double least = input_.time.minimum_step > 0.0 ? input_.time.minimum_step : 1e-4 * first;
  if (reduction_.least_id >= 0 && !(reduction_.least_step * input_.time.safety_factor >= least)) {
    std::string text;
    if (report.least_id == reduction_.least_id)
      text = fmt::format(
          "the stable time step of {} is {:.3g} s{}, below the minimum of {:.3g} s; give its material the "
          "erosion criterion minimum_time_step or lower time.minimum_step;",
          element_name(model_, report.least_id), reduction_.least_step,
          input_.time.safety_factor < 1.0 ? fmt::format(" (times safety_factor {:.3g})", input_.time.safety_factor)
                                          : "",
          least);
    stop(text, reduction_.least_id, step);
  }
}

void Simulation::erode(const Step& step) {
  eroded_now_.clear();
  // Every hundredth cycle, whatever else happens, so that it does not depend on anything but the cycle.
  if (step.cycle % 100 == 0 && erosion_->drop_distant_nodes(model_, ledger_))
    for (auto& c : contacts_) c->invalidate();
  if ((reduction_.flags & flag_failed) == 0) return;
  std::vector<std::int64_t> dead;  // numbered body by body, as contact does
  std::vector<ExteriorFacet> opened;
  {
    const auto scope = timers_.measure("erosion");
    loads_.before_erosion(model_, erosion_->failing());
    eroded_now_ = erosion_->erode(model_, step, ledger_);
    work_counts_.eroded_elements += static_cast<std::int64_t>(eroded_now_.size());
    erosion_->update_free_nodes(model_);
    for (const ErosionRecord& r : eroded_now_)
      dead.push_back(r.element + model_.parts[model_.part_of_element(r.element)].shift_in_body);
    opened = model_.surface.opened_by(model_.surface_mesh(), erosion_->retired());
    loads_.after_erosion(model_, opened);
  }
  {
    const auto scope = timers_.measure("contact_search");
    tell_contacts(step, dead, opened);
  }
  const auto scope = timers_.measure("erosion");
  erosion_->compact(model_);
  erosion_->rearranged();
}

void Simulation::stop(const std::string& local_trouble, std::int64_t id, const Step& step) const {
  const std::int64_t lowest = -greatest(model_.comm, -id);
  const std::string text = first_text(model_.comm, id == lowest ? local_trouble : std::string{});
  throw PhysicsError(fmt::format("{} at time {:.6g} s, cycle {}", text, step.end(), step.cycle));
}

bool Simulation::any_eroded() const { return (reduction_.flags & flag_failed) != 0; }

Balance Simulation::sample() {
  Balance b = integrator_.sample(model_, next_step(), {load_, loads_.acting()}, ledger_);
  ledger_.judge(b);
  return b;
}

Simulation::Progress Simulation::progress() const {
  Progress p;
  StepReduction now;
  now.speeds = contact_speeds();
  std::vector<ContactNote> notes = notes_of_efforts();
  agreement_->reach(now, notes);
  p.contact_step = contact_step(now.speeds);
  p.paces = next_paces(notes);
  p.impacts = tally_with(notes);
  p.time = clock_.time();
  p.last_dt = clock_.last_dt();
  p.cycle = clock_.cycle();
  p.last_rebalance = balancer_.last_cycle();
  p.balance_policy = balancer_.policy_progress(model_.comm);
  p.element_cycles = element_cycles_;
  p.reduction = reduction_;
  p.first_stable = first_stable_;
  return p;
}

void Simulation::resume(const Progress& p) {
  const auto scope = timers_.measure("setup");
  clock_.restore(p.time, p.last_dt, p.cycle);
  element_cycles_ = model_.rank() == 0 ? p.element_cycles : 0;
  reduction_ = p.reduction;
  reduction_.flags = 0;
  first_stable_ = p.first_stable;
  resumed_contact_step_ = p.contact_step;
  for (std::size_t k = 0; k < contact_plans_.size() && k < p.paces.size(); ++k) contact_plans_[k].pace = p.paces[k];
  impact_tally_ = p.impacts;
  keeps_paces_ = true;
  balancer_.distribute_again(model_, p.cycle, p.time);
  erosion_->rearranged();
  reduction_.work = RankWork::of_all(model_);
  balancer_.restore(p.last_rebalance, p.balance_policy);
  renumbered();
  load_ = load_on_owned(model_, p.contact_force);
  for (std::size_t k = 0; k < p.force_of_contact.size(); ++k)
    side_books_.restore_load(k, load_on_owned(model_, p.force_of_contact[k]));
  loads_.restore(model_, p.external_force);
}

}  // namespace kerf
