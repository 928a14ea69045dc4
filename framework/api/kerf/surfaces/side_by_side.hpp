// Vectors of three components, several side by side.
#pragma once

#include <kerf/math.hpp>

namespace kerf::surfaces {

/// `T` holds the same component of each.
template <class T>
struct SideBySide {
  T x, y, z;

  Vec3 at(int lane) const { return {x[lane], y[lane], z[lane]}; }
  friend SideBySide operator+(const SideBySide& a, const SideBySide& b) { return {a.x + b.x, a.y + b.y, a.z + b.z}; }
  friend SideBySide operator-(const SideBySide& a, const SideBySide& b) { return {a.x - b.x, a.y - b.y, a.z - b.z}; }
  friend SideBySide operator*(const SideBySide& a, const T& s) { return {a.x * s, a.y * s, a.z * s}; }
  friend T dot(const SideBySide& a, const SideBySide& b) { return a.x * b.x + a.y * b.y + a.z * b.z; }
  friend SideBySide cross(const SideBySide& a, const SideBySide& b) {
    return {a.y * b.z - a.z * b.y, a.z * b.x - a.x * b.z, a.x * b.y - a.y * b.x};
  }
};

}  // namespace kerf::surfaces
