// The one list of the fields that can be written, and how each follows from what is stored.
//
// A new field is one line of a table in output_fields.cpp and, where it is not stored as it stands, its formula there.
// Checks of the input, results.vtkhdf, observers and the manual are made from the tables.
#pragma once

#include <string>
#include <vector>

#include "kerf/math.hpp"

namespace kerf {

/// What is stored of every element, for a block of lane_width elements at a time.
class ElementRows {
 public:
  enum Quantity { mass, volume, deviator, pressure, internal_energy };  // [kg], [m3], [Pa], [Pa], [J]
  virtual ~ElementRows() = default;
  /// Fills lane_width values. Components of the deviator are xx, yy, zz, xy, yz, zx.
  virtual void read(Quantity quantity, int component, double* row) const = 0;
};

struct ElementField {
  const char *name, *unit;
  int n_components;  // 1, or 6 for a symmetric tensor
  const char* doc;  // half a sentence for the manual
  void (*fill)(const ElementRows& rows, double (*out)[lane_width]);  // n_components rows
};

/// What is known of a node.
struct NodeValues {
  Vec3 reference, position, velocity;  // [m], [m], [m/s]
  double mass = 0.0;  // [kg]
};

struct NodeField {
  const char *name, *unit;
  int n_components;  // 1 or 3
  const char* doc;
  void (*fill)(const NodeValues& node, double* out);
};

const std::vector<ElementField>& element_fields();
/// A field of results alone: the rank that owns an element. It depends on the ranks, so observers cannot have it. It
/// has no formula.
const ElementField& owner_field();
const std::vector<NodeField>& node_fields();
/// Null where there is no field of this name; state variables are none.
const ElementField* find_element_field(const std::string& name);
const NodeField* find_node_field(const std::string& name);
std::vector<std::string> element_field_names();
std::vector<std::string> node_field_names();

/// The names of a field's components: "stress_xx", "velocity_x", or the field's own name.
std::vector<std::string> component_names(const std::string& field, int n_components);

}  // namespace kerf
