// The contract of contact algorithms: from nodes, facets and candidate pairs to forces. No communication.
#pragma once

#include <cmath>
#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "kerf/element.hpp"
#include "kerf/math.hpp"
#include "kerf/plugin.hpp"

namespace kerf {

/// Begin and end of one slave's entries in a list.
struct ContactRow {
  std::int32_t begin = 0, end = 0;
};

/// The contact surface as one rank sees it. Lists of facets belonging to a node are sorted by facet id, so that
/// whatever a plugin sums or chooses along them is the same on any number of ranks; the order of nodes and facets
/// themselves means nothing, ties are broken by id. Which facets beyond their reach are listed varies, and some nodes
/// and facets are listed that no row refers to: a law must not let them matter. Positions and velocities have four
/// entries per node, on boundaries of 32 bytes.
struct ContactView {
  double dt = 0.0;  // of the step that has just been made; the next one is longer by `time.growth` at most [s]
  int n_nodes = 0;
  const std::int64_t* node_id = nullptr;
  const double *position = nullptr, *velocity = nullptr;  // [m], at mid-step [m/s]
  const double* mass = nullptr;  // [kg]
  const std::int32_t* node_part = nullptr;
  int n_facets = 0;
  const std::int64_t* facet_id = nullptr;  // element id * 8 + face
  const std::int32_t* facet_nodes = nullptr;  // [facet][4], counter-clockwise from outside
  const std::int32_t* facet_part = nullptr;
  const double* facet_bulk_modulus = nullptr;  // of the undeformed material [Pa]
  const double* facet_volume = nullptr;  // of the undeformed element [m3]
  const double* facet_edge = nullptr;  // longest one of the undeformed facet [m]
  int n_slaves = 0;
  const std::int32_t* slave = nullptr;  // nodes
  const ContactRow *candidate_rows = nullptr, *around_rows = nullptr;  // per slave
  const std::int32_t *candidate = nullptr, *around = nullptr;

  /// Facets that node slave[i] may touch until the next search.
  std::span<const std::int32_t> candidates_of(int i) const { return part_of(candidate, candidate_rows[i]); }
  /// Facets that hold node slave[i]; none for free nodes.
  std::span<const std::int32_t> around_slave(int i) const { return part_of(around, around_rows[i]); }
  Vec3 x(int node) const { return {position[4 * node], position[4 * node + 1], position[4 * node + 2]}; }
  Vec3 v(int node) const { return {velocity[4 * node], velocity[4 * node + 1], velocity[4 * node + 2]}; }

 private:
  static std::span<const std::int32_t> part_of(const std::int32_t* list, ContactRow row) {
    return {list + row.begin, list + row.end};
  }
};

/// Takes contact forces, node against facet, equal and opposite to the last bit.
class ContactForces {
 public:
  ContactForces(std::int64_t* force, ForceScale scale) : force_(force), scale_(scale) {}

  /// Adds `force` [N] to a node and its reaction, split by `weights`, to the four nodes of a facet.
  void add(int node, const std::int32_t* facet_nodes, const double (&weights)[4], Vec3 force) {
    for (int d = 0; d < 3; ++d) {
      std::int64_t sum = 0;
      for (int k = 0; k < 4; ++k) {
        const double share = force[d] * weights[k] * scale_.per_quantum;
        if (!(std::fabs(share) < ForceScale::limit)) {
          overflow_node_ = node;
          return;
        }
        const auto quanta = static_cast<std::int64_t>(std::llrint(share));
        force_[4 * facet_nodes[k] + d] -= quanta;
        sum += quanta;
      }
      force_[4 * node + d] += sum;
    }
    ++n_pairs_;
  }
  /// Local number of a node with a force that is not finite or too large, or -1.
  int overflow_node() const { return overflow_node_; }
  std::int64_t n_pairs() const { return n_pairs_; }

 private:
  std::int64_t* force_;
  ForceScale scale_;
  int overflow_node_ = -1;
  std::int64_t n_pairs_ = 0;
};

/// What a definition brings into contact, in terms of parts and node sets; resolved by the engine.
struct ContactRequest {
  std::vector<std::string> slaves, masters;  // parts or sets; empty for all parts
  bool symmetric = false;  // masters' nodes against slaves' facets as well
  bool same_part = false;  // nodes against facets of their own part
  bool free_nodes = false;  // nodes without live elements take part
};

/// What is known about a facet before the next search.
struct FacetBounds {
  double edge = 0.0;  // longest one of the undeformed facet [m]
  double longest_edge = 0.0;  // that the facet's edges will not exceed [m]
  double thickness = 0.0;  // that the lesser of V/A and the longest edge will not exceed; V/A has no bound [m]
};

class Contact : public Plugin {
 public:
  virtual ContactRequest request() const = 0;
  /// Distance from a facet within which a node must be a candidate [m]. What nodes move until the next search comes on
  /// top. The bounds of longest edge and thickness foresee the worst, and may be far above what facets come to.
  virtual double reach(const FacetBounds& facet) const = 0;
  virtual void add_forces(const ContactView& view, ContactForces& forces) const = 0;
  /// Largest depth of a node below the surface at the start, over the facet's thickness, and who it is; for the
  /// check of initial penetration. Returns the number of penetrating slaves.
  virtual int penetrations(const ContactView& view, std::vector<int>& nodes, std::vector<double>& depths) const = 0;
  /// Names of parts and sets used, for validation.
  std::vector<std::string> references() const {
    const ContactRequest r = request();
    std::vector<std::string> names = r.slaves;
    names.insert(names.end(), r.masters.begin(), r.masters.end());
    return names;
  }
  /// Cycles that candidates are looked for ahead.
  std::int64_t search_interval = 10;
};

}  // namespace kerf
