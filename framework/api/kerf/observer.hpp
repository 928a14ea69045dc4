// The contract of observers: what watches a run from inside, chosen under `observers` in the input.
//
// An observer sees the model through ObservedModel. It says when it wants to be called, fills columns of its own in
// history.h5, reports numbers of its own in summary.json, and may keep numbers that restart files carry. It changes
// nothing, but it may add forces to nodes, whose work and impulse are booked as external. Plugins of kind "observer".
#pragma once

#include <cstdint>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "kerf/math.hpp"
#include "kerf/measure.hpp"
#include "kerf/plugin.hpp"
#include "kerf/shape.hpp"

namespace kerf {

/// Nodes that one rank holds. Ranks share the nodes between their elements: every copy has the same bits, and exactly
/// one rank owns the node. Sums over the model take owned nodes only.
struct ObservedNodes {
  int n = 0;
  const std::int64_t* id = nullptr;
  const std::int32_t* part =
      nullptr;  // of several parts that share the node, the first: see ObservedModel::belongs_to()
  const std::uint8_t *owned = nullptr, *free = nullptr;  // free: no live element is left round it
  const double* mass = nullptr;  // [kg]; zero where the node was dropped
  const double *position = nullptr, *velocity = nullptr;  // four entries per node, the fourth one spare
  const std::int64_t* force_quanta = nullptr;  // four entries per node
  double force_quantum = 0.0;  // [N]

  Vec3 x(int i) const { return vector(position, i); }  // at the end of the step [m]
  Vec3 v(int i) const { return vector(velocity, i); }  // at the middle of the step [m/s]
  /// Sum of all forces that will drive the coming step: of elements, loads and contact [N]. Zero before the forces.
  Vec3 force(int i) const {
    const std::int64_t* q = force_quanta + 4 * static_cast<std::ptrdiff_t>(i);
    return Vec3{static_cast<double>(q[0]), static_cast<double>(q[1]), static_cast<double>(q[2])} * force_quantum;
  }

 private:
  static Vec3 vector(const double* rows, int i) {
    const double* row = rows + 4 * static_cast<std::ptrdiff_t>(i);
    return {row[0], row[1], row[2]};
  }
};

/// A body, as it was made.
struct ObservedPart {
  std::string name;
  const Shape* shape = nullptr;  // of all its elements
  std::int64_t n_elements = 0;  // undeformed, on all ranks
  double mass = 0.0;  // [kg] undeformed
  double density = 0.0;  // [kg/m3] undeformed
  double energy =
      0.0;  // internal energy per mass at the start, which the field internal_energy does not contain [J/kg]
  int body = 0;  // index of the first part that the input joins with it, directly or through others; its own if none
  std::vector<std::string> state_variables;  // of the laws of its material, also when no element lives any more
};

/// What a boundary condition has done to the nodes since time zero.
struct ObservedReaction {
  std::string name;  // type and place in the input's list: "rigid_wall_1"
  Vec3 impulse;  // [N s]
  double work = 0.0;  // [J]
};

/// What a contact definition does and has done since time zero.
struct ObservedContact {
  std::string name;  // type and place in the input's list: "slide_surface_1"
  double work = 0.0, friction_work = 0.0;  // taken from the nodes; the latter is a share of the former [J]
  std::vector<Vec3> force;  // on each part, in the coming step [N]
  std::vector<Vec3> impulse;  // on each part [N s]
};

/// A column of history.h5.
struct ObservedColumn {
  std::string name, unit, doc;
};

/// The model of one rank as observers see it. Functions marked "collective" must be called by all ranks together and
/// in the same order; everything else is local. What collective functions return is the same on all ranks, and the same
/// bits on any number of them.
class ObservedModel {
 public:
  double time = 0.0;  // at the end of the step [s]
  double dt = 0.0;  // of the step; zero at time zero [s]
  std::int64_t cycle = 0;  // steps so far
  ObservedNodes nodes;
  std::vector<ObservedPart> parts;

