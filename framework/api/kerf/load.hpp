// The contract of loads: forces on nodes, on exterior facets, and on the mass of bodies.
//
// A load derives from NodalLoad, FacetLoad or BodyLoad and says what acts at one time. The engine finds the nodes and
// facets, adds the forces, and books their work and impulse as external. Positions belong to the time at which the
// forces act, velocities to the middle of the step before.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "kerf/curve.hpp"
#include "kerf/math.hpp"
#include "kerf/plugin.hpp"

namespace kerf {

/// What acts on a model from outside. Laws are const and give the same bits for the same input.
class Load : public Plugin {
 public:
  /// Parts or sets that it acts on; empty for the whole model.
  virtual std::vector<std::string> targets() const = 0;
  /// Upper bound, during the run, of the magnitude of what the law returns, in its unit. Nothing where it is not known:
  /// the run then stops where a force is out of all proportion to what the materials can bear.
  virtual std::optional<double> greatest() const { return std::nullopt; }
  /// Whether the law reads `reference_position`, which is zero otherwise: finding it costs time and memory.
  virtual bool reads_reference_position() const { return false; }
  std::vector<std::string> references() const { return targets(); }
};

/// A node as a load sees it.
struct LoadedNode {
  std::int64_t id = 0;
  double mass = 0.0;  // [kg]
  Vec3 position, velocity;  // [m], [m/s]
  Vec3 reference_position;  // in the undeformed model [m]; see Load::reads_reference_position
  double time_step = 0.0;  // of the step that ends at the time of the force; 0 before the first step [s]
};

/// A force on every node of the targets that belongs to an element which has not been eroded.
class NodalLoad : public Load {
 public:
  /// On one node [N].
  virtual Vec3 force(const LoadedNode& node, double time) const = 0;
};

/// A force per mass on all nodes of the targets, point masses that erosion has left among them.
class BodyLoad : public Load {
 public:
  /// [m/s2]
  virtual Vec3 acceleration(const LoadedNode& node, double time) const = 0;
};

/// An exterior facet as a load sees it: means over its corners, of which a triangle counts the last one twice.
struct LoadedFacet {
  std::int64_t id = 0;  // of the element times Shape::code_of_faces plus the face
  double area = 0.0;  // [m2]
  Vec3 normal;  // mean outward normal of length one
  Vec3 position, velocity;  // [m], [m/s]
  Vec3 reference_position;  // in the undeformed model [m]; see Load::reads_reference_position
};

/// Force per present area of a facet.
struct FacetForce {
  double pressure = 0.0;  // against the normal at every point of the facet [Pa]
  Vec3 traction;  // beside it, in any direction [Pa]
};

/// A pressure or traction on the exterior facets of parts, or of sets that hold all corners of a facet. What lies on a
/// plane of symmetry is not exterior. Facets are chosen at time zero.
class FacetLoad : public Load {
 public:
  virtual FacetForce force(const LoadedFacet& facet, double time) const = 0;
  /// Why the law cannot load a facet, as "a scaled distance of 50, outside of the table"; empty where it can. Asked of
  /// every facet before the first step: a text is an error of the input. What the run brings later, force() may throw.
  virtual std::string objection(const LoadedFacet&) const { return {}; }
  /// Whether the load can push a facet before the time `end` [s] of the run's end, from its place before the first
  /// step. Where it can push none of its facets at any time, the input is refused; where none before the end, a warning
  /// tells.
  virtual bool can_reach(const LoadedFacet&, double /*end*/) const { return true; }
  /// Whether the facets that the erosion of a loaded element uncovers are loaded from then on.
  virtual bool follows_erosion() const { return false; }
};

}  // namespace kerf

KERF_SIZES(load, KERF_SIZE(Load), KERF_SIZE(LoadedNode), KERF_SIZE(NodalLoad), KERF_SIZE(BodyLoad),
           KERF_SIZE(LoadedFacet), KERF_SIZE(FacetForce), KERF_SIZE(FacetLoad))
