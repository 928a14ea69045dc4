// Motions and offsets of included files.
#include "decks/transform.hpp"

#include <cmath>

#include "kerf/functions.hpp"

namespace kerf::decks {
namespace {

using Point = std::array<double, 3>;

/// The motion `linear` that leaves `point` where it is.
Affine about(Affine linear, const Point& point) {
  const Point moved = linear(point);
  for (std::size_t d = 0; d < 3; ++d) linear.shift[d] += point[d] - moved[d];
  return linear;
}

Point normalised(const Point& v) {
  const double length = std::sqrt(v[0] * v[0] + v[1] * v[1] + v[2] * v[2]);
  return {v[0] / length, v[1] / length, v[2] / length};
}

}  // namespace

std::array<double, 3> Affine::operator()(const Point& x) const {
  Point y = shift;
  for (std::size_t i = 0; i < 3; ++i) y[i] += matrix[i][0] * x[0] + matrix[i][1] * x[1] + matrix[i][2] * x[2];
  return y;
}

Affine Affine::after(const Affine& first) const {
  Affine both;
  for (std::size_t i = 0; i < 3; ++i)
    for (std::size_t j = 0; j < 3; ++j)
      both.matrix[i][j] =
          matrix[i][0] * first.matrix[0][j] + matrix[i][1] * first.matrix[1][j] + matrix[i][2] * first.matrix[2][j];
  both.shift = (*this)(first.shift);
  return both;
}

double Affine::determinant() const {
  const auto& m = matrix;
  return m[0][0] * (m[1][1] * m[2][2] - m[1][2] * m[2][1]) - m[0][1] * (m[1][0] * m[2][2] - m[1][2] * m[2][0]) +
         m[0][2] * (m[1][0] * m[2][1] - m[1][1] * m[2][0]);
}

Affine Affine::moved(double x, double y, double z) {
  Affine a;
  a.shift = {x, y, z};
  return a;
}

Affine Affine::scaled(double x, double y, double z) {
  Affine a;
  a.matrix[0][0] = x;
  a.matrix[1][1] = y;
  a.matrix[2][2] = z;
  return a;
}

// Rodrigues' formula: R = c I + s [n] + (1 - c) n n^T.
Affine Affine::turned(const Point& axis, const Point& point, double degrees) {
  const Point n = normalised(axis);
  const double angle = degrees * (3.14159265358979323846 / 180.0);
  const double c = kerf::cos(angle), s = kerf::sin(angle);
  Affine a;
  const double cross[3][3] = {{0, -n[2], n[1]}, {n[2], 0, -n[0]}, {-n[1], n[0], 0}};
  for (std::size_t i = 0; i < 3; ++i)
    for (std::size_t j = 0; j < 3; ++j) a.matrix[i][j] = (i == j ? c : 0.0) + s * cross[i][j] + (1.0 - c) * n[i] * n[j];
  return about(a, point);
}

// Householder's reflection: I - 2 n n^T.
Affine Affine::mirrored(const Point& point, const Point& other) {
  const Point n = normalised({other[0] - point[0], other[1] - point[1], other[2] - point[2]});
  Affine a;
  for (std::size_t i = 0; i < 3; ++i)
    for (std::size_t j = 0; j < 3; ++j) a.matrix[i][j] = (i == j ? 1.0 : 0.0) - 2.0 * n[i] * n[j];
  return about(a, point);
}

std::int64_t Transform::id(std::int64_t written, IdKind kind) const {
  const std::int64_t offset = offsets[static_cast<std::size_t>(kind)];
  return written > 0 ? written + offset : written < 0 ? written - offset : 0;
}

Transform Transform::after(const Transform& inner) const {
  Transform both;
  for (std::size_t k = 0; k < offsets.size(); ++k) both.offsets[k] = offsets[k] + inner.offsets[k];
  both.mass = mass * inner.mass;
  both.time = time * inner.time;
  both.length = length * inner.length;
  both.motion = motion.after(inner.motion);
  return both;
}

}  // namespace kerf::decks
