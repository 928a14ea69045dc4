// The interface of measures: numbers about the final state that go to summary.json. Plugins of kind "measure".
#pragma once

#include <array>
#include <cstdint>
#include <functional>
#include <span>
#include <string>
#include <vector>

#include "kerf/math.hpp"
#include "kerf/plugin.hpp"
#include "kerf/shape.hpp"

namespace kerf {

/// The elements and nodes of one rank. Ranks share the nodes between their elements: every copy has the same bits, and
/// exactly one rank owns the node. Sums over the model take owned nodes only. A node that was dropped from the model
/// has no mass; its position and velocity mean nothing.
struct MeasureModel {
  std::vector<std::string> parts;
  struct Node {
    std::int64_t id = 0;  // the same on all ranks
    int part = 0;  // of several parts that share the node, the first; see belongs_to() and mass_in()
    bool free = false;  // no live element left, on any rank
    double mass = 0.0;  // [kg]
    Vec3 reference;  // undeformed position [m]
    Vec3 position, velocity;  // [m], [m/s]
    std::int32_t first_share = -1;  // index into `shares`, where those of the node follow one another; -1 for none
    bool owned = true;
    bool copied = false;  // whether other ranks may have the node too
  };
  /// A part that shares a node with others, and what its undeformed elements give to the node's mass.
  struct Share {
    std::int64_t node = 0;  // id
    int part = 0;
    double mass = 0.0;  // [kg]; known where the node is owned
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
  const Node& node(std::int32_t i) const { return nodes[static_cast<std::size_t>(i)]; }
  const Element& element(std::int32_t i) const { return elements[static_cast<std::size_t>(i)]; }
  /// Whether elements of a part touch a node, or did before they eroded.
  bool belongs_to(const Node& n, int part) const { return share_of(n, part) != nullptr || unshared_in(n, part); }
  /// The mass of a node that comes from a part [kg]; zero for a node that another rank owns. Sums over all nodes of all
  /// ranks are exact for parts that share nodes.
  double mass_in(const Node& n, int part) const {
    if (!n.owned) return 0.0;
    const Share* share = share_of(n, part);
    if (share != nullptr) return n.mass > 0.0 ? share->mass : 0.0;
    return unshared_in(n, part) ? n.mass : 0.0;
  }
  std::vector<Node> nodes;
  std::vector<Share> shares;  // of nodes that several parts share, by node and part
  std::vector<Element> elements;  // live ones, each on one rank
  std::vector<double> initial_mass;  // per part, of all ranks [kg]

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

/// How a measure asks the other ranks. All functions are collective: all ranks call them in the same order. What they
/// return is the same on all ranks, and the same bits on any number of them, unless something else is said.
class MeasureRanks {
 public:
  MeasureRanks() = default;
  MeasureRanks(const MeasureRanks&) = delete;
  MeasureRanks& operator=(const MeasureRanks&) = delete;
  virtual ~MeasureRanks() = default;

  /// Whether this is rank 0. Local.
  virtual bool is_root() const = 0;
  /// Sums over all terms of all ranks, list by list; NaN where a term is not finite.
  virtual std::vector<double> sums(const std::vector<std::span<const double>>& lists) = 0;
  /// Greatest and least values of all ranks, entry by entry; NaN counts as nothing.
  virtual std::vector<double> greatest(std::vector<double> values) = 0;
  virtual std::vector<double> least(std::vector<double> values) = 0;

  /// What several ranks may know of: a node by {id, -1, -1, -1}, a face by the ids of its nodes in ascending order.
  using Key = std::array<std::int64_t, 4>;
  /// For each key of this rank the least value, or the sum of the values, that any rank has given to that key.
  virtual std::vector<std::int64_t> least_by_key(const std::vector<Key>& keys,
                                                 const std::vector<std::int64_t>& values) = 0;
  virtual std::vector<std::int64_t> sums_by_key(const std::vector<Key>& keys,
                                                const std::vector<std::int64_t>& values) = 0;
  /// The bytes of all ranks, one rank after the other, on rank 0; nothing elsewhere. Use it for what is small beside
  /// the model.
  virtual std::vector<char> bytes_on_root(const std::vector<char>& bytes) = 0;

  /// The undeformed places of the nodes of a part, each on one rank, dropped ones as well [m]. Local.
  virtual std::vector<Vec3> undeformed_nodes(int part) = 0;
  /// An element as the mesh made it, eroded or not.
  struct UndeformedElement {
    std::int64_t id = 0;
    ElementNodeIds nodes{};
    CellCorners places{};
  };
  /// The shape of a part's elements. Local.
  virtual const Shape& shape(int part) const = 0;
  /// Calls `visit` with all undeformed elements of a part, each on one rank, in the order of their ids.
  virtual void visit_undeformed(int part, const std::function<void(const UndeformedElement&)>& visit) = 0;
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
  /// Called on all ranks together, each with its share of the model; the values of rank 0 are written, and other ranks
  /// may return nothing. A value that cannot be known is NaN and has a reason; zero means that zero was measured.
  /// Collective.
  virtual MeasuredValues evaluate(const MeasureModel& model, MeasureRanks& ranks) const = 0;
};

}  // namespace kerf

KERF_SIZES(measure, KERF_SIZE(MeasureModel), KERF_SIZE(MeasureModel::Node), KERF_SIZE(MeasureModel::Share),
           KERF_SIZE(MeasureModel::Element), KERF_SIZE(MeasureRanks), KERF_SIZE(MeasureRanks::UndeformedElement),
           KERF_SIZE(MeasuredValue), KERF_SIZE(Measure))