  ObservedModel() = default;
  ObservedModel(const ObservedModel&) = delete;
  ObservedModel& operator=(const ObservedModel&) = delete;
  virtual ~ObservedModel() = default;

  /// Index of a part; -1 where there is none of this name.
  int find_part(const std::string& name) const {
    for (std::size_t p = 0; p < parts.size(); ++p)
      if (parts[p].name == name) return static_cast<int>(p);
    return -1;
  }
  /// Another number whenever nodes or elements came to this rank, left it, died, or changed places.
  virtual std::int64_t arrangement() const = 0;
  /// Where a node of this rank was in the undeformed model, after placement [m].
  virtual Vec3 reference(int node) const = 0;
  /// Whether elements of a part touch a node of this rank, or did before they eroded.
  virtual bool belongs_to(int node, int part) const = 0;
  /// Kinetic energy of every node of this rank at the time of the model, as the energy balance counts it; zero for
  /// nodes that another rank owns [J]. Only in sample().
  virtual std::span<const double> kinetic_energy() = 0;
  /// The share of contact in the force of every node of this rank; zero for nodes that another rank owns [N]. From
  /// after_forces() on.
  virtual std::span<const Vec3> contact_force() = 0;
  /// The same of all loads of the input.
  virtual std::span<const Vec3> load_force() = 0;

  /// Global ids of the live elements of a part on this rank, in an order that means nothing.
  virtual std::span<const std::int64_t> elements(int part) const = 0;
  /// The k-th node of the i-th of them, as a number in `nodes`.
  virtual std::int32_t element_node(int part, int i, int k) const = 0;
  /// Components of a field: 6 for a symmetric tensor (xx, yy, zz, xy, yz, zx), otherwise 1.
  virtual int n_components(const std::string& field) const = 0;
  /// A column for each component of an element field or a node field: "stress_xx", "velocity_x", "pressure".
  virtual std::vector<ObservedColumn> columns_of_field(const std::string& name) const = 0;
  virtual std::vector<ObservedColumn> columns_of_node_field(const std::string& name) const = 0;
  /// A field of all live elements of a part on this rank, n_components values for one element after another. There
  /// are the fields of output.element_fields, every state variable, and what elements store: mass [kg], volume [m3],
  /// deviator_xx to deviator_zx [Pa], viscous_energy [J]. NaN where the part does not have the field.
  virtual std::vector<double> field(int part, const std::string& name) const = 0;
  /// The same of the i-th element.
  virtual std::vector<double> field_of(int part, int i, const std::string& name) const = 0;
  /// A field of output.node_fields of one node of this rank.
  virtual std::vector<double> node_field(int node, const std::string& name) const = 0;

