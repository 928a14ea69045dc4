// What measures share: connected bodies of live elements, principal axes, and surfaces with holes.
#pragma once

#include <array>
#include <cstdint>
#include <limits>
#include <string>
#include <vector>

#include "kerf/measure.hpp"

namespace kerf {

/// What a measure returns where there is nothing to measure.
inline constexpr double not_measurable = std::numeric_limits<double>::quiet_NaN();

/// A value that cannot be measured, and why.
inline MeasuredValue unknown(std::string name, std::string reason) {
  return {std::move(name), not_measurable, std::move(reason)};
}

/// A length that is not_measurable where no element of the part is left.
MeasuredValue value_of_remnant(double value, const std::string& part);

/// Why there is nothing to measure on a part that has eroded away.
std::string nothing_left(const std::string& part);

/// Whether the model still holds a node of a part, and why there is nothing to measure where it does not.
bool any_node_left(const MeasureModel& model, int part);
std::string no_node_left(const std::string& part);

/// Number of a part. Throws std::runtime_error naming the measure where there is none of that name.
int measured_part(const MeasureModel& model, const std::string& part, const Plugin& measure);

/// What makes two elements belong to one body.
enum class Link { node, face };

/// Numbers of the elements of the heaviest connected body of a part, ascending; empty where none is alive. Of two
/// equally heavy bodies, the one with the lowest element.
std::vector<std::int32_t> largest_body(const MeasureModel& model, int part, Link link);

/// Numbers of the nodes of these elements, ascending.
std::vector<std::int32_t> nodes_of(const MeasureModel& model, const std::vector<std::int32_t>& elements);

Vec3 centroid(const MeasureModel& model, const MeasureModel::Element& element);

/// Direction of the largest second moment of a set of points, and how clearly it is the largest.
struct LongAxis {
  Vec3 direction;
  double rival = 1.0;  // the second largest moment over the largest; 1 where all directions are alike

  /// Whether the body is so much longer than wide that its axis has a meaning. A round rod has a rival of 0.9 where it
  /// is 0.91 diameters long; a shorter one is a disc.
  bool clear() const { return rival < 0.9; }
};

/// Long axis of the mass of the elements in their current positions. With a symmetry normal (not zero), that of the
/// half body together with its mirror image, looked for in the plane of symmetry.
LongAxis long_axis(const MeasureModel& model, const std::vector<std::int32_t>& elements, Vec3 symmetry_normal);

/// Long axis of the nodes of a part in their undeformed positions, looked for in the same way.
LongAxis undeformed_long_axis(const MeasureModel& model, int part, Vec3 symmetry_normal);

/// Where the direction `undeformed` of the undeformed material points to now in a body with these nodes. Zero where
/// the nodes do not tell.
Vec3 carried_direction(const MeasureModel& model, const std::vector<std::int32_t>& nodes, Vec3 undeformed);

/// Largest minus smallest current coordinate of nodes along a direction; not_measurable without nodes.
double extent_along(const MeasureModel& model, const std::vector<std::int32_t>& nodes, Vec3 direction);

/// A vector of length one; zero stays zero.
Vec3 unit(Vec3 v);

/// The surface of a body as facets that face outwards. Vertices are numbered anew.
struct BodySurface {
  std::vector<Vec3> reference, position;  // per vertex
  std::vector<std::int64_t> label;  // of each vertex: the same for the same node or image of it in every surface
  std::vector<std::array<std::int32_t, 4>> facets;
};

/// The outside of the body formed by these elements.
BodySurface surface_of(const MeasureModel& model, const std::vector<std::int32_t>& elements);

/// The faces of all elements of a part, live or eroded, whose nodes lay within `tolerance` [m] of the plane at `height`
/// along a direction before anything happened. Pre: no node of the part lies beyond that plane.
BodySurface undeformed_face(const MeasureModel& model, int part, Vec3 direction, double height, double tolerance);

/// Completes the surface of a body that was modelled on one side of a plane of symmetry. `plane` is 0 or 1 and tells
/// the images in two planes apart.
void join_mirror_image(BodySurface& surface, Vec3 normal, Vec3 point, int plane);

/// The edge of a hole in a piece of surface.
struct Rim {
  std::vector<std::int32_t> vertices;  // in order around the hole
  double reference_area = 0.0;  // enclosed by the undeformed rim [m2]
};

/// What is left of a face of a body, and the holes in it.
struct FaceRest {
  std::vector<std::int32_t> facets;  // of the largest piece that is connected through edges
  std::vector<Rim> holes, outlines;
};

/// The rest of a face that was flat, with this outward normal, before anything happened. Facets that are not connected
/// through edges with the largest connected piece count as gone; so does what they enclose.
FaceRest rest_of_face(const BodySurface& surface, const std::vector<std::int32_t>& facets, Vec3 normal);

/// What a face has lost, compared with the undeformed face.
struct FaceLoss {
  bool any = false;
  double largest_at_outline = 0.0;  // undeformed area of the largest loss that reaches the face's outline [m2]
};
FaceLoss loss_of_face(const BodySurface& surface, const FaceRest& rest, const BodySurface& undeformed, Vec3 normal);

/// Whether the walls that begin at one rim lead to another without crossing the excluded facets.
bool walls_connect(const BodySurface& surface, const std::vector<bool>& excluded, const std::vector<Rim>& from,
                   const std::vector<Rim>& to);

/// Caliper (Feret) diameters and the area of a closed line, projected on a plane.
struct Opening {
  double largest = not_measurable, smallest = not_measurable;  // [m]
  double area = not_measurable;  // [m2]
};
Opening measure_opening(const std::vector<Vec3>& line, Vec3 normal);

/// Area of the convex hull of points that are projected on a plane [m2].
double hull_area(const std::vector<Vec3>& points, Vec3 normal);

}  // namespace kerf
