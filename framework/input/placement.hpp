// Rotates and translates a part from its generator's frame to the model's.
#pragma once

#include <cmath>

#include "input/model_input.hpp"
#include "kerf/functions.hpp"

namespace kerf {

/// The composition of a part's placement steps: x -> R x + t.
class Placement {
 public:
  explicit Placement(const PartInput& part) {
    for (const auto& p : part.placement) append(*p);
  }
  Vec3 apply(Vec3 x) const {
    return {row_[0].x * x.x + row_[0].y * x.y + row_[0].z * x.z + shift_.x,
            row_[1].x * x.x + row_[1].y * x.y + row_[1].z * x.z + shift_.y,
            row_[2].x * x.x + row_[2].y * x.y + row_[2].z * x.z + shift_.z};
  }

 private:
  /// Rodrigues' formula; exact zeros and ones for multiples of a right angle keep axis-aligned parts aligned.
  void append(const PlacementInput& p) {
    const Vec3 a = p.axis * (1.0 / norm(p.axis));
    double c = kerf::cos(p.angle), s = kerf::sin(p.angle);
    if (std::fabs(c) < 1e-15) c = 0.0;
    if (std::fabs(s) < 1e-15) s = 0.0;
    const auto turn = [&](Vec3 v) { return v * c + cross(a, v) * s + a * (dot(a, v) * (1.0 - c)); };
    const Vec3 columns[3] = {turn({row_[0].x, row_[1].x, row_[2].x}), turn({row_[0].y, row_[1].y, row_[2].y}),
                             turn({row_[0].z, row_[1].z, row_[2].z})};
    for (int i = 0; i < 3; ++i) row_[i] = {columns[0][i], columns[1][i], columns[2][i]};
    shift_ = turn(shift_ - p.about) + p.about + p.translate;
  }

  Vec3 row_[3] = {{1, 0, 0}, {0, 1, 0}, {0, 0, 1}}, shift_;
};

}  // namespace kerf
