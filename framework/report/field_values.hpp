// Values of fields of elements, by name, from the stores of parts.
#pragma once

#include <string>
#include <vector>

#include "input/output_fields.hpp"
#include "model/model.hpp"

namespace kerf {

/// One field of one part: of the table of output fields, a quantity that every element has, or a state variable.
class FieldOfPart {
 public:
  /// A name that the part does not know is a state variable of another part; its values are `absent`.
  FieldOfPart(const PartStore& store, const std::string& name, double absent = 0.0);
  int n_components() const { return field_ != nullptr ? field_->n_components : 1; }
  /// Whether the part knows the field.
  bool known() const { return field_ != nullptr || place_ != PartStore::n_fields; }
  /// n_components() rows of a block.
  void fill(int block, double (*out)[lane_width]) const;
  /// The components of one element.
  void of_slot(int slot, double* out) const;
  /// What all live elements have, n_components() values one after another. Returns the end.
  double* of_all(double* out) const;

 private:
  const PartStore& store_;
  const ElementField* field_;
  PartStore::FieldIndex place_ = PartStore::n_fields;  // of a state variable
  int component_ = 0;
  double absent_;
};

/// Unit of a field, "-" where no part knows it.
std::string unit_of_field(const std::vector<PartModel>& parts, const std::string& name);

}  // namespace kerf
