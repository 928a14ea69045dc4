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
    int part = 0;
    bool free = false;  // no live element left
    double mass = 0.0;  // [kg]
    Vec3 reference;  // undeformed position [m]
    Vec3 position, velocity;  // [m], [m/s]
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
  std::vector<Node> nodes;
  std::vector<Element> elements;  // live ones
  std::vector<Element> eroded;  // elements that have eroded, with mass zero
  std::vector<double> initial_mass;  // per part [kg]
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
