// Allocation, packing and compaction of a part's element arrays: the one place that knows their layout.
#include "model/part_store.hpp"

#include "core/assert.hpp"

namespace kerf {

namespace {

StateVariable core(const char* name, const char* unit, double initial = 0.0) {
  StateVariable v;
  v.name = name;
  v.unit = unit;
  v.initial = initial;
  return v;
}

}  // namespace

PartStore::PartStore(int index, const Element& element, Variables variables, Precision precision)
    : shape_(&element.shape()), n_nodes_(shape_->n_nodes), index_(index), precision_(precision), fields_(n_fields) {
  const auto declare = [&](FieldIndex f, const char* name, std::vector<StateVariable> components) {
    fields_[f].name = name;
    fields_[f].n_components = static_cast<int>(components.size());
    fields_[f].components = std::move(components);
  };
  const auto where = [](bool wanted, std::vector<StateVariable> components) {
    return wanted ? std::move(components) : std::vector<StateVariable>{};
  };
  declare(mass, "mass", {core("mass", "kg")});
  declare(volume, "volume", {core("volume", "m3")});
  declare(deviator, "deviator",
          {core("deviator_xx", "Pa"), core("deviator_yy", "Pa"), core("deviator_zz", "Pa"), core("deviator_xy", "Pa"),
           core("deviator_yz", "Pa"), core("deviator_zx", "Pa")});
  declare(pressure, "pressure", {core("pressure", "Pa")});
  declare(internal_energy, "internal_energy", {core("internal_energy", "J")});
  declare(viscous_energy, "viscous_energy", {core("viscous_energy", "J")});
  declare(element_state, "element_state", element.state_variables());
  declare(material_state, "material_state", std::move(variables.material));
  declare(eos_state, "eos_state", std::move(variables.eos));
  declare(erosion_state, "erosion_state", std::move(variables.erosion));
  declare(place, "place",
          where(variables.place, {core("reference_x", "m"), core("reference_y", "m"), core("reference_z", "m"),
                                  core("initial_length", "m", 1.0)}));
  declare(softening, "softening",
          where(variables.softening, {core("next_strength_factor", "-", 1.0), core("next_tension_factor", "-", 1.0),
                                      core("next_compression_factor", "-", 1.0), core("strength_factor", "-", 1.0),
                                      core("tension_factor", "-", 1.0), core("compression_factor", "-", 1.0)}));
  declare(loaded_faces, "loaded_faces",
          std::vector<StateVariable>(static_cast<std::size_t>(variables.facet_loads), core("loaded_faces", "-")));
  // Those of ElementArrays<Real> whose type is Real.
  for (const FieldIndex f : {deviator, pressure, element_state})
    fields_[f].is_single = precision == Precision::single_precision;
  for (const Field& f : fields_) record_size_ += f.n_components;
}

void PartStore::pack(int slot, double* record) const {
  for (const Field& f : fields_)
    for (int c = 0; c < f.n_components; ++c) *record++ = f.at(slot, c);
}

void PartStore::initial_record(double element_mass, double* record) const {
  *record++ = element_mass;
  for (std::size_t f = 1; f < fields_.size(); ++f)
    for (const StateVariable& v : fields_[f].components) *record++ = v.initial;
}

void PartStore::set_initial_values(const double* record) {
  for (Field& f : fields_)
    for (StateVariable& v : f.components) v.initial = *record++;
}

int PartStore::offset(FieldIndex f) const {
  int first = 0;
  for (int k = 0; k < f; ++k) first += fields_[static_cast<std::size_t>(k)].n_components;
  return first;
}

void PartStore::resize(int n_slots) {
  ++arrangement_;
  n_slots_ = n_slots;
  const std::size_t padded = static_cast<std::size_t>(n_blocks()) * lane_width;
  ids_.assign(padded, -1);
  nodes_.assign(padded * static_cast<std::size_t>(n_nodes_), 0);
  for (Field& f : fields_) f.assign_zeros(padded * f.n_components);
}

void PartStore::clear_slot(int slot) {
  ids_[slot] = -1;
  for (int k = 0; k < n_nodes_; ++k) nodes_[node_index(slot, k)] = first_dummy_ + shape_->reference[k];
  for (Field& f : fields_)
    for (int c = 0; c < f.n_components; ++c) f.set(slot, c, f.components[c].initial);
  fields_[mass].set(slot, 0, dummy_mass_);
  fields_[volume].set(slot, 0, dummy_volume_);
}

void PartStore::make_room(int n_elements) {
  resize(n_elements);
  n_live_ = n_slots_;
}

void PartStore::release() {
  make_room(0);
  for (Field& f : fields_) {
    f.data.shrink_to_fit();
    f.single_data.shrink_to_fit();
  }
  nodes_.shrink_to_fit();
  ids_.shrink_to_fit();
}

void PartStore::put(int slot, std::int64_t id, const std::int32_t* nodes, const double* record) {
  ++arrangement_;
  ids_[slot] = id;
  for (int k = 0; k < n_nodes_; ++k) nodes_[node_index(slot, k)] = nodes[k];
  for (Field& f : fields_)
    for (int c = 0; c < f.n_components; ++c) f.set(slot, c, *record++);
}

void PartStore::set_dummies(std::int32_t first_dummy, double dummy_mass, double dummy_volume) {
  first_dummy_ = first_dummy;
  dummy_mass_ = dummy_mass;
  dummy_volume_ = dummy_volume;
  const int padded = n_blocks() * lane_width;
  for (int s = 0; s < padded; ++s)
    if (ids_[s] < 0) clear_slot(s);
}

void PartStore::retire(int slot, std::int32_t first_dummy) {
  KERF_ASSERT(ids_[slot] >= 0 && first_dummy == first_dummy_, "only live elements can be retired");
  clear_slot(slot);
  ++arrangement_;
  --n_live_;
}

std::vector<std::int32_t> PartStore::compact() {
  ++arrangement_;
  std::vector<std::int32_t> moved(static_cast<std::size_t>(n_slots_), -1);
  int next = 0;
  for (int s = 0; s < n_slots_; ++s) {
    if (ids_[s] < 0) continue;
    moved[s] = next;
    if (next != s) {
      ids_[next] = ids_[s];
      for (int k = 0; k < n_nodes_; ++k) nodes_[node_index(next, k)] = nodes_[node_index(s, k)];
      for (Field& f : fields_)
        for (int c = 0; c < f.n_components; ++c) f.set(next, c, f.at(s, c));
    }
    ++next;
  }
  const int padded = n_blocks() * lane_width;
  for (int s = next; s < padded; ++s) clear_slot(s);
  n_slots_ = next;
  const std::size_t kept = static_cast<std::size_t>(n_blocks()) * lane_width;
  ids_.resize(kept);
  nodes_.resize(kept * static_cast<std::size_t>(n_nodes_));
  for (Field& f : fields_) f.resize(kept * f.n_components);
  return moved;
}

std::pair<PartStore::FieldIndex, int> PartStore::find_variable(const std::string& name) const {
  for (int f = 0; f < n_fields; ++f)
    for (int c = 0; c < fields_[f].n_components; ++c)
      if (fields_[f].components[c].name == name) return {static_cast<FieldIndex>(f), c};
  return {n_fields, 0};
}

std::size_t PartStore::bytes() const {
  std::size_t total = ids_.capacity() * sizeof(std::int64_t) + nodes_.capacity() * sizeof(std::int32_t);
  for (const Field& f : fields_) total += f.bytes();
  return total;
}

}  // namespace kerf
