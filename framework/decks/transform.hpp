// What *INCLUDE_TRANSFORM does to what it includes: offsets of ids, factors of units, and a motion of the nodes.
#pragma once

#include <array>
#include <cstdint>

#include "kerf/math.hpp"

namespace kerf::decks {

/// Kinds of ids that offsets are given for, in the order of the cards: IDNOFF, IDEOFF, IDPOFF, IDMOFF, IDSOFF, IDFOFF,
/// IDDOFF and IDROFF.
enum class IdKind : std::uint8_t {
  node,
  element,
  part,
  material,  // and equations of state
  set,
  function,  // curves, tables and functions
  definition,  // whatever else *DEFINE defines
  other  // sections, hourglass controls and the rest
};

/// A linear map and a shift: x -> matrix x + shift.
struct Affine {
  std::array<std::array<double, 3>, 3> matrix = {{{1, 0, 0}, {0, 1, 0}, {0, 0, 1}}};
  std::array<double, 3> shift = {0, 0, 0};

  std::array<double, 3> operator()(const std::array<double, 3>& x) const;
  /// `this` after `first`.
  Affine after(const Affine& first) const;
  /// Negative where the map turns bodies inside out.
  double determinant() const;

  static Affine moved(double x, double y, double z);
  static Affine scaled(double x, double y, double z);
  /// By `degrees` about the axis through `point`, right-handed. Pre: the axis has a length.
  static Affine turned(const std::array<double, 3>& axis, const std::array<double, 3>& point, double degrees);
  /// In the plane through `point` that is normal to the way from there to `other`. Pre: the points differ.
  static Affine mirrored(const std::array<double, 3>& point, const std::array<double, 3>& other);
};

/// What happens to everything that a reading of a file holds, those of its own includes as well.
struct Transform {
  std::array<std::int64_t, 8> offsets = {};
  double mass = 1.0, time = 1.0, length = 1.0;  // factors of units
  Affine motion;  // of the nodes, with the factor of length in it

  /// An id of what is included, as the whole deck calls it. Zero stays zero, and a negative id keeps its sign.
  std::int64_t id(std::int64_t written, IdKind kind) const;
  /// This transform of what has been transformed by `inner` before.
  Transform after(const Transform& inner) const;
};

}  // namespace kerf::decks
