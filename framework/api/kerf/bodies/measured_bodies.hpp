// What measures share: connected bodies of live elements, principal axes, and the surfaces of bodies.
//
// A measure uses it with `using namespace kerf::bodies`. What is in the namespaces body_detail and hole_detail may
// change.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <limits>
#include <numeric>
#include <stdexcept>
#include <string>
#include <unordered_map>
#include <vector>

#include "kerf/measure.hpp"
#include "kerf/shape.hpp"

namespace kerf::bodies {

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

// ---- how it is done

namespace body_detail {

using Facet = std::array<std::int32_t, 4>;

inline Facet face_of(const MeasureModel::Element& e, int face) {
  Facet f{};
  for (int k = 0; k < 4; ++k)
    f[static_cast<std::size_t>(k)] = e.nodes[static_cast<std::size_t>(e.shape->face[face][k])];
  return f;
}

/// Disjoint sets; the root of each is its smallest member.
class Groups {
 public:
  explicit Groups(std::size_t n) : parent_(n) { std::iota(parent_.begin(), parent_.end(), 0); }
  std::int32_t root(std::int32_t i) {
    while (at(i) != i) i = at(i) = at(at(i));
    return i;
  }
  void join(std::int32_t a, std::int32_t b) {
    a = root(a);
    b = root(b);
    at(std::max(a, b)) = std::min(a, b);
  }

