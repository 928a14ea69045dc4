// What measures share: connected bodies of live elements, principal axes, and surfaces with holes.
#pragma once

#include <array>
#include <cstdint>
#include <limits>
#include <string>
#include <utility>
#include <vector>

#include "kerf/measure.hpp"

namespace kerf {

/// What a measure returns where there is nothing to measure.
inline constexpr double not_measurable = std::numeric_limits<double>::quiet_NaN();

using MeasuredValues = std::vector<std::pair<std::string, double>>;

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

/// Direction of the largest second moment of mass of the elements in their current positions. With a symmetry
/// normal (not zero), that of the half body together with its mirror image.
Vec3 long_axis(const MeasureModel& model, const std::vector<std::int32_t>& elements, Vec3 symmetry_normal);

/// Largest minus smallest current coordinate of nodes along a direction; not_measurable without nodes.
double extent_along(const MeasureModel& model, const std::vector<std::int32_t>& nodes, Vec3 direction);

/// A vector of length one; zero stays zero.
Vec3 unit(Vec3 v);

/// The surface of a body as facets that face outwards. Vertices are numbered anew.
struct BodySurface {
  std::vector<Vec3> reference, position;  // per vertex
  std::vector<std::array<std::int32_t, 4>> facets;
};

/// The outside of the body formed by these elements.
BodySurface surface_of(const MeasureModel& model, const std::vector<std::int32_t>& elements);

/// Completes the surface of a body that was modelled on one side of a plane of symmetry.
void join_mirror_image(BodySurface& surface, Vec3 normal, Vec3 point);

/// The edge of a hole in a piece of surface.
struct Rim {
  std::vector<std::int32_t> vertices;  // in order around the hole
  double reference_area = 0.0;  // enclosed by the undeformed rim [m2]
};

/// The holes of a piece of surface that was flat, with this outward normal, before anything happened. Facets that
/// are not connected through edges with the largest connected piece count as gone; so does what they enclose.
std::vector<Rim> find_holes(const BodySurface& surface, const std::vector<std::int32_t>& facets, Vec3 normal);

/// Whether the walls that begin at one rim lead to another without crossing the excluded facets.
bool walls_connect(const BodySurface& surface, const std::vector<bool>& excluded, const std::vector<Rim>& from,
                   const std::vector<Rim>& to);

/// Caliper (Feret) diameters and the area of a closed line, projected on a plane.
struct Opening {
  double largest = not_measurable, smallest = not_measurable;  // [m]
  double area = not_measurable;  // [m2]
};
Opening measure_opening(const std::vector<Vec3>& line, Vec3 normal);

}  // namespace kerf
