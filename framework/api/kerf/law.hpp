// What all laws of an element share: what they may ask for, what they keep, and how a law's State moves between memory
// and locals, lane by lane.
//
// A law's State and Reads are structs of doubles and of symmetric tensors. Memory holds them one variable after the
// other, with `lane_width` points side by side.
#pragma once

#include <cstddef>
#include <exception>
#include <map>
#include <stdexcept>
#include <string>
#include <type_traits>
#include <utility>

#include "kerf/schema.hpp"

namespace kerf {

/// For laws that keep or read nothing.
struct NoVariables {};

/// What a law may ask for beyond what every law of its kind is told, by `static constexpr unsigned inputs = with_length
/// | with_rotation;`. A law that does not ask does not pay.
enum Inputs : unsigned {
  with_length = 1,  // `length`: of the element, for the stable step: the edge of a cube, the thickness of a plate [m]
  with_initial_length = 2,  // `initial_length`: cube root of the undeformed element's volume [m]
  with_reference_position = 4,  // `reference_position`: centre of the undeformed element [m]
  with_rotation = 8  // `rotation`: of the material in the step, as the stress has been rotated by it
};

/// Rows of one block of `lane_width` points that a law has asked for; null where it has not.
struct LawRows {
  double dt = 0.0;  // [s]
  double time = 0.0;  // at the end of the step [s]
  const double *length = nullptr, *initial_length = nullptr;  // [lane] [m]
  const double (*reference_position)[lane_width] = nullptr;  // [3][lane] [m]
  const double (*rotation)[lane_width] = nullptr;  // [9][lane]
  const double* const* reads = nullptr;  // [variable] -> [lane]
};

/// A point before the first step, for laws whose state depends on the place.
struct InitialPoint {
  Vec3 position;  // centre of the undeformed element [m]
  double length = 0.0;  // cube root of its volume [m]
  double density = 0.0;  // reference density [kg/m3]
};

template <class Struct>
inline constexpr int n_doubles = std::is_empty_v<Struct> ? 0 : static_cast<int>(sizeof(Struct) / sizeof(double));

namespace detail {

template <class Struct>
using indices = std::make_index_sequence<static_cast<std::size_t>(n_doubles<Struct>)>;

inline SymTensor tensor_at(const double (*rows)[lane_width], int lane) {
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
template <class LawType>
constexpr unsigned inputs_of() {
  if constexpr (requires { LawType::inputs; })
    return LawType::inputs;
  else
    return 0;
}
template <class LawType>
struct ReadsOf {
  using type = NoVariables;
};
template <class LawType>
requires requires { typename LawType::Reads; }
struct ReadsOf<LawType> {
  using type = typename LawType::Reads;
};

// Members that an input has only where the law asks for them: a law that forgets to ask does not compile.
template <bool asked>
struct LengthInput {};
template <>
struct LengthInput<true> {
  double length = 0.0;  // [m]
};
template <bool asked>
struct InitialLengthInput {};
template <>
struct InitialLengthInput<true> {
  double initial_length = 0.0;  // [m]
};
template <bool asked>
struct ReferencePositionInput {};
template <>
struct ReferencePositionInput<true> {
  Vec3 reference_position;  // [m]
};
template <bool asked>
struct RotationInput {};
template <>
struct RotationInput<true> {
  Rotation rotation;
};
template <unsigned inputs>
struct AskedInputs : LengthInput<(inputs & with_length) != 0>,
                     InitialLengthInput<(inputs & with_initial_length) != 0>,
                     ReferencePositionInput<(inputs & with_reference_position) != 0>,
                     RotationInput<(inputs & with_rotation) != 0> {};

inline Rotation rotation_at(const double (*rows)[lane_width], int l) {
  return {rows[0][l], rows[1][l], rows[2][l], rows[3][l], rows[4][l], rows[5][l], rows[6][l], rows[7][l], rows[8][l]};
}
/// Fills in the members that a law has asked for.
template <unsigned inputs>
[[gnu::always_inline]] inline void set_asked([[maybe_unused]] AskedInputs<inputs>& in,
                                             [[maybe_unused]] const LawRows& rows, [[maybe_unused]] int l) {
  if constexpr ((inputs & with_length) != 0) in.length = rows.length[l];
  if constexpr ((inputs & with_initial_length) != 0) in.initial_length = rows.initial_length[l];
  if constexpr ((inputs & with_reference_position) != 0)
    in.reference_position = {rows.reference_position[0][l], rows.reference_position[1][l],
                             rows.reference_position[2][l]};
  if constexpr ((inputs & with_rotation) != 0) in.rotation = rotation_at(rows.rotation, l);
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

/// A sentence about a parameter, and where in its text the fault is.
struct ReadComplaint {
  std::string parameter;
  int offset = 0;  // characters from the beginning of its text
  std::string sentence;  // what is wrong; what is expected
};

/// Base of material, EOS, solid, erosion and element laws: what they keep per point, read of one another, and ask for.
struct Law : Plugin {
  /// The state variables that were declared, in the order of memory.
  const std::vector<StateVariable>& state_variables() const {
    static const std::vector<StateVariable> none;
    return description ? description->state : none;
  }
  /// The variables that the law reads, with the names that the user gave. A law whose number of them depends on its
  /// parameters overrides this, and gets its rows in the order of what it returns.
  virtual std::vector<ReadVariable> reads() const {
    std::vector<ReadVariable> all = description ? description->reads : std::vector<ReadVariable>{};
    for (ReadVariable& r : all)
      if (r.name_of) r.name = r.name_of(*this);
    return all;
  }
  /// What the law has asked for, of `Inputs`.
  virtual unsigned asked_inputs() const { return 0; }
  /// Cost of one update relative to the elastic-plastic law's, for the work model.
  virtual double cost() const { return 1.0; }
  /// What is wrong with what the law reads, told when the laws of its material are known. `units` has the unit of every
  /// variable that it could read, by name; variables that are missing there are complained of elsewhere.
  virtual std::vector<ReadComplaint> complaints(const std::map<std::string, std::string>& /*units*/) const {
    return {};
  }
  /// Changes the state of a point that starts; `state` holds the declared initial values, in the order of
  /// state_variables().
  virtual void initialise(const InitialPoint& /*point*/, double* /*state*/) const {}
};

/// A law has thrown for an element. Laws need not throw this: whatever they throw is turned into it.
class LawError : public std::runtime_error {
 public:
  LawError(const Law& thrown_by, int in_block, int in_lane, const std::string& what)
      : std::runtime_error(what), law(&thrown_by), block(in_block), lane(in_lane) {}
  const Law* law;
  int block, lane;  // of the part; the lane is -1 where it is not known
};

namespace detail {

/// A law that is written for one point has thrown in a lane.
class LaneError : public std::runtime_error {
 public:
  LaneError(int in_lane, const std::string& what) : std::runtime_error(what), lane(in_lane) {}
  int lane;
};
/// What a law that is written for one point throws in the lanes of a block: the first is kept and thrown behind the
/// loop. An exception must not leave a loop that is annotated with `omp simd`; the compiler ends the program there.
/// Where nothing can be thrown, nothing of this is left.
class LaneErrors {
 public:
  LaneErrors() = default;
  LaneErrors(const LaneErrors&) = delete;
  LaneErrors& operator=(const LaneErrors&) = delete;
  /// Calls what computes one lane.
  template <class Work>
  [[gnu::always_inline]] void guard(int lane, const Work& work) {
    try {
      work();
    } catch (const std::exception& e) {
      if (!first_) first_ = new LaneError(lane, e.what());
    } catch (...) {
      if (!first_) first_ = new LaneError(lane, "something that is not a std::exception");
    }
  }
  /// To be called behind the loop.
  [[gnu::always_inline]] void throw_first() {
    if (first_) [[unlikely]]
      throw_and_delete(first_);
  }

 private:
  [[noreturn, gnu::noinline, gnu::cold]] static void throw_and_delete(LaneError* error) {
    const LaneError copy = *error;
    delete error;
    throw copy;
  }
  LaneError* first_ = nullptr;
};

/// Calls a law for a block.
template <class Work>
[[gnu::always_inline]] inline void in_block(const Law& law, int block, const Work& work) {
  try {
    work();
  } catch (const LaneError& e) {
    throw LawError(law, block, e.lane, e.what());
  } catch (const std::exception& e) {
    throw LawError(law, block, -1, e.what());
  } catch (...) {
    throw LawError(law, block, -1, "something that is not a std::exception");
  }
}

/// Base of the laws that are written for one point. `LawType` may have `struct State`, `struct Reads`, `inputs`, and
/// `void initialise_point(const InitialPoint&, State&) const`.
template <class LawType, class Base>
class PointwiseLaw : public Base {
 public:
  unsigned asked_inputs() const final { return inputs_of<LawType>(); }
  void initialise(const InitialPoint& point, double* state) const final {
    if constexpr (requires(const LawType& law, typename LawType::State& s) { law.initialise_point(point, s); }) {
      typename LawType::State s;
      auto* values = reinterpret_cast<double*>(&s);
      for (int v = 0; v < n_doubles<typename LawType::State>; ++v) values[v] = state[v];
      static_cast<const LawType&>(*this).initialise_point(point, s);
      for (int v = 0; v < n_doubles<typename LawType::State>; ++v) state[v] = values[v];
    }
  }
};

}  // namespace detail
}  // namespace kerf

KERF_SIZES(law, KERF_SIZE(LawRows), KERF_SIZE(InitialPoint), KERF_SIZE(ReadComplaint), KERF_SIZE(Law),
           KERF_SIZE(LawError))