 private:
  std::int32_t& at(std::int32_t i) { return parent_[static_cast<std::size_t>(i)]; }
  std::vector<std::int32_t> parent_;
};

/// A face of an element under the sorted numbers of its nodes, so that equal faces meet when sorted.
struct FaceEntry {
  Facet key;
  std::int32_t element;
  int face;
  bool operator<(const FaceEntry& b) const { return key != b.key ? key < b.key : element < b.element; }
};

inline std::vector<FaceEntry> sorted_faces(const MeasureModel& model, const std::vector<std::int32_t>& elements) {
  std::vector<FaceEntry> faces;
  faces.reserve(6 * elements.size());
  for (const std::int32_t e : elements) {
    const MeasureModel::Element& element = model.elements[static_cast<std::size_t>(e)];
    for (int f = 0; f < element.shape->n_faces; ++f) faces.push_back({face_key(face_of(element, f)), e, f});
  }
  std::sort(faces.begin(), faces.end());
  return faces;
}

inline void join_through_faces(const MeasureModel& model, const std::vector<std::int32_t>& elements, Groups& groups) {
  const std::vector<FaceEntry> faces = sorted_faces(model, elements);
  for (std::size_t i = 1; i < faces.size(); ++i)
    if (faces[i].key == faces[i - 1].key) groups.join(faces[i].element, faces[i - 1].element);
}

inline void join_through_nodes(const MeasureModel& model, const std::vector<std::int32_t>& elements, Groups& groups) {
  std::vector<std::int32_t> first(model.nodes.size(), -1);  // an element of each node
  for (const std::int32_t e : elements) {
    for (const std::int32_t n : MeasureModel::nodes_of(model.elements[static_cast<std::size_t>(e)])) {
      std::int32_t& known = first[static_cast<std::size_t>(n)];
      if (known < 0)
        known = e;
      else
        groups.join(known, e);
    }
  }
}

/// Eigenvector of the largest eigenvalue, and the second largest over the largest, by Jacobi rotations (Golub & Van
/// Loan, Matrix Computations, 8.5).
inline LongAxis dominant_direction(SymTensor t) {
  double a[3][3] = {{t.xx, t.xy, t.zx}, {t.xy, t.yy, t.yz}, {t.zx, t.yz, t.zz}};
  double v[3][3] = {{1.0, 0.0, 0.0}, {0.0, 1.0, 0.0}, {0.0, 0.0, 1.0}};
  for (int sweep = 0; sweep < 30; ++sweep) {
    for (int p = 0; p < 2; ++p) {
      for (int q = p + 1; q < 3; ++q) {
        if (a[p][q] == 0.0) continue;
        const double theta = (a[q][q] - a[p][p]) / (2.0 * a[p][q]);
        const double tangent = std::copysign(1.0, theta) / (std::fabs(theta) + kerf::hypot(theta, 1.0));
        const double c = 1.0 / kerf::hypot(tangent, 1.0), s = tangent * c;
        for (int k = 0; k < 3; ++k) {
          const double x = a[k][p], y = a[k][q];
          a[k][p] = c * x - s * y;
          a[k][q] = s * x + c * y;
        }
        for (int k = 0; k < 3; ++k) {
          const double x = a[p][k], y = a[q][k], vx = v[k][p], vy = v[k][q];
          a[p][k] = c * x - s * y;
          a[q][k] = s * x + c * y;
          v[k][p] = c * vx - s * vy;
          v[k][q] = s * vx + c * vy;
        }
      }
    }
  }
  int best = 0;
  for (int i = 1; i < 3; ++i)
    if (a[i][i] > a[best][best]) best = i;
  const double second = std::max(a[(best + 1) % 3][(best + 1) % 3], a[(best + 2) % 3][(best + 2) % 3]);
  return {unit({v[0][best], v[1][best], v[2][best]}), a[best][best] > 0.0 ? second / a[best][best] : 1.0};
}

struct WeightedPoint {
  Vec3 position;
  double weight;
};

inline SymTensor second_moment(const std::vector<WeightedPoint>& points) {
  double weight = 0.0;
  Vec3 mean;
  for (const WeightedPoint& p : points) {
    weight += p.weight;
    mean = mean + p.weight * p.position;
  }
  mean = mean * (1.0 / weight);
  SymTensor sum;
  for (const WeightedPoint& p : points) {
    const Vec3 d = p.position - mean;
    sum = sum + p.weight * SymTensor{d.x * d.x, d.y * d.y, d.z * d.z, d.x * d.y, d.y * d.z, d.z * d.x};
  }
  return sum;
}

inline LongAxis long_axis_of(const std::vector<WeightedPoint>& points, Vec3 symmetry_normal) {
  const SymTensor m = second_moment(points);
  const Vec3 s = unit(symmetry_normal);
  if (dot(s, s) == 0.0) return dominant_direction(m);
  // Body and image together have no moment across the plane and its normal. The axis is looked for in the plane,
  // so the moment is projected on it: P m P with P = 1 - s s.
  const auto project = [s](Vec3 a) { return a - dot(a, s) * s; };
  const Vec3 p[3] = {project({1.0, 0.0, 0.0}), project({0.0, 1.0, 0.0}), project({0.0, 0.0, 1.0})};
  const auto moment = [&m](Vec3 a, Vec3 b) {
    const Vec3 mb{m.xx * b.x + m.xy * b.y + m.zx * b.z, m.xy * b.x + m.yy * b.y + m.yz * b.z,
                  m.zx * b.x + m.yz * b.y + m.zz * b.z};
    return dot(a, mb);
  };
  return dominant_direction({moment(p[0], p[0]), moment(p[1], p[1]), moment(p[2], p[2]), moment(p[0], p[1]),
                             moment(p[1], p[2]), moment(p[2], p[0])});
}

/// Adds a vertex of a surface for a node, once, and returns its number.
class Vertices {
 public:
  Vertices(const MeasureModel& model, BodySurface& surface) : model_(model), surface_(surface) {}
  std::int32_t of(std::int32_t n) {
    const auto [at, is_new] = number_.try_emplace(n, static_cast<std::int32_t>(surface_.reference.size()));
    if (is_new) {
      const MeasureModel::Node& node = model_.nodes[static_cast<std::size_t>(n)];
      surface_.reference.push_back(node.reference);
      surface_.position.push_back(node.position);
      surface_.label.push_back(4 * static_cast<std::int64_t>(n));  // the two lowest bits are for images
    }
    return at->second;
  }

