// The tables of output fields and the formulas behind them.
#include "input/output_fields.hpp"

#include <algorithm>

#include "kerf/lanes.hpp"

namespace kerf {

namespace {

using Row = double[lane_width];

void stress(const ElementRows& rows, Row* out) {
  alignas(64) Row pressure;
  rows.read(ElementRows::pressure, 0, pressure);
  for (int c = 0; c < 6; ++c) rows.read(ElementRows::deviator, c, out[c]);
  for (int c = 0; c < 3; ++c)
    for (int l = 0; l < lane_width; ++l) out[c][l] -= pressure[l];
}

/// sqrt(3/2 s:s). By each_piece: which lane an element has depends on its rank, and a plain loop may be compiled so
/// that lanes round differently.
void von_mises(const ElementRows& rows, Row* out) {
  alignas(64) Row s[6];
  for (int c = 0; c < 6; ++c) rows.read(ElementRows::deviator, c, s[c]);
  each_piece([&](int lane) {
    Lanes squares{};
    for (int c = 0; c < 6; ++c) {
      const Lanes component = load_lanes(s[c] + lane);
      squares += (c < 3 ? 1.5 : 3.0) * component * component;
    }
    store_lanes(out[0] + lane, sqrt_of(squares));
  });
}

void quotient(const ElementRows& rows, ElementRows::Quantity over, ElementRows::Quantity under, Row* out) {
  alignas(64) Row divisor;
  rows.read(over, 0, out[0]);
  rows.read(under, 0, divisor);
  for (int l = 0; l < lane_width; ++l) out[0][l] /= divisor[l];
}

void pressure(const ElementRows& rows, Row* out) { rows.read(ElementRows::pressure, 0, out[0]); }
void density(const ElementRows& rows, Row* out) { quotient(rows, ElementRows::mass, ElementRows::volume, out); }
void internal_energy(const ElementRows& rows, Row* out) {
  quotient(rows, ElementRows::internal_energy, ElementRows::mass, out);
}

void put(Vec3 v, double* out) {
  for (int d = 0; d < 3; ++d) out[d] = v[d];
}
void velocity(const NodeValues& node, double* out) { put(node.velocity, out); }
void displacement(const NodeValues& node, double* out) { put(node.position - node.reference, out); }
void mass(const NodeValues& node, double* out) { *out = node.mass; }

template <class Field>
std::vector<std::string> names_of(const std::vector<Field>& fields) {
  std::vector<std::string> names;
  for (const Field& field : fields) names.push_back(field.name);
  return names;
}

template <class Field>
const Field* find(const std::vector<Field>& fields, const std::string& name) {
  const auto found = std::find_if(fields.begin(), fields.end(), [&](const Field& f) { return f.name == name; });
  return found == fields.end() ? nullptr : &*found;
}

}  // namespace

const std::vector<ElementField>& element_fields() {
  static const std::vector<ElementField> fields = {
      {"stress", "Pa", 6, "Cauchy stress xx, yy, zz, xy, yz, zx; tension positive; without bulk viscosity", &stress},
      {"pressure", "Pa", 1, "compression positive; without bulk viscosity", &pressure},
      {"density", "kg/m3", 1, "mass over present volume", &density},
      {"internal_energy", "J/kg", 1, "per mass, with the work of bulk viscosity", &internal_energy},
      {"von_mises", "Pa", 1, "equivalent stress, sqrt(3/2 s:s)", &von_mises},
  };
  return fields;
}

const ElementField& owner_field() {
  static const ElementField field = {"owner", "-", 1, "rank that owns the element; in results only", nullptr};
  return field;
}

const std::vector<NodeField>& node_fields() {
  static const std::vector<NodeField> fields = {
      {"velocity", "m/s", 3, "at the middle of the last step", &velocity},
      {"displacement", "m", 3, "position less that at time zero after placement", &displacement},
      {"mass", "kg", 1, "lumped from the elements", &mass},
  };
  return fields;
}

const ElementField* find_element_field(const std::string& name) { return find(element_fields(), name); }
const NodeField* find_node_field(const std::string& name) { return find(node_fields(), name); }
std::vector<std::string> element_field_names() { return names_of(element_fields()); }
std::vector<std::string> node_field_names() { return names_of(node_fields()); }

std::vector<std::string> component_names(const std::string& field, int n_components) {
  if (n_components == 1) return {field};
  std::vector<std::string> names;
  for (const char* c : {"x", "y", "z"})
    if (n_components == 3) names.push_back(field + "_" + c);
  for (const char* c : {"xx", "yy", "zz", "xy", "yz", "zx"})
    if (n_components == 6) names.push_back(field + "_" + c);
  return names;
}

}  // namespace kerf
