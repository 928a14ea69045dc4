// Field by field, from blocked element arrays to plain rows.
#include "report/field_values.hpp"

#include <algorithm>
#include <tuple>

namespace kerf {

namespace {

void read_component(const Field& field, int block, int component, double* row) {
  const std::size_t first = field.index(block * lane_width, component);
  if (field.is_single)
    std::copy_n(&field.single_data[first], lane_width, row);
  else
    std::copy_n(&field.data[first], lane_width, row);
}

/// A block of a store as the formulas of output fields see it.
class RowsOfBlock final : public ElementRows {
 public:
  RowsOfBlock(const PartStore& store, int block) : store_(store), block_(block) {}
  void read(Quantity quantity, int component, double* row) const override {
    constexpr PartStore::FieldIndex stored[] = {PartStore::mass, PartStore::volume, PartStore::deviator,
                                                PartStore::pressure, PartStore::internal_energy};
    read_component(store_.field(stored[quantity]), block_, component, row);
  }

 private:
  const PartStore& store_;
  int block_;
};

}  // namespace

FieldOfPart::FieldOfPart(const PartStore& store, const std::string& name, double absent)
    : store_(store), field_(find_element_field(name)), absent_(absent) {
  if (field_ == nullptr) std::tie(place_, component_) = store.find_variable(name);
}

void FieldOfPart::fill(int block, double (*out)[lane_width]) const {
  if (field_ != nullptr)
    field_->fill(RowsOfBlock(store_, block), out);
  else if (place_ != PartStore::n_fields)
    read_component(store_.field(place_), block, component_, out[0]);
  else
    std::fill_n(out[0], lane_width, absent_);
}

void FieldOfPart::of_slot(int slot, double* out) const {
  alignas(64) double rows[6][lane_width];
  fill(slot / lane_width, rows);
  for (int c = 0; c < n_components(); ++c) out[c] = rows[c][slot % lane_width];
}

double* FieldOfPart::of_all(double* out) const {
  alignas(64) double rows[6][lane_width];
  const int n = n_components();
  for (int block = 0; block < store_.n_blocks(); ++block) {
    fill(block, rows);
    const int first = block * lane_width, used = std::min(lane_width, store_.n_slots() - first);
    for (int lane = 0; lane < used; ++lane) {
      if (!store_.live(first + lane)) continue;
      for (int c = 0; c < n; ++c) *out++ = rows[c][lane];
    }
  }
  return out;
}

std::string unit_of_field(const std::vector<PartModel>& parts, const std::string& name) {
  if (const ElementField* field = find_element_field(name)) return field->unit;
  for (const PartModel& part : parts) {
    const auto [place, component] = part.store->find_variable(name);
    if (place != PartStore::n_fields)
      return part.store->field(place).components[static_cast<std::size_t>(component)].unit;
  }
  return "-";
}

}  // namespace kerf
