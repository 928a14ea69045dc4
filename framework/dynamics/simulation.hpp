// The order of the phases of a run, and nothing else.
#pragma once

#include <array>
#include <memory>
#include <string>
#include <unordered_map>
#include <vector>

#include "contact/engine.hpp"
#include "core/timers.hpp"
#include "dynamics/agreement.hpp"
#include "dynamics/balance.hpp"
#include "dynamics/clock.hpp"
#include "dynamics/element_loop.hpp"
#include "dynamics/integrator.hpp"
#include "dynamics/side_books.hpp"
#include "erosion/erosion.hpp"
#include "erosion/record.hpp"
#include "loads/loads.hpp"
#include "model/ledger.hpp"
#include "model/model.hpp"
#include "review/initial_overlap.hpp"

namespace kerf {

/// Called by the loop at its named points; a researcher's way in without editing the loop.
class StepObserver {
 public:
  virtual ~StepObserver() = default;
  virtual void before_forces(Model&, const Step&) {}
  virtual void after_forces(Model&, const Step&) {}
  virtual void after_step(class Simulation&, const Step&) {}
};

/// What this rank has done, added up over the cycles since it was started or resumed: what a work model is measured by.
struct WorkCounts {
  std::int64_t contact_nodes = 0, contact_candidates = 0, contact_touches = 0;  // of all definitions
  std::int64_t eroded_elements = 0;
};

class Simulation {
 public:
  /// Builds and distributes the model of time zero. Throws InputError where bodies overlap or nodes cannot start as
  /// they stand. Collective, as is everything here.
  Simulation(MPI_Comm comm, const ModelInput& input);

  /// Lets observers add forces, also those of time zero. Pre: time zero; called once, before observe(). It must outlive
  /// this.
  void add_source(ForceSource& source);
  void observe(StepObserver& observer) { observers_.push_back(&observer); }
  /// Keeps books per boundary condition or per contact definition from now on.
  void keep_side_books(bool of_reactions, bool of_contacts);
  /// Runs to the end, or until a signal. Throws PhysicsError on all ranks where the run goes wrong.
  void run();
  bool stopped_by_signal() const { return signalled_; }

  Model& model() { return model_; }
  const Model& model() const { return model_; }
  const Clock& clock() const { return clock_; }
  Ledger& ledger() { return ledger_; }
  const Ledger& ledger() const { return ledger_; }
  Timers& timers() { return timers_; }
  const Timers& timers() const { return timers_; }
  const Balancer& balancer() const { return balancer_; }
  const StepReduction& reduction() const { return reduction_; }
  std::int64_t element_cycles() const { return element_cycles_; }
  const WorkCounts& work_counts() const { return work_counts_; }
  const std::vector<std::unique_ptr<ContactEngine>>& contacts() const { return contacts_; }
  const std::vector<ErosionRecord>& eroded_now() const { return eroded_now_; }
  /// What was agreed on before the last forces of contact, by definition.
  const std::vector<ContactPlan>& contact_plans() const { return contact_plans_; }
  /// Whether any rank eroded an element in the last step.
  bool any_eroded() const;
  /// Books at the present time. Collective.
  Balance sample();
  /// The terms of the kinetic energy in sample(), per node; zero for ghosts [J]. Local.
  std::vector<double> kinetic_energies() const { return integrator_.kinetic_energies(model_, next_step(), ledger_); }
  const SideBooks& side_books() const { return side_books_; }
  SideBooks& side_books() { return side_books_; }
  /// Throws PhysicsError where energy grows or a node races. Collective.
  void check(const Balance& balance) const;
  /// Forces of loads in the last step on the nodes that this rank owns.
  const ExternalLoad& external_load() const { return loads_.acting(); }
  /// Contact forces of the last step on the nodes that this rank owns.
  const ContactLoad& contact_load() const { return load_; }
  /// The step that will follow.
  Step next_step() const { return clock_.plan(reduction_.least_step); }
  double first_stable_step() const { return first_stable_; }
  /// What sets the step that will follow, and what has set the last one: "element 12 of part rod", "contact" or a key
  /// such as "time.maximum_step".
  std::string next_step_setter() const { return setter_name(next_step().limit, reduction_.least_id); }
  std::string last_step_setter() const { return setter_name(last_limit_, last_id_); }
  /// What a user should look at before the run, as lines "origin: warning: what; what to do"; the same on all ranks.
  const std::vector<std::string>& warnings() const { return warnings_; }
  /// Of all ranks and steps, the last one included. Collective.
  ImpactTally impact_tally() const;
  /// Adds one; the caller prints it.
  void warn(const std::string& text) { warnings_.push_back(text); }
  /// Warns of bodies that contact should have kept apart and that share volume now. Returns the new warnings, which
  /// join the others. Collective.
  std::vector<std::string> judge_end();
  /// Pairs of parts that overlap at the start without a contact between them.
  std::size_t n_overlaps() const { return overlaps_.size(); }

