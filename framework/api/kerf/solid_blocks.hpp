// How a kernel of elements reads and writes the blocks of a part: entries, what it asks the memory for ahead, forces on
// nodes, and sums over the blocks.
#pragma once

#include <algorithm>

#include "kerf/element.hpp"
#include "kerf/lanes.hpp"

namespace kerf {

/// Entry of a blocked array: [block][n_components][lane].
template <class Number>
[[gnu::always_inline]] inline Number* entry_at(Number* array, int n_components, int block, int component, int lane) {
  return array + (static_cast<std::int64_t>(block) * n_components + component) * lane_width + lane;
}

/// Asks for what the next blocks will read: a part has more arrays than the hardware can foresee, and nodes are
/// known by their numbers alone. Worth half of the speed of large models.
template <int n_nodes, int newest_node, class Real>
[[gnu::always_inline]] inline void fetch_ahead(const ElementArrays<Real>& w, int block) {
  constexpr int fields_ahead = 3, nodes_ahead = 2;  // blocks; 2 to 8 and 1 to 4 are much the same
  const std::int64_t far = std::min(block + fields_ahead, w.n_blocks - 1);
  // Always in line: as a function that does nothing but ask, it would be left out.
  const auto fetch = [far](const auto* array, int n_components) __attribute__((always_inline)) {
    constexpr int step = 64 / sizeof(*array);  // entries of a cache line
    for (int i = 0; i < n_components * lane_width; i += step)
      __builtin_prefetch(array + far * n_components * lane_width + i);
  };
  fetch(w.nodes, n_nodes);
  fetch(w.mass, 1);
  fetch(w.volume, 1);
  fetch(w.pressure, 1);
  fetch(w.internal_energy, 1);
  fetch(w.viscous_energy, 1);
  fetch(w.deviator, 6);
  fetch(w.element_state, w.n_element_state);
  fetch(w.material_state, w.n_material_state);
  fetch(w.eos_state, w.n_eos_state);
  const std::int64_t near = std::min(block + nodes_ahead, w.n_blocks - 1);
  for (int l = 0; l < lane_width; ++l) {
    const std::int64_t newest = 4 * static_cast<std::int64_t>(w.nodes[(n_nodes * near + newest_node) * lane_width + l]);
    __builtin_prefetch(w.position + newest);
    __builtin_prefetch(w.velocity + newest);
    __builtin_prefetch(w.force + newest, 1);
  }
}

namespace detail {
template <bool small, int part, class Real, class V, int n_nodes>
[[gnu::always_inline]] inline bool scatter_part(ElementArrays<Real>& w, const std::int32_t* first,
                                                const V (&force)[3][n_nodes]) {
  const std::int32_t* nodes = first + part * register_lanes;
  LanesInt last[3] = {}, sound = ~LanesInt{};
  for (int n = 0; n < n_nodes - 1; ++n) {
    LanesInt quanta[3];
    for (int i = 0; i < 3; ++i) {
      const Lanes f = widened<part>(force[i][n]);
      if constexpr (!small) sound &= abs_of(f) < ForceScale::limit;
      quanta[i] = small ? round_small_to_int(f) : round_to_int(f);
      last[i] -= quanta[i];
    }
    scatter_add(w.force, nodes + lane_width * n, quanta[0], quanta[1], quanta[2]);
  }
  scatter_add(w.force, nodes + lane_width * (n_nodes - 1), last[0], last[1], last[2]);
  return mask_of(sound) == all_lanes;
}
}  // namespace detail

/// Adds forces, in quanta, to the nodes of a piece. The last node takes minus the others' sum, so that an element's
/// forces add up to nothing exactly. False where a force is not finite or too large, unless `small`.
template <bool small, class Real, class V, int n_nodes>
[[gnu::always_inline]] inline bool scatter_forces(ElementArrays<Real>& w, const std::int32_t* nodes,
                                                  const V (&force)[3][n_nodes]) {
  bool sound = detail::scatter_part<small, 0>(w, nodes, force);
  if constexpr (n_wide<Real> == 2) sound &= detail::scatter_part<small, 1>(w, nodes, force);
  return sound;
}

/// Sums over the blocks of a part.
struct SolidTotals {
  alignas(64) std::int64_t hourglass_energy[lane_width] = {};  // in quanta
};

namespace detail {
template <int part, class Real, class V>
[[gnu::always_inline]] inline void book_part(const ElementArrays<Real>& w, int lane, V power, V good,
                                             SolidTotals& totals) {
  const Lanes energy = 0.5 * widened<part>(power) * w.dt * widened<part>(good) * w.energy_per_quantum;
  const bool small = mask_of(abs_of(energy) < small_limit) == all_lanes;
  const LanesInt quanta =
      small ? round_small_to_int(energy) : round_to_int(max_of(min_of(energy, lanes(1e18)), lanes(-1e18)));
  std::int64_t* total = totals.hourglass_energy + lane + part * register_lanes;
  store_lanes(total, load_lanes(total) + quanta);
}
}  // namespace detail

/// Books the energy that hourglass control takes in a step: half of `power`, the product of the sum of its old and new
/// forces with their rates [W], times the step. Lanes where `good` is 0 count nothing.
template <class Real, class V>
inline void book_hourglass(const ElementArrays<Real>& w, int lane, V power, V good, SolidTotals& totals) {
  detail::book_part<0>(w, lane, power, good, totals);
  if constexpr (n_wide<Real> == 2) detail::book_part<1>(w, lane, power, good, totals);
}

}  // namespace kerf
