// The contract of contact algorithms: from nodes, facets and candidate pairs to touches. No communication.
#pragma once

#include <cmath>
#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "kerf/math.hpp"
#include "kerf/plugin.hpp"

namespace kerf {

/// Begin and end of one slave's entries in a list.
struct ContactRow {
  std::int32_t begin = 0, end = 0;
};

/// The contact surface as one rank sees it. Lists of facets belonging to a node are sorted by facet id, so that
/// whatever a plugin sums or chooses along them is the same on any number of ranks; the order of nodes and facets
/// themselves means nothing, ties are broken by id. The lists may hold facets beyond their reach, and nodes and facets
/// that no row uses. Which ones depends on the search and on the ranks, so a law must give the same result with and
/// without them. Positions and velocities have four entries per node, on boundaries of 32 bytes; the fourth one of a
/// position says which axes boundary conditions hold.
///
/// Positions and velocities are predicted: the velocity that a node will have in the coming step if contact does
/// nothing, and where the node will then be at the end of that step. A law thus sees a touch before it happens.
struct ContactView {
  double dt = 0.0;  // the coming step: positions will advance by this [s]
  double kick_dt = 0.0;  // velocities will advance by forces times this [s]
  int n_nodes = 0;
  const std::int64_t* node_id = nullptr;
  const double *position = nullptr, *velocity = nullptr;  // predicted [m], [m/s]
  const double* mass = nullptr;  // [kg]
  const std::int32_t* node_body = nullptr;  // a part, or all parts that are joined with one another: the first of them
  int n_facets = 0;
  const std::int64_t* facet_id = nullptr;  // number of the element * 8 + face; elements are numbered body by body
  const std::int32_t* facet_nodes = nullptr;  // [facet][4], counter-clockwise from outside
  const std::int32_t* facet_body = nullptr;
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
  /// Axes along which boundary conditions hold a node, as bits.
  unsigned held_axes(int node) const {
    return static_cast<unsigned>(position[4 * static_cast<std::int64_t>(node) + 3]);
  }
  /// What a force along `direction` moves of a node: 1, or less where boundary conditions hold it.
  double mobility(int node, Vec3 direction) const {
    const unsigned held = held_axes(node);
    if (held == 0) return 1.0;
    double moved = 0.0;
    for (int d = 0; d < 3; ++d) moved += (held >> d & 1u) != 0 ? 0.0 : direction[d] * direction[d];
    return moved;
  }
  Vec3 v(int node) const { return {velocity[4 * node], velocity[4 * node + 1], velocity[4 * node + 2]}; }

 private:
  static std::span<const std::int32_t> part_of(const std::int32_t* list, ContactRow row) {
    return {list + row.begin, list + row.end};
  }
};

/// A node, or a point of an edge between two nodes, that will be inside of a body at the end of the coming step if
/// contact does nothing.
struct ContactTouch {
  std::int32_t node = 0, facet = 0;  // numbers in the view
  double weights[4] = {};  // of the facet's corners at the closest point; their sum is 1
  Vec3 direction;  // unit vector out of the body
  double depth = 0.0;  // below the surface, along `direction` [m]
  double stiffness = 0.0;  // with which a depth that is there already is taken back [N/m]
  bool carried = false;  // whether the facet may carry the node; it should, where the node's mesh is the finer one
  std::int32_t second = -1;  // the edge's other node, or -1 where a node touches
  double second_weight = 0.0;  // of the edge's other node at the touching point; `node` has the rest of 1
};

/// What a law finds in one step.
class ContactTouches {
 public:
  void add(const ContactTouch& touch) { touches_.push_back(touch); }
  /// To be called for a node that comes to lie deeper than the law can hold it [m].
  void let_go(int node, double depth) { let_go_.push_back({node, depth}); }
  /// A pair that closes may travel no farther than `way` [m] in a step; it closes at `speed` [m/s].
  void limit_step(double way, double speed) {
    if (speed > 0.0) longest_step_ = min_of(longest_step_, way / speed);
  }
  void clear() { *this = {}; }

  struct LetGo {
    std::int32_t node = 0;
    double depth = 0.0;  // [m]
  };
  const std::vector<ContactTouch>& touches() const { return touches_; }
  const std::vector<LetGo>& all_let_go() const { return let_go_; }
  double longest_step() const { return longest_step_; }  // [s]

 private:
  std::vector<ContactTouch> touches_;
  std::vector<LetGo> let_go_;
  double longest_step_ = 1e300;
};

/// How touches are answered; the same for all touches of a definition.
struct ContactResponse {
  double restitution = 0.0;  // greatest speed at which a depth is taken back, over the speed at which the pair closed
  double stability = 0.4;  // upper bound of a touch's stiffness, in units of effective mass over dt squared
  double friction = 0.0;  // Coulomb coefficient
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
  double longest_edge = 0.0;  // upper bound of the facet's edges until the next search [m]
  double thickness = 0.0;  // upper bound, until the next search, of min(V/A, longest edge) [m]; V/A alone has none
};

class Contact : public Plugin {
 public:
  virtual ContactRequest request() const = 0;
  /// Distance from a facet within which a node must be a candidate [m]. What nodes move until the next search comes on
  /// top. The bounds of longest edge and thickness foresee the worst, and may be far above what facets come to.
  virtual double reach(const FacetBounds& facet) const = 0;
  /// Distance from a facet within which the law bounds the step for a node that closes in on it [m]. Nothing may travel
  /// farther than that in a step.
  virtual double sight(const FacetBounds& facet) const { return reach(facet); }
  /// Adds the touches of all slaves of the view, in any order.
  virtual void find_touches(const ContactView& view, ContactTouches& touches) const = 0;
  virtual ContactResponse response() const = 0;
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

KERF_SIZES(contact, KERF_SIZE(ContactRow), KERF_SIZE(ContactView), KERF_SIZE(ContactTouch), KERF_SIZE(ContactTouches),
           KERF_SIZE(ContactTouches::LetGo), KERF_SIZE(ContactResponse), KERF_SIZE(ContactRequest),
           KERF_SIZE(FacetBounds), KERF_SIZE(Contact))
