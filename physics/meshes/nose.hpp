// Meridian of the nose of a rod: flat, conical or ogival (of which the hemisphere is one), with a flat tip.
#pragma once

namespace kerf {

/// Profile from the base of the nose (height 0, the rod's radius) over its side to the edge of the flat tip
/// and on to the axis.
class NoseProfile {
 public:
  /// A point of the meridian plane [m].
  struct Point {
    double radius = 0.0, height = 0.0;
  };

  static NoseProfile flat(double radius);
  /// Straight side over `length`, ending at `tip_radius`.
  static NoseProfile conical(double radius, double length, double tip_radius);
  /// Tangent ogive whose arc has `caliber_radius_head` times the rod's diameter as its radius, cut off where
  /// its radius is `tip_radius`. A hemisphere has the caliber radius head 1/2 and no flat tip.
  static NoseProfile ogival(double radius, double caliber_radius_head, double tip_radius);

  /// Height of the flat tip above the base [m].
  double length() const { return length_; }
  double tip_radius() const { return tip_radius_; }
  /// Radius of the section at a height within [0, length()] [m].
  double radius_at(double height) const;
  /// Height at which the section has this radius, within [tip_radius(), base radius] [m].
  double height_at(double radius) const;
  /// Length of the meridian from the base to a height on the side [m].
  double arc_to(double height) const;
  /// Length of the meridian from the base to the axis [m].
  double arc_length() const { return arc_to(length_) + tip_radius_; }
  /// Point at an arc length from the base.
  Point at_arc(double arc) const;

 private:
  double radius_ = 0.0, length_ = 0.0, tip_radius_ = 0.0;
  double arc_radius_ = 0.0;  // of an ogive; zero where the side is straight
};

}  // namespace kerf
