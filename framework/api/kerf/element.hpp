// The contract of elements: from nodal motion to strain, stress and internal forces, block by block.
#pragma once

#include <cstdint>
#include <span>
#include <stdexcept>
#include <type_traits>

#include "kerf/eos.hpp"
#include "kerf/erosion.hpp"
#include "kerf/law.hpp"
#include "kerf/material.hpp"
#include "kerf/shape.hpp"
#include "kerf/solid.hpp"

namespace kerf {

/// Combines the erosion criteria of a material; provided by the engine.
class ErosionJudge {
 public:
  virtual ~ErosionJudge() = default;
  /// Judges one block; `rows` are filled by the element as in ErosionBatch, reads and states by the engine. All rows
  /// begin on boundaries of 64 bytes.
  /// Returns a bit mask of failed lanes; `block` is the block's number within the part.
  virtual unsigned judge(ErosionBatch& rows, int block) = 0;
  /// What the criteria have asked for together, of `Inputs`.
  virtual unsigned asked_inputs() const = 0;
};

/// Where a law finds a variable that it reads: component `component` of a blocked array of doubles or floats, or a
/// constant where no law of the part declares the variable.
struct ReadSource {
  const double* data = nullptr;  // [block][component][lane]
  const float* single_data = nullptr;
  int n_components = 0, component = 0;
  double value = 0.0;  // where both arrays are null
};

/// What a law reads, and which of its variables the element has to rotate.
struct LawAccess {
  std::span<const ReadSource> reads;
  std::span<const int> tensors;  // first components of tensors in the law's state
  unsigned inputs = 0;  // what the law has asked for, of Inputs
  const double** rows = nullptr;  // scratch: one per variable that is read
  double* wide = nullptr;  // scratch: `lane_width` per variable
};

/// Rows of one block of what a law reads, for LawRows::reads; valid until the next call.
inline const double* const* read_rows(const LawAccess& a, int block) {
  for (std::size_t r = 0; r < a.reads.size(); ++r) {
    const ReadSource& s = a.reads[r];
    const std::int64_t first = (static_cast<std::int64_t>(block) * s.n_components + s.component) * lane_width;
    double* wide = a.wide + r * lane_width;
    a.rows[r] = s.data ? s.data + first : wide;
    for (int l = 0; !s.data && l < lane_width; ++l) wide[l] = s.single_data ? s.single_data[first + l] : s.value;
  }
  return a.rows;
}

/// Forces of lower magnitude than `limit` quanta are exact to half a quantum; beyond it, the run stops.
struct ForceScale {
  double quantum = 1.0, per_quantum = 1.0;  // [N], [1/N]; powers of two
  static constexpr double limit = 144115188075855872.0;  // 2^57, so that 32 contributions cannot overflow
};

/// One part on one rank as an element sees it. Arrays of nodes have four entries per node, the fourth unused;
/// arrays of elements are blocked: [block][component][lane]. All arrays begin on boundaries of 64 bytes. Lanes that
/// hold no element point to dummy nodes and are computed like all others.
///
/// `Real` is the type of what the element keeps of stress and of itself: double, or float in a model with
/// `precision: single`. Nodes, masses, volumes, energies and what laws keep are doubles in both.
template <class Real>
struct ElementArrays {
  // nodes
  const double* position = nullptr;  // [m]
  const double* velocity = nullptr;  // at mid-step [m/s]
  std::int64_t* force = nullptr;  // accumulated, in quanta
  ForceScale scale;
  // step
  double dt = 0.0;  // [s]
  double time = 0.0;  // at the end of the step [s]
  // laws: either a material with an EOS, or a solid
  const Material* material = nullptr;
  const Eos* eos = nullptr;
  const Solid* solid = nullptr;
  LawAccess of_material, of_eos;  // the former also of a solid
  ErosionJudge* judge = nullptr;  // null where nothing erodes
  double reference_density = 0.0;
  // elements
  int n_blocks = 0;
  const std::int32_t* nodes = nullptr;  // [block][nodes of the shape][lane]
  const double* mass = nullptr;  // [kg]
  double* volume = nullptr;  // [m3]
  Real* deviator = nullptr;  // [block][6][lane] [Pa]
  Real* pressure = nullptr;  // with no bulk viscosity [Pa]
  double* internal_energy = nullptr;  // of the element, bulk viscosity's work included [J]
  double* viscous_energy = nullptr;  // the bulk viscosity's share of it [J]
  Real* element_state = nullptr;
  double *material_state = nullptr, *eos_state = nullptr;  // the former also of a solid
  const double* place = nullptr;  // [block][4][lane] centre and cube root of volume before the first step [m]
  /// Factors of the stress: of the deviator, of tensile and of compressive pressures, for the next step and as applied
  /// to the stress that is stored; null where no criterion softens. [block][6][lane]
  double* softening = nullptr;
  int n_element_state = 0, n_material_state = 0, n_eos_state = 0;
  /// [block][lane], at time zero; null in later cycles, and where unknown. In collapsed cells as many of the shape's
  /// faces as make the same share.
  const std::uint8_t* exposed_faces = nullptr;
  // results
  double energy_per_quantum = 1.0;  // [1/J]
  std::int64_t hourglass_energy = 0;  // in energy quanta
  alignas(64) Real least_step[lane_width];  // smallest stable step seen per lane, without safety factor [s]
  alignas(64) std::conditional_t<std::is_same_v<Real, float>, std::int32_t, std::int64_t> least_block[lane_width];
  std::uint8_t* failed = nullptr;  // [block] bit mask of lanes to erode
  int bad_block = -1;  // first block with a force that is not finite or too large
  int inverted_block = -1;  // first block with an inverted element that no criterion erodes
};

using ElementWork = ElementArrays<double>;
using SingleElementWork = ElementArrays<float>;

class Element : public Law {
 public:
  /// Which nodes the element has, and which of them make its faces. The mesh of a part must have the same shape.
  virtual const Shape& shape() const = 0;
  /// Volume of an element [m3], as the element itself will compute it: its mass follows from it. Not positive where the
  /// element is inside out.
  virtual double volume(const CellCorners& x) const { return volume_by_faces(shape(), x); }
  /// Whether a hexahedron may have corners that coincide, as a wedge, a pyramid or a tetrahedron does, in the orders of
  /// CellKind. A node then gets the forces and the shares of mass of all its corners. Where it is false, such cells are
  /// an error of the input.
  virtual bool takes_collapsed_cells() const { return false; }
  /// Integrates one step of all blocks and adds their forces.
  virtual void add_internal_forces(ElementWork& work) const = 0;
  /// Sets volume, pressure and the stable step, and adds the forces of an initial pressure. For the first cycle.
  virtual void initialise(ElementWork& work) const = 0;

  /// Whether the element has the two functions below. Where it has not, `precision: single` is an error of the input.
  virtual bool computes_in_single() const { return false; }
  virtual void add_internal_forces_single(SingleElementWork&) const { refuse(); }
  virtual void initialise_single(SingleElementWork&) const { refuse(); }

 private:
  [[noreturn]] static void refuse() {
    throw std::logic_error(
        "an element that computes in single precision has to override initialise_single and "
        "add_internal_forces_single");
  }
};

}  // namespace kerf

KERF_SIZES(element, KERF_SIZE(ErosionJudge), KERF_SIZE(ReadSource), KERF_SIZE(LawAccess), KERF_SIZE(ForceScale),
           KERF_SIZE(ElementWork), KERF_SIZE(SingleElementWork), KERF_SIZE(Element))