  // For restart
  struct Progress {
    double time = 0.0, last_dt = 0.0;
    std::int64_t cycle = 0, last_rebalance = 0, element_cycles = 0;
    PolicyProgress balance_policy;
    StepReduction reduction;
    double first_stable = 0.0, contact_step = 0.0;
    std::vector<ImpactPace> paces;  // of the coming step, by contact definition
    ImpactTally impacts;
    ForceByNode contact_force;  // any superset of the nodes of this rank
    std::vector<ForceByNode> force_of_contact;  // of each definition, where books are kept
    std::vector<LoadOnNode> external_force;  // each node on any one rank
  };
  /// Collective.
  Progress progress() const;
  /// After the model was assembled from a restart: distributes it and takes up the clock.
  void resume(const Progress& progress);

 private:
  std::string setter_name(StepLimit limit, std::int64_t id) const;
  void refuse_bad_start(const ContactCover& cover);
  void renumbered();
  void rebalance(const Step& step);
  void add_forces(const Step& step);
  double lesser_cell(int first, int second) const;
  void start_contact(const ElementReport& report);
  void agree(const Step& step, StepReduction mine, double local_step);
  void add_contact_forces(const Step& step);
  void reduce(const Step& step, ElementReport report);
  std::vector<ContactNote> notes_of_efforts() const;
  std::vector<ImpactPace> next_paces(const std::vector<ContactNote>& notes) const;
  ImpactTally tally_with(const std::vector<ContactNote>& notes) const;
  void tell_contacts(const Step& step, const std::vector<std::int64_t>& dead, const std::vector<ExteriorFacet>& opened);
  void erode(const Step& step);
  void check_energy(const Balance& balance) const;
  void check_speeds(double time) const;
  [[noreturn]] void stop(const std::string& local_trouble, std::int64_t id, const Step& step) const;
  ContactLoad load() const;
  ContactSpeeds contact_speeds() const;
  double contact_step(const ContactSpeeds& speeds) const;

  const ModelInput& input_;
  Model model_;
  Loads loads_;
  Ledger ledger_;
  Clock clock_;
  Balancer balancer_;
  Constraints constraints_;
  Integrator integrator_{constraints_};
  SideBooks side_books_;
  std::unique_ptr<Erosion> erosion_;
  std::vector<std::unique_ptr<ContactEngine>> contacts_;
  std::vector<ContactPlan> contact_plans_;  // of the forces to come
  std::unique_ptr<StepAgreement> agreement_;
  /// What elements do at time zero, for forces that come late.
  struct AtStart {
    ElementReport report;
    std::vector<std::int64_t> force;
  };
  void start_forces();
  AtStart at_start_;
  std::vector<StepObserver*> observers_;
  Timers timers_;
  StepReduction reduction_;
  std::vector<ErosionRecord> eroded_now_;
  std::vector<std::string> warnings_;
  ContactLoad load_;
  std::int64_t element_cycles_ = 0;
  WorkCounts work_counts_;
  double first_stable_ = 0.0;
  StepLimit last_limit_ = StepLimit::stable;  // of the last step
  std::int64_t last_id_ = -1;  // the element that the last step was stable for, -1 for contact
  std::vector<std::pair<int, int>> overlaps_;  // of parts, at the start, without a contact between them
  double resumed_contact_step_ = 0.0;  // what contact allowed when the restart was written [s]; 0 if not resumed
  ImpactTally impact_tally_;  // of all ranks, without the last forces
  bool keeps_paces_ = false;  // in the next reduction, because the last forces of contact are not those of the run
  bool signalled_ = false;
};

}  // namespace kerf
