// Meridian of the nose of a rod.
#include "../nose.hpp"

#include <algorithm>
#include <cmath>

#include "kerf/functions.hpp"

namespace kerf {

NoseProfile NoseProfile::flat(double radius) {
  NoseProfile p;
  p.radius_ = p.tip_radius_ = radius;
  return p;
}

NoseProfile NoseProfile::conical(double radius, double length, double tip_radius) {
  NoseProfile p;
  p.radius_ = radius;
  p.length_ = length;
  p.tip_radius_ = tip_radius;
  return p;
}

NoseProfile NoseProfile::ogival(double radius, double caliber_radius_head, double tip_radius) {
  NoseProfile p;
  p.radius_ = radius;
  p.tip_radius_ = tip_radius;
  p.arc_radius_ = 2.0 * radius * caliber_radius_head;
  p.length_ = p.height_at(tip_radius);
  return p;
}

double NoseProfile::radius_at(double height) const {
  if (length_ <= 0.0) return radius_;
  if (arc_radius_ > 0.0) {
    const double h = std::min(height, arc_radius_);
    return std::sqrt(arc_radius_ * arc_radius_ - h * h) - (arc_radius_ - radius_);
  }
  return radius_ + (tip_radius_ - radius_) * height / length_;
}

double NoseProfile::height_at(double radius) const {
  if (arc_radius_ > 0.0) {
    const double from_centre = arc_radius_ - radius_ + radius;
    return std::sqrt(std::max(0.0, (arc_radius_ - from_centre) * (arc_radius_ + from_centre)));
  }
  if (length_ <= 0.0) return 0.0;
  return length_ * (radius_ - radius) / (radius_ - tip_radius_);
}

double NoseProfile::arc_to(double height) const {
  if (arc_radius_ > 0.0) return arc_radius_ * kerf::asin(std::min(1.0, height / arc_radius_));
  if (length_ <= 0.0) return 0.0;
  return kerf::hypot(height, (radius_ - tip_radius_) * height / length_);
}

NoseProfile::Point NoseProfile::at_arc(double arc) const {
  const double side = arc_to(length_);
  if (arc >= side) return {std::max(0.0, tip_radius_ - (arc - side)), length_};
  const double height = arc_radius_ > 0.0 ? arc_radius_ * kerf::sin(arc / arc_radius_) : length_ * arc / side;
  return {radius_at(height), height};
}

}  // namespace kerf
