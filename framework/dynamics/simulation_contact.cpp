// What the time loop does for contact: before the forces, with them, and after erosion.
#include <algorithm>
#include <limits>

#include "dynamics/simulation.hpp"
#include "model/copies.hpp"
#include "parallel/communicator.hpp"

namespace kerf {

namespace {

constexpr double unseen = 0.9;  // of the least sight of a facet, that contact lets anything travel in a step

}  // namespace

/// Bodies that touch or are about to ask for a short first step, which shows only when it has been tried.
void Simulation::start_contact(const ElementReport& report) {
  const std::vector<std::int64_t> forces(model_.nodes.force.begin(), model_.nodes.force.end());
  const Step none;
  StepReduction tried;
  do {
    tried = reduction_;
    std::copy(forces.begin(), forces.end(), model_.nodes.force.begin());
    add_contact_forces(none);
    reduce(none, report);
  } while (reduction_.least_step < tried.least_step);
  reduction_ = tried;
  ledger_.let_go = {};  // of the tries
  impact_tally_ = {};
}

/// Sum of the contact forces of all definitions per node. The restart file stores this sum, so its work must also be
/// computed from the sum: one rounding, not one per definition.
ContactLoad Simulation::load() const {
  if (contacts_.size() == 1) return contacts_.front()->load();
  struct Part {
    std::int32_t node;
    const std::int64_t *force, *friction;
  };
  std::vector<Part> parts;
  for (const auto& c : contacts_)
    for (std::size_t k = 0; k < c->load().nodes.size(); ++k)
      parts.push_back({c->load().nodes[k], &c->load().force[4 * k], &c->load().friction[4 * k]});
  std::sort(parts.begin(), parts.end(), [](const Part& a, const Part& b) { return a.node < b.node; });
  ContactLoad sum;
  for (const auto& [node, force, friction] : parts) {
    if (sum.nodes.empty() || sum.nodes.back() != node) {
      sum.nodes.push_back(node);
      sum.force.insert(sum.force.end(), 4, 0);
      sum.friction.insert(sum.friction.end(), 4, 0);
    }
    for (std::size_t d = 0; d < 3; ++d) {
      sum.force[sum.force.size() - 4 + d] += force[d];
      sum.friction[sum.friction.size() - 4 + d] += friction[d];
    }
  }
  return sum;
}

/// Contact needs to know what all other forces will do in the coming step.
void Simulation::add_contact_forces(const Step& step) {
  if (contacts_.empty()) return;
  const Prediction prediction(constraints_, model_, next_step());
  for (std::size_t k = 0; k < contacts_.size(); ++k) {
    ContactEngine& c = *contacts_[k];
    ContactPlan& plan = contact_plans_[k];
    if (k > 0) {
      // What the definitions before do to the nodes of this one is known only now.
      const auto scope = timers_.measure("contact_search");
      const ContactNeed mine = c.need(model_, step, prediction);
      plan.need = static_cast<SearchNeed>(greatest(model_.comm, static_cast<std::int64_t>(mine.what)));
      plan.has_news = true;
    }
    c.add_forces(model_, step, prediction, plan, timers_);
    work_counts_.contact_nodes += static_cast<std::int64_t>(c.n_surface_nodes());
    work_counts_.contact_candidates += static_cast<std::int64_t>(c.n_candidates());
    work_counts_.contact_touches += static_cast<std::int64_t>(c.touches().touches().size());
    for (const ContactTouches::LetGo& l : c.touches().all_let_go())
      ledger_.let_go.add(model_.part_of_node(c.id_of(l.node)), std::llrint(c.mass_of(l.node) / ledger_.mass_quantum),
                         l.depth, prediction.step().end());
    // The next definition predicts with these forces, on ghosts too.
    const auto scope = timers_.measure("halo");
    copy_to_ghosts(model_, model_.nodes.force.data(), 4);
  }
  load_ = load();
  side_books_.take_contacts(contacts_);
}

std::vector<ContactNote> Simulation::notes_of_efforts() const {
  std::vector<ContactNote> notes(contacts_.size());
  for (std::size_t k = 0; k < contacts_.size(); ++k) notes[k].effort = contacts_[k]->effort();
  return notes;
}

/// The one operation of all ranks in a step. `local_step` is this rank's least stable step [s].
void Simulation::agree(const Step& step, StepReduction mine, double local_step) {
  std::vector<ContactNote> notes = notes_of_efforts();
  if (!contacts_.empty()) {
    const auto scope = timers_.measure("contact_search");
    // How long the coming step is, no rank knows yet; it is not longer than it would be for this rank alone.
    const Prediction longest(constraints_, model_, clock_.plan(local_step));
    notes[0].need = contacts_[0]->need(model_, step, longest);
  }
  {
    const auto scope = timers_.measure("halo");
    agreement_->reach(mine, notes);
  }
  reduction_ = mine;
  impact_tally_ = tally_with(notes);
  const std::vector<ImpactPace> paces = next_paces(notes);
  for (std::size_t k = 0; k < contacts_.size(); ++k)
    contact_plans_[k] = {notes[k].need.what, notes[k].need.has_news != 0, paces[k]};
  keeps_paces_ = false;
}

std::vector<ImpactPace> Simulation::next_paces(const std::vector<ContactNote>& notes) const {
  std::vector<ImpactPace> paces;
  for (std::size_t k = 0; k < notes.size(); ++k)
    paces.push_back(keeps_paces_ ? contact_plans_[k].pace
                                 : Impacts::next_pace(contact_plans_[k].pace, notes[k].effort));
  return paces;
}

/// The tally with the forces of the step that the notes are about.
ImpactTally Simulation::tally_with(const std::vector<ContactNote>& notes) const {
  ImpactTally tally = impact_tally_;
  for (std::size_t k = 0; k < notes.size() && !keeps_paces_; ++k) tally.add(contact_plans_[k].pace, notes[k].effort);
  return tally;
}

ImpactTally Simulation::impact_tally() const {
  StepReduction now;
  std::vector<ContactNote> notes = notes_of_efforts();
  agreement_->reach(now, notes);
  return tally_with(notes);
}

/// Tells all contact definitions, on all ranks, what has become of the surface: one exchange for all definitions.
void Simulation::tell_contacts(const Step& step, const std::vector<std::int64_t>& dead,
                               const std::vector<ExteriorFacet>& opened) {
  if (contacts_.empty()) return;
  SparseExchange exchange(model_.comm, static_cast<int>(contacts_.size()) * ContactEngine::Post::n_lists);
  for (std::size_t k = 0; k < contacts_.size(); ++k) {
    ContactEngine::Post post(exchange, k);
    contacts_[k]->announce_change(model_, step.end(), dead, opened, post);
  }
  const std::vector<int> receivers = exchange.receivers();
  if (model_.n_ranks() > 1) exchange.deliver();
  for (auto& c : contacts_) c->meet_partners(receivers, exchange.senders());
  for (std::size_t k = 0; k < contacts_.size(); ++k)
    contacts_[k]->take_change(model_, ContactEngine::Post(exchange, k));
}

ContactSpeeds Simulation::contact_speeds() const {
  ContactSpeeds all;
  for (const auto& c : contacts_) all.join(c->speeds());
  return all;
}

/// The longest step in which contact misses nothing [s]: no pair closes too far, and no node comes from where no facet
/// sees it to behind one.
double Simulation::contact_step(const ContactSpeeds& speeds) const {
  double least_sight = std::numeric_limits<double>::max();
  for (const auto& c : contacts_) least_sight = std::min(least_sight, c->least_sight());
  const double speed = speeds.fastest_pair();
  return std::min(speeds.longest_step, speed > 0.0 ? unseen * least_sight / speed : speeds.longest_step);
}

}  // namespace kerf
