// The contract of boundary conditions: constraints on nodal velocities.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "kerf/math.hpp"
#include "kerf/plugin.hpp"

namespace kerf {

/// A node as a boundary condition sees it in one step.
struct BoundaryNode {
  std::int64_t id = 0;
  double mass = 0.0;  // [kg]
  Vec3 position;  // at the start of the step [m]
  Vec3 old_velocity;  // at the middle of the step before [m/s]
  Vec3 reference_position;  // in the undeformed model [m]
};

struct BoundaryStep {
  double time = 0.0;  // at the middle of the step [s]
  double dt = 0.0;  // from the start to the end of the step [s]
};

/// The size of the undeformed model, from which tolerances follow.
struct MeshScale {
  double shortest_edge = 0.0;  // of all elements [m]
  double farthest = 0.0;  // greatest coordinate of all nodes, as an absolute value [m]

  /// What is far below any cell, and above the round-off of placing its nodes [m].
  double tolerance() const { return 1e-6 * shortest_edge + 16.0 * 0x1p-52 * farthest; }
};

/// The half-space dot(normal, x) < offset; `normal` need not be a unit vector.
struct HalfSpace {
  Vec3 normal;
  double offset = 0.0;
};

/// Constrains the velocity that carries a node from the start to the end of a step. The engine accounts for
/// the impulse and the work of whatever is changed.
class Boundary : public Plugin {
 public:
  /// Parts or sets whose nodes are constrained; empty for all nodes.
  virtual std::vector<std::string> nodes() const = 0;
  /// Takes note of the size of the model. Called once, on every rank, before anything else is asked.
  virtual void prepare(const MeshScale&) {}
  /// Velocity of a node at time zero, given what it would be otherwise.
  virtual Vec3 initial(const BoundaryNode&, Vec3 velocity) const { return velocity; }
  /// When a node is to be asked, given where it was in the undeformed model.
  enum class Ask {
    never,  // conditions that act at time zero only
    near_region,  // in steps whose free flight would end in the region below (walls): spares all other nodes
    always
  };
  virtual Ask ask(Vec3 /*reference_position*/) const { return Ask::always; }
  /// The region of Ask::near_region at the end of a step.
  virtual HalfSpace region(double /*time*/) const { return {}; }
  /// Whether a point lies on a plane behind which the body goes on as its mirror image. A facet with all corners on
  /// it is no surface that contact may see.
  virtual bool mirrors(Vec3 /*position*/) const { return false; }
  virtual Vec3 constrain(const BoundaryNode& node, const BoundaryStep& step, Vec3 velocity) const = 0;
  /// What is wrong with a node that cannot start as it stands, as "starts 2 m behind the wall; move the wall": messages
  /// put the node and its place before it. Empty where all is well.
  virtual std::string complaint(const BoundaryNode&) const { return {}; }
  std::vector<std::string> references() const { return nodes(); }
};

/// A boundary condition whose nodes are listed under the key `nodes`, which describe_nodes declares.
class NamedNodesBoundary : public Boundary {
 public:
  std::vector<std::string> names;
  std::vector<std::string> nodes() const override { return names; }

 protected:
  template <class S>
  static void describe_nodes(S& s) {
    s.texts(&NamedNodesBoundary::names, "nodes", "parts or sets whose nodes are meant; all nodes where absent")
        .optional();
  }
};

}  // namespace kerf

KERF_SIZES(boundary, KERF_SIZE(BoundaryNode), KERF_SIZE(BoundaryStep), KERF_SIZE(MeshScale), KERF_SIZE(HalfSpace),
           KERF_SIZE(Boundary), KERF_SIZE(NamedNodesBoundary))
