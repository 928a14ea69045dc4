// The interface of measures: numbers about the final state that go to summary.json. Plugins of kind "measure".
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "kerf/math.hpp"
#include "kerf/plugin.hpp"
#include "kerf/shape.hpp"

namespace kerf {

/// The elements and nodes of the model, gathered on rank 0 and sorted by global id. A node's place in the list is its
/// global id. A node that was dropped from the model has id -1 and no mass; its last position and velocity are unknown.
struct MeasureModel {
  std::vector<std::string> parts;
  struct Node {
    std::int64_t id = 0;
    int part = 0;  // of several parts that share the node, the first; see belongs_to() and mass_in()
    bool free = false;  // no live element left
    double mass = 0.0;  // [kg]
    Vec3 reference;  // undeformed position [m]
    Vec3 position, velocity;  // [m], [m/s]
    std::int32_t first_share = -1;  // index into `shares`, where those of the node follow one another; -1 for none
  };
  /// A part that shares a node with others, and what its undeformed elements give to the node's mass.
  struct Share {
    std::int64_t node = 0;
    int part = 0;
    double mass = 0.0;  // [kg]
  };
  struct Element {
    std::int64_t id = 0;
    int part = 0;
    double mass = 0.0;  // [kg]
    std::array<std::int32_t, Shape::most_nodes> nodes{};  // indices into `nodes`
    const Shape* shape = &hexahedron;
  };
  /// The nodes that an element has.
  static std::span<const std::int32_t> nodes_of(const Element& e) {
    return {e.nodes.data(), static_cast<std::size_t>(e.shape->n_nodes)};
  }
  /// Whether elements of a part touch a node, or did before they eroded.
  bool belongs_to(const Node& n, int part) const { return share_of(n, part) != nullptr || unshared_in(n, part); }
  /// The mass of a node that comes from a part [kg]: sums over all nodes of it are exact for parts that share nodes.
  double mass_in(const Node& n, int part) const {
    const Share* share = share_of(n, part);
    if (share != nullptr) return n.mass > 0.0 ? share->mass : 0.0;
    return unshared_in(n, part) ? n.mass : 0.0;
  }
  std::vector<Node> nodes;
  std::vector<Share> shares;  // of nodes that several parts share, by node and part
  std::vector<Element> elements;  // live ones
  std::vector<Element> eroded;  // elements that have eroded, with mass zero
  std::vector<double> initial_mass;  // per part [kg]

 private:
  static bool unshared_in(const Node& n, int part) { return n.first_share < 0 && n.part == part; }
  const Share* share_of(const Node& n, int part) const {
    if (n.first_share < 0) return nullptr;
    const auto first = static_cast<std::size_t>(n.first_share);
    for (std::size_t k = first; k < shares.size() && shares[k].node == shares[first].node; ++k)
      if (shares[k].part == part) return &shares[k];
    return nullptr;
  }
};

/// One number of a measure, or the reason why there is none.
struct MeasuredValue {
  std::string name;  // appended to the user's label ("hole" -> "hole.entry_area"); empty for the label itself
  double value = 0.0;  // NaN where it cannot be known; summary.json then says null
  std::string reason = {};  // why it cannot be known: half a sentence, such as "no element of part rod is left"
};

using MeasuredValues = std::vector<MeasuredValue>;

class Measure : public Plugin {
 public:
  /// Parts that are measured, for validation.
  virtual std::vector<std::string> references() const = 0;
  /// Called on rank 0. A value that cannot be known is NaN and has a reason; zero means that zero was measured.
  virtual MeasuredValues evaluate(const MeasureModel& model) const = 0;
};

}  // namespace kerf

KERF_SIZES(measure, KERF_SIZE(MeasureModel), KERF_SIZE(MeasureModel::Node), KERF_SIZE(MeasureModel::Share),
           KERF_SIZE(MeasureModel::Element), KERF_SIZE(MeasuredValue), KERF_SIZE(Measure))
