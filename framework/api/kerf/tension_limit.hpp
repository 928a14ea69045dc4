// The key `tension_limit` of equations of state: how far below zero a pressure may fall.
#pragma once

#include <limits>

#include "kerf/math.hpp"
#include "kerf/schema.hpp"

namespace kerf {

/// A law derives from it, declares the key with describe_tension_limit, and passes its pressure through limited(). The
/// cut-off is reversible: it keeps nothing. An erosion criterion may do more where the limit is reached. The wave speed
/// is that of the material without the limit, with the work of the limited pressure: cavitated material stays as stiff
/// as it was, which is safe for the time step when it closes again.
struct TensionLimit {
  double tension_limit = std::numeric_limits<double>::infinity();  // [Pa]

  template <class T>
  static void describe_tension_limit(Schema<T>& s) {
    s.real(&TensionLimit::tension_limit, "tension_limit", "Pa", non_negative,
           "the pressure never falls below minus this; no limit where absent")
        .optional();
  }
  double limited(double pressure) const { return max_of(-tension_limit, pressure); }
};

}  // namespace kerf
