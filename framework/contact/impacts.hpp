// Answers touches with impulses: momentum-exact impacts within the coming step, which never make energy.
//
// Every touch is an impact of a share of the node's mass on shares of the masses of the facet's corners. A node that
// takes part in several touches is split between them (R. Tonge, F. Benevolenski & A. Voroshilov, "Mass splitting for
// jitter-free parallel rigid body simulation", ACM Trans. Graph. 31 (2012) 105), so that all impacts of a step can be
// computed side by side: each of them loses energy or keeps it, and so does the joining of the shares into one node.
#pragma once

#include <cstdint>
#include <vector>

#include "kerf/contact.hpp"
#include "kerf/element.hpp"

namespace kerf {

/// Takes impulses, node or edge against facet, as forces that are equal and opposite to the last bit.
class ContactForces {
 public:
  /// `friction` gets the share of friction in `force`; it may be null where there is none.
  ContactForces(std::int64_t* force, std::int64_t* friction, ForceScale scale)
      : force_(force), friction_(friction), scale_(scale) {}

  /// Adds `force` [N] to the node or the edge of a touch and its reaction, split by the weights, to the four nodes of
  /// the facet.
  void add(const ContactTouch& touch, const std::int32_t* facet_nodes, Vec3 force) {
    add_to(force_, touch, facet_nodes, force);
  }
  /// The same with a force of friction.
  void add_friction(const ContactTouch& touch, const std::int32_t* facet_nodes, Vec3 force) {
    add_to(force_, touch, facet_nodes, force);
    add_to(friction_, touch, facet_nodes, force);
  }
  /// Local number of a node with a force that is not finite or too large, or -1.
  int overflow_node() const { return overflow_node_; }
  void note_overflow(int node) { overflow_node_ = node; }
  const ForceScale& scale() const { return scale_; }

 private:
  void add_to(std::int64_t* sums, const ContactTouch& touch, const std::int32_t* facet_nodes, Vec3 force);

  std::int64_t *force_, *friction_;
  ForceScale scale_;
  int overflow_node_ = -1;
};

/// How the masses of nodes are split between touches, in whole numbers: sums that do not depend on any order.
struct MassSplit {
  static constexpr int width = 3;  // of a row
  // Per node of the view: shares of all touches [mass quanta], touches in which it is carried, touches in which it
  // carries.
  std::int64_t* rows;
  double quantum;  // [kg]

  double shares(int node) const { return static_cast<double>(rows[width * static_cast<std::int64_t>(node)]); }
  /// In how many ways a node takes part in touches that are carried: once for each that carries it, and once more if
  /// it carries others; at least 1.
  double roles(int node) const;
};

/// Adds what each touch asks of its nodes.
void add_shares(const ContactView& view, const ContactTouches& touches, const MassSplit& split);

/// What the sums over the touches of one rank become, and where they come from.
class ImpactExchange {
 public:
  virtual ~ImpactExchange() = default;
  /// Velocities of the nodes of the view, four numbers each, with the forces of all ranks so far [m/s]. Collective.
  virtual const double* velocities() = 0;
  /// Adds the rows of all ranks, four whole numbers for each node of the view. Collective.
  virtual void add_up(std::vector<std::int64_t>& rows) = 0;
};

/// How much work the impacts of a step get: known before, from what the step before has shown, so that no rank waits
/// for all others in the middle of a step.
struct ImpactPace {
  int rounds = 12;  // in threes
  double first_excess = 0.0;  // greatest excess of the closing speed of any touch in the step before [m/s]
};

/// What the impacts of some ranks have shown; the greatest of each counts.
struct ImpactEffort {
  std::int64_t rounds = 0;  // after which no touch had too much excess left, as far as it was looked at; 0 for none
  double first_excess = 0.0;  // as in ImpactPace

  void join(const ImpactEffort& other) {
    rounds = rounds < other.rounds ? other.rounds : rounds;
    first_excess = first_excess < other.first_excess ? other.first_excess : first_excess;
  }
};

/// In how many steps impacts were not solved as well as they should be, of all contact definitions together.
struct ImpactTally {
  std::int64_t steps = 0;  // in which any touch closed faster than it should
  std::int64_t unsettled = 0;  // too much excess was left three rounds before the last one: nobody looks later
  std::int64_t at_limit = 0;  // the same in a step that had the most rounds that there are

