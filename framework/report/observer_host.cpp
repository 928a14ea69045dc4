// The calls of observers, and what becomes of what they say.
#include "report/observer_host.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <set>

#include "core/diagnostics.hpp"
#include "core/physics_error.hpp"
#include "output/collective.hpp"
#include "output/file.hpp"
#include "report/due.hpp"

namespace kerf {

namespace {

std::string described(const Observer& o) {
  return fmt::format("the observer `{}` ({}, {})", o.label, o.type, o.origin);
}

/// Hands the forces of an observer on, those on owned nodes.
class OwnedForces final : public ObservedForces {
 public:
  OwnedForces(const ObservedNodes& nodes, ForceActor actor, const AddForce& add)
      : nodes_(nodes), actor_(std::move(actor)), add_(add) {}
  void add(int node, Vec3 newton) override {
    if (node < 0 || node >= nodes_.n || nodes_.owned[node] == 0)
      throw std::runtime_error(fmt::format(
          "a force was added to node {} of this rank, which it does not own; expected owned nodes only", node));
    add_(node, newton, actor_);
  }

 private:
  const ObservedNodes& nodes_;
  ForceActor actor_;
  const AddForce& add_;
};

/// What is wrong with the columns that an observer declares, or nothing.
std::string complaint_about(const std::vector<ObservedColumn>& columns) {
  std::set<std::string> names = {"time"};
  for (const ObservedColumn& c : columns) {
    if (c.name.empty() || c.name.find('/') != std::string::npos)
      return fmt::format("its column \"{}\" has no usable name; expected one without a slash", c.name);
    if (!names.insert(c.name).second) return fmt::format("its column \"{}\" is declared twice", c.name);
  }
  return {};
}

}  // namespace

ObserverHost::ObserverHost(Simulation& simulation, const ModelInput& input)
    : simulation_(simulation), input_(input), view_(simulation) {
  bool reactions = false, contacts = false;
  for (const auto& observer : input.observers) {
    Seat seat;
    seat.observer = observer.get();
    seat.calls = observer->calls();
    reactions |= seat.calls.reactions;
    contacts |= seat.calls.contacts;
    seats_.push_back(std::move(seat));
  }
  simulation.keep_side_books(reactions, contacts);
  std::vector<std::string> errors;
  for (Seat& seat : seats_)
    if (const std::string failure = prepare(seat); !failure.empty())
      errors.push_back(fmt::format("{}: error: {}", seat.observer->origin, failure));
  if (!errors.empty()) throw InputError(errors);
  simulation.add_source(*this);
}

bool ObserverHost::adds_forces() const {
  return std::any_of(seats_.begin(), seats_.end(), [](const Seat& s) { return s.calls.forces; });
}

void ObserverHost::add_forces(const Step& step, const AddForce& add) {
  for (Seat& seat : seats_) {
    if (!seat.calls.forces || seat.observer == nullptr) continue;
    const auto scope = simulation_.timers().measure("observers");
    show(step);
    OwnedForces forces(view_.nodes, {fmt::format("the observer {}", seat.observer->label), seat.observer->origin}, add);
    call(seat, "add_forces", [&] { seat.observer->add_forces(view_, forces); });
  }
}

std::string ObserverHost::prepare(Seat& seat) {
  Observer& o = *seat.observer;
  const OutputInput& output = input_.output;
  seat.interval = o.interval > 0.0 ? o.interval : history_interval(output, input_.time);
  seat.due = seat.interval;
  view_.refresh(simulation_.clock().time(), 0.0, simulation_.clock().cycle());
  const std::string failure = view_.meeting().run([&] {
    o.prepare(view_);
    seat.columns = o.columns();
    seat.n_state = o.state().size();
  });
  if (!failure.empty()) return failure;
  if (!seat.columns.empty())
    seat.table = std::count_if(seats_.begin(), seats_.end(), [](const Seat& s) { return s.table >= 0; });
  return complaint_about(seat.columns);
}

std::vector<ColumnTable> ObserverHost::tables() const {
  std::vector<ColumnTable> all;
  for (const Seat& seat : seats_) {
    if (seat.table < 0) continue;
    ColumnTable table{seat.observer->label, seat.observer->type, {}};
    for (const ObservedColumn& c : seat.columns) table.columns.push_back({c.name, c.unit, c.doc});
    all.push_back(std::move(table));
  }
  return all;
}

void ObserverHost::start(const std::string& folder) {
  const std::string path = folder + "history.h5";
  const std::vector<ColumnTable> wanted = tables();
  const MPI_Comm comm = simulation_.model().comm;
  if (wanted.empty())
    on_root(comm, [&] { remove_if_there(path); });
  else
    file_ = std::make_unique<ColumnFile>(comm, path, wanted);
  view_.refresh(simulation_.clock().time(), 0.0, simulation_.clock().cycle());
  for (Seat& seat : seats_) sample(seat);
}

void ObserverHost::resume(const std::string& folder, const std::vector<ObserverProgress>& progress) {
  const auto refuse = [&](const std::string& what) {
    throw InputError({fmt::format("{}restart/restart.h5: error: {}; resume with the observers that the run began with",
                                  folder, what)});
  };
  for (const ObserverProgress& p : progress)
    if (std::none_of(seats_.begin(), seats_.end(), [&](const Seat& s) { return s.observer->label == p.name; }))
      refuse(fmt::format("the run had the observer `{}`, which the input does not have", p.name));
  const double time = simulation_.clock().time();
  for (Seat& seat : seats_) {
    const auto found = std::find_if(progress.begin(), progress.end(),
                                    [&](const ObserverProgress& p) { return p.name == seat.observer->label; });
    if (found == progress.end() || found->numbers.size() != seat.n_state + 1)
      refuse(fmt::format("the run had no observer `{}` of the type {}", seat.observer->label, seat.observer->type));
    seat.due = found->numbers.front();
    const std::string failure =
        view_.meeting().run([&] { seat.observer->restore(std::span(found->numbers).subspan(1)); });
    if (!failure.empty()) refuse(described(*seat.observer) + ": " + failure);
  }
  const std::vector<ColumnTable> wanted = tables();
  if (!wanted.empty())
    file_ =
        std::make_unique<ColumnFile>(ColumnFile::resume(simulation_.model().comm, folder + "history.h5", wanted, time));
  for (Seat& seat : seats_)
    if (seat.table >= 0 && file_->last_time(static_cast<std::size_t>(seat.table)) == time)
      seat.last_cycle = simulation_.clock().cycle();  // what is written of this moment is not written again
}

/// Runs a function of an observer. Where it throws, the run stops on all ranks, and the observer is not called again.
template <class Work>
void ObserverHost::call(Seat& seat, const char* what, const Work& work) {
  if (seat.observer == nullptr) return;
  const std::string failure = view_.meeting().run(work);
  if (failure.empty()) return;
  failures_.push_back(fmt::format("{} failed in {}: {}", described(*seat.observer), what, failure));
  seat.observer = nullptr;
  throw PhysicsError(fmt::format("{}; at time {:.6g} s, cycle {}", failures_.back(), view_.time, view_.cycle));
}

void ObserverHost::sample(Seat& seat) {
  std::vector<double> row(seat.columns.size(), std::numeric_limits<double>::quiet_NaN());
  call(seat, "sample", [&] { seat.observer->sample(view_, row); });
  if (seat.table >= 0) file_->add_row(static_cast<std::size_t>(seat.table), view_.time, row);
  seat.last_cycle = view_.cycle;
}

void ObserverHost::before_forces(const Step& step) {
  for (Seat& seat : seats_) {
    if (!seat.calls.before_forces) continue;
    const auto scope = simulation_.timers().measure("observers");
    show(step);
    call(seat, "before_forces", [&] { seat.observer->before_forces(view_); });
  }
}

void ObserverHost::after_forces(const Step& step) {
  for (Seat& seat : seats_) {
    if (!seat.calls.after_forces) continue;
    const auto scope = simulation_.timers().measure("observers");
    show(step);
    call(seat, "after_forces", [&] { seat.observer->after_forces(view_); });
  }
}

void ObserverHost::after_step(const Step& step) {
  if (seats_.empty()) return;
  const double now = step.end() + due_tolerance(input_.time);
  const auto scope = simulation_.timers().measure("observers");
  bool shown = false;
  for (Seat& seat : seats_) {
    const bool due = now >= seat.due;
    if (!due && !seat.calls.after_step) continue;
    if (!shown) show(step);
    shown = true;
    if (seat.calls.after_step) call(seat, "after_step", [&] { seat.observer->after_step(view_); });
    if (!due) continue;
    seat.due = next_due(seat.due, seat.interval, now);
    sample(seat);
  }
}

void ObserverHost::finish() {
  const Clock& clock = simulation_.clock();
  view_.refresh(clock.time(), clock.last_dt(), clock.cycle());
  for (Seat& seat : seats_) {
    if (seat.observer == nullptr || seat.last_cycle == view_.cycle) continue;
    try {
      sample(seat);
    } catch (const PhysicsError&) {  // kept in failures_; the run is over
    }
  }
  if (file_) file_->close();
}

void ObserverHost::sync() {
  if (file_) file_->sync();
}

std::vector<ObserverProgress> ObserverHost::progress() const {
  std::vector<ObserverProgress> all;
  for (const Seat& seat : seats_) {
    if (seat.observer == nullptr) continue;
    ObserverProgress p{seat.observer->label, {seat.due}};
    const std::vector<double> state = seat.observer->state();
    p.numbers.insert(p.numbers.end(), state.begin(), state.end());
    all.push_back(std::move(p));
  }
  return all;
}

void ObserverHost::add_to(Summary& summary) {
  for (Seat& seat : seats_) {
    if (seat.observer == nullptr) continue;
    const std::string label = seat.observer->label;
    ObserverReport report;
    try {
      call(seat, "report", [&] { report = seat.observer->report(view_); });
    } catch (const PhysicsError&) {  // kept in failures_; the run is over
    }
    NamedNumbers& numbers = summary.observers[label];
    for (const auto& [name, value, reason] : report.numbers) {
      numbers[name] = value;
      if (!std::isfinite(value)) summary.not_measured["observers." + label + "." + name] = reason;
    }
    for (const std::string& text : report.warnings)
      summary.warnings.push_back(fmt::format("{}: warning: {}", seat.observer->origin, text));
  }
  for (const std::string& text : failures_) summary.warnings.push_back("warning: " + text);
}

}  // namespace kerf
