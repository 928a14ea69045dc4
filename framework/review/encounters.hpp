// Who may meet whom during a run, as far as free flight from time zero tells.
#pragma once

#include <cstdint>
#include <limits>
#include <vector>

#include "model/distinct_lists.hpp"
#include "model/model.hpp"
#include "review/initial_overlap.hpp"

namespace kerf {

/// How a part starts. What holds, drives or loads a part that is joined with others does so to all of them.
struct PartStart {
  Vec3 low, high;  // corners of the box round it [m]
  Vec3 velocity;  // the middle of its nodes' velocities [m/s]
  double spread = 0.0;  // greatest difference of its nodes' velocities; 0 for a translation [m/s]
  bool is_held = false;  // a boundary condition that is no plane of symmetry acts on some of its nodes in every step
  bool is_driven = false;  // and moves them
  bool is_loaded = false;  // a load acts on it, or forces do already, or its material will: explosive

  bool rests() const { return norm(velocity) == 0.0 && spread == 0.0 && !is_driven; }
  /// Whether it flies on as it is until something stops it.
  bool flies() const { return spread == 0.0 && !is_driven && !is_held && !is_loaded; }
};

/// Never, as a time.
inline constexpr double never = std::numeric_limits<double>::infinity();

class Encounters {
 public:
  /// Pre: the forces of time zero are on the nodes. Collective, as is time_to_meet.
  Encounters(Model& model, const ContactCover& cover);

  const std::vector<PartStart>& parts() const { return parts_; }
  /// Time at which two parts in free flight come into contact: 0 where they touch, `never` where they miss one another
  /// [s]. Found along rays in the direction of flight; what is thinner than a 128th of their common shadow may be
  /// missed, so the true time may be a little less, and is never more.
  double time_to_meet(int part, int other) const;
  /// Time at which a boundary condition that acts in a region (a wall) gets hold of a part in free flight [s].
  double time_to_region(int part) const { return to_region_[static_cast<std::size_t>(part)]; }
  /// Whether something may reach a part before the end of the run. In doubt, yes. The same for all that only others
  /// that have met something could reach.
  bool may_be_touched(int part) const { return touched_[static_cast<std::size_t>(part)]; }
  /// Whether any condition acts on a local node in every step.
  bool is_bound(int node) const { return always_[static_cast<std::size_t>(node)] != 0; }
  /// Whether the boundary conditions keep a local node from moving along a direction of length one.
  bool holds(int node, Vec3 direction) const;

 private:
  void find_boundaries();
  void find_starts();
  void look_at_conditions(int node, double* of_part) const;
  void share_starts();
  void find_regions();
  void find_touched(const ContactCover& cover);
  bool boxes_may_meet(int part, int other) const;

  Model& model_;
  double end_ = 0.0;  // of the run [s]
  std::vector<PartStart> parts_;
  DistinctLists lists_;  // of conditions, as places in the input
  std::vector<std::int32_t> always_;  // per local node: the list of those that act on it in every step
  std::vector<double> to_region_;
  std::vector<bool> touched_;
};

}  // namespace kerf