  /// `pace` and `effort` are those of one step of all ranks.
  void add(const ImpactPace& pace, const ImpactEffort& effort);
};

/// The impacts of all touches of this rank.
///
/// Computed side by side, they leave some of the closing speed where touches share nodes, and further rounds take that
/// away (projected Jacobi iteration). Where meshes differ that is slow, and what is left lets interfaces under pressure
/// buckle. So there is another kind of round: where the mesh of a node is finer than a facet, the facet carries
/// it. The corners get the mass and the momentum of all that they carry, in proportion to the weights, and then tell
/// the nodes how fast to go (kinematic slide surfaces treat slaves like that: Hallquist, Goudreau & Benson, CMAME 51
/// (1985) 107-137). For slaves on one surface this is nearly the solution, whatever the ratio of the meshes.
class Impacts {
 public:
  // In a step, in threes: one round in which facets carry nodes, two side by side.
  static constexpr int least_rounds = 12, most_rounds = 60;
  static_assert(least_rounds == ImpactPace{}.rounds);
  // Excess of the closing speed that may be left, over what a touch had at first, or over a tenth of what any had. With
  // five times as much, plates of lexan and steel with cells 1:2 across buckle at 6 km/s.
  static constexpr double accuracy = 0.01, least_scale = 0.1;
  /// `split` has the shares of the touches of all ranks; `active` lists the nodes of the touches. All must outlive
  /// this.
  Impacts(const ContactView& view, const ContactTouches& touches, const ContactResponse& response,
          const MassSplit& split, const std::vector<std::int32_t>& active);
  /// Adds the forces of all rounds. Collective.
  ImpactEffort add_to(ContactForces& forces, ImpactExchange& exchange, const ImpactPace& pace);
  /// The pace of the next step, from that of the last and what it has shown on all ranks.
  static ImpactPace next_pace(const ImpactPace& last, const ImpactEffort& effort);
  /// Adds the forces of one round side by side, given the velocities that the forces of all rounds so far lead to.
  void add_round(const double* velocity, ContactForces& forces);

 private:
  struct Impact {
    const ContactTouch* touch = nullptr;
    double mass = 0.0, wanted = 0.0;  // that moves [kg]; closing speed that is left [m/s]
    double push = 0.0;  // so far [N s]
    bool carried = false;  // by the facet, in rounds of this kind
    double first_excess = 0.0;  // of the closing speed in the first round, or 0 [m/s]
    double excess = 0.0;  // closing speed above the wanted one, in this round; not below what the push allows [m/s]
    Vec3 grip = {};  // of friction, so far [N s]
  };
  Vec3 friction(const Impact& impact, const ContactTouch& touch, Vec3 sliding) const;
  bool load(const double* velocity, ContactForces& forces, bool first);
  Vec3 carried_along(int corner) const;
  void carry(const double* velocity, ContactForces& forces);
  double share_of_carrying(const ContactTouch& touch) const;
  void hit(Impact& impact, const double* velocity, ContactForces& forces, double part) const;
  double part_of_mass(int node) const { return view_.mass[node] / split_.roles(node); }
  double load_of(int corner) const {
    return static_cast<double>(loads_[4 * static_cast<std::size_t>(corner) + 3]) * split_.quantum;
  }

  /// A round may solve up to this times what is left; 2 would be unstable.
  static constexpr double greatest_factor = 4.0 / 3.0;

  const ContactView& view_;
  ContactResponse response_;
  MassSplit split_;
  ForceScale scale_;
  double first_excess_ = 0.0;  // of the pace [m/s]
  const std::vector<std::int32_t>& active_;
  std::vector<Impact> impacts_;
  /// Per node, what it carries: momentum over kick_dt [force quanta], mass [mass quanta].
  std::vector<std::int64_t> loads_;
};

}  // namespace kerf