 private:
  const MeasureModel& model_;
  BodySurface& surface_;
  std::unordered_map<std::int32_t, std::int32_t> number_;
};

/// Whether a face, by its key, is a line because its element is collapsed there. It bounds nothing.
inline bool is_line(const Facet& key) { return key[1] == key[2] || key[0] == key[1]; }

}  // namespace body_detail

inline Vec3 unit(Vec3 v) {
  const double length = norm(v);
  return length > 0.0 ? v * (1.0 / length) : v;
}

inline std::string nothing_left(const std::string& part) { return "no element of part " + part + " is left"; }

inline bool any_node_left(const MeasureModel& model, int part) {
  return std::any_of(model.nodes.begin(), model.nodes.end(),
                     [&](const MeasureModel::Node& n) { return model.belongs_to(n, part) && n.id >= 0; });
}

inline std::string no_node_left(const std::string& part) { return "all nodes of part " + part + " have been dropped"; }

inline MeasuredValue value_of_remnant(double value, const std::string& part) {
  return std::isnan(value) ? unknown("", nothing_left(part)) : MeasuredValue{"", value};
}

inline int measured_part(const MeasureModel& model, const std::string& part, const Plugin& measure) {
  const auto at = std::find(model.parts.begin(), model.parts.end(), part);
  if (at == model.parts.end())
    throw std::runtime_error("measure " + measure.label + ": there is no part named " + part);
  return static_cast<int>(at - model.parts.begin());
}

inline Vec3 centroid(const MeasureModel& model, const MeasureModel::Element& element) {
  Vec3 sum;
  for (const std::int32_t n : MeasureModel::nodes_of(element))
    sum = sum + model.nodes[static_cast<std::size_t>(n)].position;
  return sum * (1.0 / element.shape->n_nodes);
}

inline std::vector<std::int32_t> largest_body(const MeasureModel& model, int part, Link link) {
  std::vector<std::int32_t> elements;
  for (std::size_t e = 0; e < model.elements.size(); ++e)
    if (model.elements[e].part == part) elements.push_back(static_cast<std::int32_t>(e));
  body_detail::Groups groups(model.elements.size());
  if (link == Link::face)
    body_detail::join_through_faces(model, elements, groups);
  else
    body_detail::join_through_nodes(model, elements, groups);
  std::vector<double> mass(model.elements.size(), 0.0);
  for (const std::int32_t e : elements)
    mass[static_cast<std::size_t>(groups.root(e))] += model.elements[static_cast<std::size_t>(e)].mass;
  const auto heaviest = static_cast<std::int32_t>(std::max_element(mass.begin(), mass.end()) - mass.begin());
  std::vector<std::int32_t> body;
  std::copy_if(elements.begin(), elements.end(), std::back_inserter(body),
               [&](std::int32_t e) { return groups.root(e) == heaviest; });
  return body;
}

inline std::vector<std::int32_t> nodes_of(const MeasureModel& model, const std::vector<std::int32_t>& elements) {
  std::vector<std::int32_t> nodes;
  for (const std::int32_t e : elements) {
    const auto& of_element = model.elements[static_cast<std::size_t>(e)].nodes;
    nodes.insert(nodes.end(), of_element.begin(), of_element.end());
  }
  std::sort(nodes.begin(), nodes.end());
  nodes.erase(std::unique(nodes.begin(), nodes.end()), nodes.end());
  return nodes;
}

inline LongAxis long_axis(const MeasureModel& model, const std::vector<std::int32_t>& elements, Vec3 symmetry_normal) {
  std::vector<body_detail::WeightedPoint> points;
  for (const std::int32_t i : elements) {
    const MeasureModel::Element& e = model.elements[static_cast<std::size_t>(i)];
    points.push_back({centroid(model, e), e.mass});
  }
  return body_detail::long_axis_of(points, symmetry_normal);
}

inline LongAxis undeformed_long_axis(const MeasureModel& model, int part, Vec3 symmetry_normal) {
  std::vector<body_detail::WeightedPoint> points;
  for (const MeasureModel::Node& n : model.nodes)
    if (model.belongs_to(n, part)) points.push_back({n.reference, 1.0});
  return body_detail::long_axis_of(points, symmetry_normal);
}

inline Vec3 carried_direction(const MeasureModel& model, const std::vector<std::int32_t>& nodes, Vec3 undeformed) {
  const auto node = [&](std::int32_t n) -> const MeasureModel::Node& {
    return model.nodes[static_cast<std::size_t>(n)];
  };
  double mean_height = 0.0;
  for (const std::int32_t n : nodes) mean_height += dot(node(n).reference, undeformed);
  mean_height /= static_cast<double>(nodes.size());
  // Covariance of the undeformed height and the present position.
  Vec3 sum;
  for (const std::int32_t n : nodes)
    sum = sum + (dot(node(n).reference, undeformed) - mean_height) * (node(n).position - node(nodes.front()).position);
  return unit(sum);
}

inline double extent_along(const MeasureModel& model, const std::vector<std::int32_t>& nodes, Vec3 direction) {
  if (nodes.empty()) return not_measurable;
  double low = std::numeric_limits<double>::infinity(), high = -low;
  for (const std::int32_t n : nodes) {
    const double s = dot(model.nodes[static_cast<std::size_t>(n)].position, direction);
    low = std::min(low, s);
    high = std::max(high, s);
  }
  return high - low;
}

inline BodySurface surface_of(const MeasureModel& model, const std::vector<std::int32_t>& elements) {
  BodySurface surface;
  body_detail::Vertices vertices(model, surface);
  const std::vector<body_detail::FaceEntry> faces = body_detail::sorted_faces(model, elements);
  for (std::size_t i = 0; i < faces.size(); ++i) {
    const body_detail::Facet& key = faces[i].key;
    if ((i > 0 && key == faces[i - 1].key) || (i + 1 < faces.size() && key == faces[i + 1].key)) continue;
    if (body_detail::is_line(key)) continue;
    body_detail::Facet facet =
        body_detail::face_of(model.elements[static_cast<std::size_t>(faces[i].element)], faces[i].face);
    for (std::int32_t& n : facet) n = vertices.of(n);
    surface.facets.push_back(facet);
  }
  return surface;
}

inline BodySurface undeformed_face(const MeasureModel& model, int part, Vec3 direction, double height,
                                   double tolerance) {
  std::vector<char> in_plane(model.nodes.size(), 0);
  for (std::size_t n = 0; n < model.nodes.size(); ++n)
    in_plane[n] = model.belongs_to(model.nodes[n], part) &&
                  std::fabs(dot(model.nodes[n].reference, direction) - height) <= tolerance;
  BodySurface surface;
  body_detail::Vertices vertices(model, surface);
  for (const auto* elements : {&model.elements, &model.eroded})
    for (const MeasureModel::Element& e : *elements) {
      if (e.part != part) continue;
      for (int f = 0; f < e.shape->n_faces; ++f) {
        body_detail::Facet facet = body_detail::face_of(e, f);
        if (!std::all_of(facet.begin(), facet.end(),
                         [&](auto n) { return in_plane[static_cast<std::size_t>(n)] != 0; }))
          continue;
        if (body_detail::is_line(face_key(facet))) continue;
        for (std::int32_t& n : facet) n = vertices.of(n);
        surface.facets.push_back(facet);
      }
    }
  return surface;
}

inline void join_mirror_image(BodySurface& surface, Vec3 normal, Vec3 point, int plane) {
  const Vec3 s = unit(normal);
  const auto height = [&](Vec3 x) { return dot(x - point, s); };
  // Vertices within a millionth of the body's height above the plane are their own image.
  double highest = 0.0;
  for (const Vec3 x : surface.reference) highest = std::max(highest, std::fabs(height(x)));
  const std::size_t n_vertices = surface.reference.size();
  std::vector<std::int32_t> image(n_vertices);
  for (std::size_t v = 0; v < n_vertices; ++v) {
    const Vec3 x = surface.reference[v], now = surface.position[v];
    if (std::fabs(height(x)) <= 1e-6 * highest) {
      image[v] = static_cast<std::int32_t>(v);
      continue;
    }
    image[v] = static_cast<std::int32_t>(surface.reference.size());
    surface.reference.push_back(x - 2.0 * height(x) * s);
    surface.position.push_back(now - 2.0 * height(now) * s);
    surface.label.push_back(surface.label[v] ^ (std::int64_t{1} << plane));
  }
  // Facets in the plane lie inside the whole body. An image turns the other way round.
  std::vector<body_detail::Facet> facets;
  for (const body_detail::Facet& f : surface.facets) {
    body_detail::Facet mirrored{};
    for (std::size_t k = 0; k < 4; ++k) mirrored[3 - k] = image[static_cast<std::size_t>(f[k])];
    if (std::equal(f.begin(), f.end(), mirrored.rbegin())) continue;
    facets.push_back(f);
    facets.push_back(mirrored);
  }
  surface.facets = std::move(facets);
}

}  // namespace kerf::bodies
