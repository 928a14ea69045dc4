// Contact by brute force: every node against every facet, whatever is near, on one rank.
#pragma once

#include <array>
#include <cstdint>
#include <map>
#include <string>
#include <vector>

#include "contact/impacts.hpp"
#include "kerf/contact.hpp"
#include "model/aligned.hpp"
#include "model/step.hpp"
#include "parallel/global_model.hpp"

namespace kerf::test {

/// A node inside a live element that it does not belong to.
struct Intruder {
  std::int64_t node = 0, element = 0;
  bool own_part = false, free = false;
  bool pushed = false;  // whether the law finds a touch
  double depth = 0.0;  // to the closest exterior facet of the element's part, over the least of the facet's thickness,
                       // longest edge and that of the undeformed one: what eroding_surface measures its window by
};

/// The contact surface of a whole model as a law sees it, with all facets as candidates of every slave, but for
/// what the documentation of CandidateSearch excludes: roles that do not match, and within one part facets whose
/// element shares a node with the facets round the slave.
class BruteContact {
 public:
  /// Slaves and masters of the law must be parts, not sets. All arguments must outlive this.
  BruteContact(const GlobalModel& global, const std::vector<PartModel>& parts, const Contact& law);

  /// Moves all nodes to where they will be at the end of a step if contact does nothing. `contact` is the share of
  /// contact in the nodes' forces. Pre: no boundary conditions.
  void predict(const std::map<std::int64_t, std::array<std::int64_t, 3>>& contact, const Quanta& quanta,
               const Step& next);
  /// Forces of contact on all nodes, in quanta, by node id; nodes without force are left out. To be called after
  /// `predict`.
  std::map<std::int64_t, std::array<std::int64_t, 3>> forces(const Quanta& quanta, const ImpactPace& pace) const;
  /// All slaves that are inside elements of other parts, and of their own part where they share no node with the
  /// ring round them.
  std::vector<Intruder> intruders() const;

  /// Whether the law finds a touch of this slave.
  bool is_pushed(std::int64_t node) const;

 private:
  struct Hexahedron {
    Vec3 x[8], centre, low, high;
    explicit Hexahedron(const GlobalModel& global, const GlobalElement& e);
    bool holds(Vec3 p) const;
  };
  ContactView view() const;
  bool row_is_pushed(std::size_t row) const;
  double depth_below_surface(Vec3 p, int part) const;
  Vec3 undeformed(std::int64_t node) const;
  void list_nodes();
  void list_facets();
  void list_pairs();
  unsigned role(int part, const std::vector<std::string>& names) const;

  const GlobalModel& global_;
  const std::vector<PartModel>& parts_;
  const Contact& law_;
  ContactRequest request_;
  std::map<std::int64_t, std::int32_t> number_;  // of node ids
  std::vector<std::int64_t> node_id_, facet_id_;
  double dt_ = 0.0, kick_dt_ = 0.0;  // of the step that is predicted [s]
  AlignedVector<double> position_, velocity_;
  std::vector<double> mass_, bulk_modulus_, volume_, edge_;
  std::vector<std::int32_t> node_body_, facet_nodes_, facet_opposite_, facet_body_;
  std::vector<std::int32_t> slave_, candidate_, around_;
  std::vector<ContactRow> candidate_rows_, around_rows_;
  std::vector<std::vector<std::int32_t>> facets_of_node_;
  std::vector<std::vector<std::int32_t>> ring_;  // per slave: nodes of the facets round it
};

}  // namespace kerf::test
