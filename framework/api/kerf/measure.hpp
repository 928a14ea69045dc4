// The interface of measures: numbers about the final state that go to summary.json. Plugins of kind "measure".
#pragma once

#include <array>
#include <cstdint>
#include <string>
#include <utility>
#include <vector>

#include "kerf/math.hpp"
#include "kerf/plugin.hpp"

namespace kerf {

/// The live elements and all nodes of the model, gathered on rank 0 and sorted by global id. A node's id is its place
/// in the list; one that no rank holds any more has id and part -1.
struct MeasureModel {
  std::vector<std::string> parts;
  struct Node {
    std::int64_t id = 0;
    int part = 0;
    bool free = false;  // no live element left
    double mass = 0.0;  // [kg]
    Vec3 reference, position, velocity;
  };
  struct Element {
    std::int64_t id = 0;
    int part = 0;
    double mass = 0.0;  // [kg]
    std::array<std::int32_t, 8> nodes{};  // indices into `nodes`
  };
  std::vector<Node> nodes;
  std::vector<Element> elements;
  std::vector<double> initial_mass;  // per part [kg]
};

class Measure : public Plugin {
 public:
  /// Parts that are measured, for validation.
  virtual std::vector<std::string> references() const = 0;
  /// Called on rank 0. Names are appended to the user's label ("hole" -> "hole.entry_largest"); an empty name
  /// stands for the label itself. NaN means "cannot be measured" and becomes null.
  virtual std::vector<std::pair<std::string, double>> evaluate(const MeasureModel& model) const = 0;
};

}  // namespace kerf
