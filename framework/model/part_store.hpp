// Owns every array of the elements of one part on one rank, blocked for the element kernels, in the precision that
// these compute with.
//
// Slot s of a part is lane s % lane_width of block s / lane_width. A field with c components is stored as
// [block][component][lane]. Slots without an element (id -1) refer to the dummy nodes and are computed along.
#pragma once

#include <array>
#include <cstdint>
#include <string>
#include <type_traits>
#include <vector>

#include "core/assert.hpp"
#include "kerf/element.hpp"
#include "kerf/math.hpp"
#include "model/aligned.hpp"

namespace kerf {

/// What the elements of a model compute with. In single precision, stress and what elements keep for themselves are
/// floats; masses, volumes, energies and what laws keep are doubles always.
enum class Precision { double_precision, single_precision };

/// One array of a part: a quantity with a name per component. One of the two vectors is in use.
struct Field {
  std::string name;
  int n_components = 1;
  std::vector<StateVariable> components;  // names, units and initial values
  bool is_single = false;
  AlignedVector<double> data;
  AlignedVector<float> single_data;

  std::size_t index(int slot, int component) const {
    return (static_cast<std::size_t>(slot / lane_width) * n_components + component) * lane_width + slot % lane_width;
  }
  double at(int slot, int component) const {
    const std::size_t i = index(slot, component);
    return is_single ? static_cast<double>(single_data[i]) : data[i];
  }
  /// A float takes the nearest value.
  void set(int slot, int component, double value) {
    const std::size_t i = index(slot, component);
    if (is_single)
      single_data[i] = static_cast<float>(value);
    else
      data[i] = value;
  }
  /// All entries. Pre: Real is the type in use.
  template <class Real>
  Real* entries() {
    KERF_ASSERT(is_single == (std::is_same_v<Real, float>), "a field is read in its own precision");
    if constexpr (std::is_same_v<Real, float>)
      return single_data.data();
    else
      return data.data();
  }
  void resize(std::size_t n) { is_single ? single_data.resize(n) : data.resize(n); }
  void assign_zeros(std::size_t n) {
    resize(0);
    resize(n);
  }
  std::size_t bytes() const { return data.capacity() * sizeof(double) + single_data.capacity() * sizeof(float); }
};

class PartStore {
 public:
  /// Indices of the fields that every part has.
  enum FieldIndex {
    mass,
    volume,
    deviator,
    pressure,
    internal_energy,
    viscous_energy,
    element_state,
    material_state,
    eos_state,
    erosion_state,
    place,  // centre and cube root of volume before the first step, where a law asks for them
    softening,  // factors of the stress, where a criterion softens: see ElementArrays
    loaded_faces,  // per load on facets: a bit for each face that it acts on, as a whole number
    n_fields
  };

  /// What the laws of a part, and loads on it, keep.
  struct Variables {
    std::vector<StateVariable> material, eos, erosion;  // the first also of a solid
    bool place = false, softening = false;
    int facet_loads = 0;  // number of loads on facets
  };

  PartStore(int index, const Element& element, Variables variables, Precision precision = Precision::double_precision);

  int index() const { return index_; }
  const Shape& shape() const { return *shape_; }
  int n_nodes() const { return n_nodes_; }  // of an element
  Precision precision() const { return precision_; }
  int n_slots() const { return n_slots_; }
  int n_blocks() const { return (n_slots_ + lane_width - 1) / lane_width; }
  int n_live() const { return n_live_; }
  /// Another number whenever elements came, went or changed places.
  std::int64_t arrangement() const { return arrangement_; }
  std::int64_t id(int slot) const { return ids_[slot]; }
  bool live(int slot) const { return ids_[slot] >= 0; }

  Field& field(FieldIndex f) { return fields_[f]; }
  const Field& field(FieldIndex f) const { return fields_[f]; }
  std::int32_t node(int slot, int corner) const { return nodes_[node_index(slot, corner)]; }
  const std::int32_t* nodes() const { return nodes_.data(); }

  /// Number of doubles that travel with an element.
  int record_size() const { return record_size_; }
  void pack(int slot, double* record) const;

  /// Forgets all elements and makes room for new ones, which have to be put into slots 0 .. n - 1.
  void make_room(int n_elements);
  /// Forgets all elements and gives the memory of their values back.
  void release();
  /// Puts an element into a slot: its id, its n_nodes() local nodes, and its record.
  void put(int slot, std::int64_t id, const std::int32_t* nodes, const double* record);
  /// Fills the record of a fresh element of the given mass [kg].
  void initial_record(double element_mass, double* record) const;
  /// Makes a record's values those that fresh elements and empty slots begin with, mass and volume excepted.
  void set_initial_values(const double* record);
  /// Where a field begins in a record.
  int offset(FieldIndex f) const;
  /// Turns a slot into an empty one. Pre: live(slot).
  void retire(int slot, std::int32_t first_dummy);
  /// Makes empty slots refer to the dummy nodes; their reference element has the given volume [m3].
  void set_dummies(std::int32_t first_dummy, double dummy_mass, double dummy_volume);
  /// Moves live elements together, keeping their order. Returns the new slot of every old one, -1 if empty.
  std::vector<std::int32_t> compact();
  /// Position of a state variable: field and component; field n_fields where no law declares it.
  std::pair<FieldIndex, int> find_variable(const std::string& name) const;
  std::size_t bytes() const;

 private:
  std::size_t node_index(int slot, int corner) const {
    return (static_cast<std::size_t>(slot / lane_width) * static_cast<std::size_t>(n_nodes_) + corner) * lane_width +
           slot % lane_width;
  }
  void resize(int n_slots);
  void clear_slot(int slot);

  const Shape* shape_ = nullptr;
  int n_nodes_ = 0;
  int index_ = 0, n_slots_ = 0, n_live_ = 0, record_size_ = 0;
  Precision precision_ = Precision::double_precision;
  std::int64_t arrangement_ = 0;
  std::int32_t first_dummy_ = 0;
  double dummy_mass_ = 1.0, dummy_volume_ = 1.0;
  std::vector<std::int64_t> ids_;
  AlignedVector<std::int32_t> nodes_;
  std::vector<Field> fields_;
};

}  // namespace kerf
