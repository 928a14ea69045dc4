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

 private:
  void add_to(std::int64_t* sums, const ContactTouch& touch, const std::int32_t* facet_nodes, Vec3 force);

  std::int64_t *force_, *friction_;
  ForceScale scale_;
  int overflow_node_ = -1;
};

/// How the masses of nodes are split between touches, in whole quanta: a sum that does not depend on any order.
struct MassSplit {
  std::int64_t* shares;  // per node of the view: sum of the shares of all touches [mass quanta]
  double quantum;  // [kg]
};

/// Adds what each touch asks of the masses of its nodes.
void add_shares(const ContactView& view, const ContactTouches& touches, const MassSplit& split);

/// The impacts of all touches of this rank. Since they are computed side by side, one round leaves some of the closing
/// speed where touches share nodes; further rounds take that away (projected Jacobi iteration).
/// Momentum between rounds would make fewer of them do, but its overshoots make mismatched meshes buckle.
class Impacts {
 public:
  static constexpr int rounds = 8;  // in a step
  /// `split` has the shares of the touches of all ranks. The view must outlive this.
  Impacts(const ContactView& view, const ContactTouches& touches, const ContactResponse& response,
          const MassSplit& split);
  /// Adds the forces of one more round, given the velocities that the forces of all rounds so far lead to.
  void add_round(const double* velocity, ContactForces& forces);

 private:
  struct Impact {
    const ContactTouch* touch = nullptr;
    double mass = 0.0, wanted = 0.0;  // that moves [kg]; closing speed that is left [m/s]
    double push = 0.0;  // so far [N s]
    Vec3 grip = {};  // of friction, so far [N s]
  };
  Vec3 friction(const Impact& impact, const ContactTouch& touch, Vec3 sliding) const;

  const ContactView& view_;
  ContactResponse response_;
  MassSplit split_;
  std::vector<Impact> impacts_;
};

}  // namespace kerf
