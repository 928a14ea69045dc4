// What all pointwise laws share: moving a law's State between memory and locals, lane by lane.
//
// A law's State and Reads are structs of doubles. Memory holds them one variable after the other, with
// `lane_width` points side by side.
#pragma once

#include <cstddef>
#include <type_traits>
#include <utility>

#include "kerf/schema.hpp"

namespace kerf {

/// For laws that keep or read nothing.
struct NoVariables {};

template <class Struct>
inline constexpr int n_doubles = std::is_empty_v<Struct> ? 0 : static_cast<int>(sizeof(Struct) / sizeof(double));

namespace detail {

template <class Struct>
using indices = std::make_index_sequence<static_cast<std::size_t>(n_doubles<Struct>)>;

inline SymTensor tensor_at(const double (&rows)[6][lane_width], int lane) {
  return {rows[0][lane], rows[1][lane], rows[2][lane], rows[3][lane], rows[4][lane], rows[5][lane]};
}
inline void set_tensor(double (&rows)[6][lane_width], int lane, SymTensor t) {
  rows[0][lane] = t.xx;
  rows[1][lane] = t.yy;
  rows[2][lane] = t.zz;
  rows[3][lane] = t.xy;
  rows[4][lane] = t.yz;
  rows[5][lane] = t.zx;
}

// Folds instead of loops, here and below: the compiler sees constant offsets and keeps the struct in registers.
template <class Struct, std::size_t... I>
[[gnu::always_inline]] inline Struct state_at([[maybe_unused]] const double* rows, [[maybe_unused]] int lane,
                                              std::index_sequence<I...>) {
  Struct s;
  ((reinterpret_cast<double*>(&s)[I] = rows[I * lane_width + lane]), ...);
  return s;
}
template <class Struct>
[[gnu::always_inline]] inline Struct state_at(const double* rows, int lane) {
  return state_at<Struct>(rows, lane, indices<Struct>{});
}
/// A law's variables of one block, copied to the stack so that nothing aliases while the lanes are computed.
template <class Struct>
struct LaneVariables {
  static constexpr int n = n_doubles<Struct>;
  alignas(64) double values[n > 0 ? n : 1][lane_width];

  void read(const double* memory) {
    for (int v = 0; v < n; ++v)
      for (int l = 0; l < lane_width; ++l) values[v][l] = memory[v * lane_width + l];
  }
  void read(const double* const* rows) {
    for (int v = 0; v < n; ++v)
      for (int l = 0; l < lane_width; ++l) values[v][l] = rows[v][l];
  }
  void write(double* memory) const {
    for (int v = 0; v < n; ++v)
      for (int l = 0; l < lane_width; ++l) memory[v * lane_width + l] = values[v][l];
  }
  Struct at(int lane) const { return at(lane, indices<Struct>{}); }
  void set(int lane, const Struct& s) { set(lane, s, indices<Struct>{}); }

 private:
  template <std::size_t... I>
  Struct at([[maybe_unused]] int lane, std::index_sequence<I...>) const {
    Struct s;
    ((reinterpret_cast<double*>(&s)[I] = values[I][lane]), ...);
    return s;
  }
  template <std::size_t... I>
  void set([[maybe_unused]] int lane, [[maybe_unused]] const Struct& s, std::index_sequence<I...>) {
    ((values[I][lane] = reinterpret_cast<const double*>(&s)[I]), ...);
  }
};

}  // namespace detail

/// Base of material, EOS, erosion and element laws: what they keep per point.
struct Law : Plugin {
  /// State variables of this instance, in memory order; by default all that were declared.
  virtual std::vector<StateVariable> state_variables() const {
    return description ? description->state : std::vector<StateVariable>{};
  }
  /// Cost of one update relative to the elastic-plastic law's, for the work model.
  virtual double cost() const { return 1.0; }
};

}  // namespace kerf
