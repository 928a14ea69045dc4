// Where a detonation starts: at a point, along a line, or over a plane.
#pragma once

#include <kerf/eos.hpp>
#include <kerf/law_use.hpp>

#include <memory>
#include <vector>

namespace kerf::explosives {

struct Detonator {
  Vec3 point, end, normal;  // [m], [m], [-]
  double time = 0.0;  // [s]

  static void describe(Schema<Detonator>& s) {
    s.vector(&Detonator::point, "point", "m", any_value,
             "where the detonation starts; one end of a line, or a point of a plane");
    s.vector(&Detonator::end, "end", "m", any_value, "other end of a line that starts the detonation at once")
        .optional();
    s.vector(&Detonator::normal, "normal", "-", any_value,
             "direction across a plane that starts the detonation at once, to both sides")
        .optional();
    s.real(&Detonator::time, "time", "s", non_negative, "when it starts").by_default("0");
    s.rule("end", "a detonator is a line with `end`, or a plane with `normal`, not both",
           [](const Detonator& d) { return !d.is_line() || !d.is_plane(); });
    s.rule("end", "a line that starts the detonation must have a length; leave `end` out for a point",
           [](const Detonator& d) { return !d.is_line() || norm(d.end - d.point) > 0.0; });
  }

  Detonator() : end{none, none, none}, normal{none, none, none} {}
  bool is_line() const { return end.x < none; }
  bool is_plane() const { return normal.x < none; }

  /// Its place that is nearest to x [m].
  Vec3 nearest(Vec3 x) const {
    const Vec3 to = x - point;
    if (is_plane()) return x - normal * (dot(to, normal) / dot(normal, normal));
    if (!is_line()) return point;
    const Vec3 along = end - point;
    const double length2 = dot(along, along);
    const double share = length2 > 0.0 ? min_of(max_of(dot(to, along) / length2, 0.0), 1.0) : 0.0;
    return point + along * share;
  }

 private:
  static constexpr double none = 1e300;  // a key that is absent
};

using Detonators = std::vector<std::unique_ptr<Detonator>>;

/// The first arrival at x of fronts that run in straight lines; FrontLaw::never without detonators [s].
inline double first_arrival(const Detonators& detonators, Vec3 x, double velocity) {
  double first = FrontLaw::never;
  for (const auto& d : detonators) first = min_of(first, d->time + norm(x - d->nearest(x)) / velocity);
  return first;
}

}  // namespace kerf::explosives