  /// The mass of every node of this rank that comes from a part; zero for nodes that another rank owns, for nodes of
  /// other parts, and for nodes that were dropped [kg]. Of a node that parts share it is what the undeformed elements
  /// of the part give to it, so that sums over parts count each node once. Collective.
  virtual std::vector<double> mass_in(int part) = 0;
  /// Sums over all terms of all ranks, list by list; NaN where a term is not finite. Collective.
  virtual std::vector<double> sums(const std::vector<std::span<const double>>& lists) = 0;
  /// Greatest and least values of all ranks, entry by entry; NaN counts as nothing. Collective.
  virtual std::vector<double> greatest(std::vector<double> values) = 0;
  virtual std::vector<double> least(std::vector<double> values) = 0;
  /// The least value and its id; of equal values the one with the lowest id. A rank without any passes infinity.
  /// Collective.
  virtual std::pair<double, std::int64_t> nearest(double value, std::int64_t id) = 0;
  /// The values of the one rank that passes `mine`; NaN where none does. All ranks pass as many values. Collective.
  virtual std::vector<double> from_holder(bool mine, std::vector<double> values) = 0;
  /// Boundary conditions and contacts, in the order of the input. For observers whose calls() ask for them. Collective.
  virtual std::vector<ObservedReaction> reactions() = 0;
  virtual std::vector<ObservedContact> contacts() = 0;
};

/// Takes the forces that an observer adds in a step.
class ObservedForces {
 public:
  ObservedForces() = default;
  ObservedForces(const ObservedForces&) = delete;
  ObservedForces& operator=(const ObservedForces&) = delete;
  virtual ~ObservedForces() = default;
  /// Adds to the force of a node that this rank owns [N]; every rank that has a copy of the node gets it. Throws
  /// std::runtime_error where another rank owns the node. A force that is not finite, or out of all proportion to what
  /// the materials can bear, stops the run with the observer's name. Local.
  virtual void add(int node, Vec3 newton) = 0;
};

/// What an observer wants of the loop. What nobody asks for costs nothing.
struct ObserverCalls {
  bool before_forces = false, after_forces = false, after_step = false;  // in every cycle
  bool forces = false;  // add_forces() in every cycle and before the first one
  bool reactions = false, contacts = false;  // keep the books that ObservedModel::reactions() and contacts() read
};

/// What goes to summary.json at the end of a run.
struct ObserverReport {
  MeasuredValues numbers;
  std::vector<std::string> warnings;  // half sentences: "its element has eroded"
};

/// Watches a run. Every function is called on all ranks together. An exception that leaves one of them stops the run on
/// all ranks, with the observer's name and place in the input: throw std::runtime_error with a sentence.
class Observer : public Plugin {
 public:
  double interval = 0.0;  // time between two rows; zero for output.history_interval [s]

  /// Parts that are named in the input, for its validation.
  virtual std::vector<std::string> references() const { return {}; }
  /// Element fields and node fields that are named in the input, for its validation.
  virtual std::vector<std::string> element_fields() const { return {}; }
  virtual std::vector<std::string> node_fields() const { return {}; }
  /// The same on all ranks and throughout a run.
  virtual ObserverCalls calls() const { return {}; }

  /// Looks at the undeformed model, before the first step and before a resumed run takes up its state. What is thrown
  /// here is an error of the input.
  virtual void prepare(ObservedModel&) {}
  /// The columns, the same throughout the run. Called after prepare().
  virtual std::vector<ObservedColumn> columns() const { return {}; }
  /// Positions, velocities of the step, no forces yet.
  virtual void before_forces(ObservedModel&) {}
  /// Adds forces, beside the loads of the input. Positions are those of the end of the step, at which the forces act,
  /// velocities those of its middle; the forces of the nodes are those of the elements alone.
  virtual void add_forces(ObservedModel&, ObservedForces&) {}
  /// Forces of elements, loads and contact are there; what fails in this step is still alive.
  virtual void after_forces(ObservedModel&) {}
  /// The step is complete.
  virtual void after_step(ObservedModel&) {}
  /// Fills a row, one value per column; the values of rank 0 are written. Called at time zero, at the end of the first
  /// step that reaches the due time, and at the end of the run.
  virtual void sample(ObservedModel&, std::span<double> /*row*/) {}
  virtual ObserverReport report(ObservedModel&) { return {}; }

  /// Numbers that a run needs to go on with the same bits, the same on all ranks, and of the same count throughout a
  /// run. restore() gets them back after prepare().
  virtual std::vector<double> state() const { return {}; }
  virtual void restore(std::span<const double>) {}

 protected:
  /// Declares the key `interval`.
  template <class S>
  static void describe_interval(S& s) {
    s.real(&Observer::interval, "interval", "s", positive,
           "time between two rows in history.h5; by default output.history_interval")
        .optional();
  }
};

}  // namespace kerf

KERF_SIZES(observer, KERF_SIZE(ObservedNodes), KERF_SIZE(ObservedPart), KERF_SIZE(ObservedReaction),
           KERF_SIZE(ObservedContact), KERF_SIZE(ObservedColumn), KERF_SIZE(ObservedModel), KERF_SIZE(ObservedForces),
           KERF_SIZE(ObserverCalls), KERF_SIZE(ObserverReport), KERF_SIZE(Observer))
