// What measures share: connected bodies of live elements, principal axes, and the surfaces of bodies.
//
// A measure uses it with `using namespace kerf::bodies`. What is in the namespaces body_detail and hole_detail may
// change.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <cstring>
#include <iterator>
#include <limits>
#include <map>
#include <numeric>
#include <stdexcept>
#include <string>
#include <type_traits>
#include <unordered_map>
#include <utility>
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

/// Whether the model still holds a node of a part, and why there is nothing to measure where it does not. Collective.
bool any_node_left(const MeasureModel& model, MeasureRanks& ranks, int part);
std::string no_node_left(const std::string& part);

/// Number of a part. Throws std::runtime_error naming the measure where there is none of that name.
int measured_part(const MeasureModel& model, const std::string& part, const Plugin& measure);

/// Sums of n terms of each of `count` items of every rank: `terms(i)` is a std::array<double, n>. Collective.
template <std::size_t n, class Terms>
std::array<double, n> sum_terms(MeasureRanks& ranks, std::size_t count, const Terms& terms);

/// The items of all ranks on rank 0, one rank after the other; nothing elsewhere. Items are copied as bytes.
/// Collective.
template <class Item>
std::vector<Item> items_on_root(MeasureRanks& ranks, const std::vector<Item>& items);

/// What makes two elements belong to one body.
enum class Link { node, face };

/// A connected body of live elements of a part.
struct Body {
  std::vector<std::int32_t> elements;  // of this rank, ascending
  bool is_empty = true;  // on all ranks
};

/// The heaviest connected body of a part. Of two equally heavy bodies, the one with the lowest element. Masses are
/// compared in units of 2^-52 of the mass of all parts. Collective.
Body largest_body(const MeasureModel& model, MeasureRanks& ranks, int part, Link link);

/// Numbers of the nodes of a body that this rank owns, ascending. Collective.
std::vector<std::int32_t> nodes_of(const MeasureModel& model, MeasureRanks& ranks, const Body& body);

/// Numbers of the nodes of a part that this rank owns and that live elements touch, ascending.
std::vector<std::int32_t> live_nodes(const MeasureModel& model, int part);

Vec3 centroid(const MeasureModel& model, const MeasureModel::Element& element);

/// Direction of the largest second moment of a set of points, and how clearly it is the largest.
struct LongAxis {
  Vec3 direction;
  double rival = 1.0;  // the second largest moment over the largest; 1 where all directions are alike

  /// Whether the body is so much longer than wide that its axis has a meaning. A round rod has a rival of 0.9 where it
  /// is 0.91 diameters long; a shorter one is a disc.
  bool clear() const { return rival < 0.9; }
};

/// Long axis of the mass of a body in its current position. With a symmetry normal (not zero), that of the half body
/// together with its mirror image, looked for in the plane of symmetry. Collective.
LongAxis long_axis(const MeasureModel& model, MeasureRanks& ranks, const Body& body, Vec3 symmetry_normal);

/// Long axis of the nodes of a part in their undeformed positions, looked for in the same way. Collective.
LongAxis undeformed_long_axis(MeasureRanks& ranks, int part, Vec3 symmetry_normal);

/// Where the direction `undeformed` of the undeformed material points to now in a body with these nodes, which the
/// ranks own. Zero where the nodes do not tell. Collective.
Vec3 carried_direction(const MeasureModel& model, MeasureRanks& ranks, const std::vector<std::int32_t>& nodes,
                       Vec3 undeformed);

/// Least and greatest coordinate along a direction [m]; low > high where there is nothing.
struct Extent {
  double low = 0.0, high = 0.0;
  bool is_empty() const { return !(low <= high); }
};

/// Of the present places of nodes. Collective.
Extent extent_of(const MeasureModel& model, MeasureRanks& ranks, const std::vector<std::int32_t>& nodes,
                 Vec3 direction);

/// Of the undeformed nodes of a part. Collective.
Extent undeformed_extent(MeasureRanks& ranks, int part, Vec3 direction);

/// Largest minus smallest current coordinate of nodes along a direction; not_measurable without nodes. Collective.
double extent_along(const MeasureModel& model, MeasureRanks& ranks, const std::vector<std::int32_t>& nodes,
                    Vec3 direction);

/// A vector of length one; zero stays zero.
Vec3 unit(Vec3 v);

/// The surface of a body as facets that face outwards. Vertices are numbered anew.
struct BodySurface {
  std::vector<Vec3> reference, position;  // per vertex
  std::vector<std::int64_t> label;  // of each vertex: the same for the same node or image of it in every surface
  std::vector<std::array<std::int32_t, 4>> facets;
};

/// The outside of a body, on rank 0; an empty surface elsewhere. Collective.
BodySurface surface_of(const MeasureModel& model, MeasureRanks& ranks, const Body& body);

/// The faces of all elements of a part, live or eroded, whose nodes lay within `tolerance` [m] of the plane at `height`
/// along a direction before anything happened; as they were then, on rank 0, and an empty surface elsewhere. Pre: no
/// node of the part lies beyond that plane. Collective.
BodySurface undeformed_face(MeasureRanks& ranks, int part, Vec3 direction, double height, double tolerance);

/// Completes the surface of a body that was modelled on one side of a plane of symmetry. `plane` is 0 or 1 and tells
/// the images in two planes apart.
void join_mirror_image(BodySurface& surface, Vec3 normal, Vec3 point, int plane);

// ---- how it is done

namespace body_detail {

using Facet = std::array<std::int32_t, 4>;
using Key = MeasureRanks::Key;

template <class Nodes>
auto face_of(const Shape& shape, const Nodes& nodes, int face) {
  std::array<typename Nodes::value_type, 4> f{};
  for (std::size_t k = 0; k < 4; ++k) f[k] = nodes[static_cast<std::size_t>(shape.face[face][k])];
  return f;
}

template <class Id>
bool is_line(const std::array<Id, 4>& face_key) {
  return face_key[1] == face_key[2] || face_key[0] == face_key[1];
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

/// A face of an element under the sorted ids of its nodes, so that equal faces meet when sorted.
struct FaceEntry {
  Key key;
  std::int32_t element;
  int face;
  bool copied;  // other ranks may have all nodes of the face
  bool operator<(const FaceEntry& b) const { return key != b.key ? key < b.key : element < b.element; }
};

/// The faces of some elements but for those that are collapsed to a line.
inline std::vector<FaceEntry> sorted_faces(const MeasureModel& model, const std::vector<std::int32_t>& elements) {
  std::vector<FaceEntry> faces;
  faces.reserve(6 * elements.size());
  for (const std::int32_t e : elements) {
    const MeasureModel::Element& element = model.element(e);
    for (int f = 0; f < element.shape->n_faces; ++f) {
      FaceEntry entry{{}, e, f, true};
      const Facet nodes = face_of(*element.shape, element.nodes, f);
      for (std::size_t k = 0; k < 4; ++k) {
        entry.key[k] = model.node(nodes[k]).id;
        entry.copied = entry.copied && model.node(nodes[k]).copied;
      }
      entry.key = face_key(entry.key);
      if (!is_line(entry.key)) faces.push_back(entry);
    }
  }
  std::sort(faces.begin(), faces.end());
  return faces;
}

/// What an element of this rank may have in common with elements of other ranks.
struct Tie {
  Key key;
  std::int32_t element;
};

/// Joins the elements of this rank; returns the ties to other ranks.
inline std::vector<Tie> join_through_faces(const MeasureModel& model, const std::vector<std::int32_t>& elements,
                                           Groups& groups) {
  const std::vector<FaceEntry> faces = sorted_faces(model, elements);
  std::vector<Tie> ties;
  for (std::size_t i = 0; i < faces.size(); ++i) {
    if (i > 0 && faces[i].key == faces[i - 1].key)
      groups.join(faces[i].element, faces[i - 1].element);
    else if (faces[i].copied)
      ties.push_back({faces[i].key, faces[i].element});
  }
  return ties;
}

inline std::vector<Tie> join_through_nodes(const MeasureModel& model, const std::vector<std::int32_t>& elements,
                                           Groups& groups) {
  std::vector<std::int32_t> first(model.nodes.size(), -1);  // an element of each node
  std::vector<Tie> ties;
  for (const std::int32_t e : elements)
    for (const std::int32_t n : MeasureModel::nodes_of(model.element(e))) {
      std::int32_t& known = first[static_cast<std::size_t>(n)];
      if (known >= 0) {
        groups.join(known, e);
        continue;
      }
      known = e;
      if (model.node(n).copied) ties.push_back({{model.node(n).id, -1, -1, -1}, e});
    }
  return ties;
}

/// The least id of an element of each group, under the number of the group's root. Collective: groups of different
/// ranks that have a tie in common get the same.
inline std::vector<std::int64_t> name_groups(const MeasureModel& model, MeasureRanks& ranks,
                                             const std::vector<std::int32_t>& elements, const std::vector<Tie>& ties,
                                             Groups& groups) {
  std::vector<std::int64_t> name(model.elements.size(), std::numeric_limits<std::int64_t>::max());
  const auto of = [&](std::int32_t e) -> std::int64_t& { return name[static_cast<std::size_t>(groups.root(e))]; };
  for (const std::int32_t e : elements) of(e) = std::min(of(e), model.element(e).id);
  std::vector<Key> keys;
  for (const Tie& tie : ties) keys.push_back(tie.key);
  // Names spread from rank to rank, once as many ranks as a body extends over.
  for (bool changed = true; changed;) {
    std::vector<std::int64_t> mine;
    for (const Tie& tie : ties) mine.push_back(of(tie.element));
    const std::vector<std::int64_t> least = ranks.least_by_key(keys, mine);
    changed = false;
    for (std::size_t i = 0; i < ties.size(); ++i)
      if (least[i] < of(ties[i].element)) {
        of(ties[i].element) = least[i];
        changed = true;
      }
    changed = ranks.greatest({changed ? 1.0 : 0.0}).front() > 0.0;
  }
  return name;
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

/// Collective.
inline SymTensor second_moment(MeasureRanks& ranks, const std::vector<WeightedPoint>& points) {
  const auto [weight, x, y, z] = sum_terms<4>(ranks, points.size(), [&](std::size_t i) {
    const auto& [p, w] = points[i];
    return std::array{w, w * p.x, w * p.y, w * p.z};
  });
  const Vec3 mean = Vec3{x, y, z} * (1.0 / weight);
  const std::array<double, 6> sum = sum_terms<6>(ranks, points.size(), [&](std::size_t i) {
    const Vec3 d = points[i].position - mean;
    const double w = points[i].weight;
    return std::array{w * d.x * d.x, w * d.y * d.y, w * d.z * d.z, w * d.x * d.y, w * d.y * d.z, w * d.z * d.x};
  });
  return {sum[0], sum[1], sum[2], sum[3], sum[4], sum[5]};
}

/// Collective.
inline LongAxis long_axis_of(MeasureRanks& ranks, const std::vector<WeightedPoint>& points, Vec3 symmetry_normal) {
  const SymTensor m = second_moment(ranks, points);
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

/// A facet of a surface, by the ids of its nodes.
struct NamedFacet {
  Key nodes{};
  std::array<Vec3, 4> reference{}, position{};  // [m]
};

/// Makes a surface of the facets of all ranks, on rank 0. Its numbering does not depend on who had which. Collective.
inline BodySurface join_on_root(MeasureRanks& ranks, const std::vector<NamedFacet>& mine) {
  std::vector<NamedFacet> all = items_on_root(ranks, mine);
  std::sort(all.begin(), all.end(),
            [](const NamedFacet& a, const NamedFacet& b) { return face_key(a.nodes) < face_key(b.nodes); });
  BodySurface surface;
  std::unordered_map<std::int64_t, std::int32_t> number;
  for (const NamedFacet& f : all) {
    Facet facet{};
    for (std::size_t k = 0; k < 4; ++k) {
      const auto [at, is_new] = number.try_emplace(f.nodes[k], static_cast<std::int32_t>(surface.reference.size()));
      facet[k] = at->second;
      if (!is_new) continue;
      surface.reference.push_back(f.reference[k]);
      surface.position.push_back(f.position[k]);
      surface.label.push_back(4 * f.nodes[k]);  // the two lowest bits are for images
    }
    surface.facets.push_back(facet);
  }
  return surface;
}

}  // namespace body_detail

inline Vec3 unit(Vec3 v) {
  const double length = norm(v);
  return length > 0.0 ? v * (1.0 / length) : v;
}

inline std::string nothing_left(const std::string& part) { return "no element of part " + part + " is left"; }

template <std::size_t n, class Terms>
std::array<double, n> sum_terms(MeasureRanks& ranks, std::size_t count, const Terms& terms) {
  std::array<std::vector<double>, n> lists;
  for (std::vector<double>& list : lists) list.reserve(count);
  for (std::size_t i = 0; i < count; ++i) {
    const std::array<double, n> of_item = terms(i);
    for (std::size_t k = 0; k < n; ++k) lists[k].push_back(of_item[k]);
  }
  const std::vector<double> found = ranks.sums({lists.begin(), lists.end()});
  std::array<double, n> sums{};
  std::copy(found.begin(), found.end(), sums.begin());
  return sums;
}

template <class Item>
std::vector<Item> items_on_root(MeasureRanks& ranks, const std::vector<Item>& items) {
  static_assert(std::is_trivially_copyable_v<Item>);
  std::vector<char> bytes(items.size() * sizeof(Item));
  if (!items.empty()) std::memcpy(bytes.data(), items.data(), bytes.size());
  bytes = ranks.bytes_on_root(bytes);
  std::vector<Item> all(bytes.size() / sizeof(Item));
  if (!all.empty()) std::memcpy(all.data(), bytes.data(), all.size() * sizeof(Item));
  return all;
}

inline bool any_node_left(const MeasureModel& model, MeasureRanks& ranks, int part) {
  const bool here = std::any_of(model.nodes.begin(), model.nodes.end(),
                                [&](const MeasureModel::Node& n) { return n.mass > 0.0 && model.belongs_to(n, part); });
  return ranks.greatest({here ? 1.0 : 0.0}).front() > 0.0;
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
  for (const std::int32_t n : MeasureModel::nodes_of(element)) sum = sum + model.node(n).position;
  return sum * (1.0 / element.shape->n_nodes);
}

inline Body largest_body(const MeasureModel& model, MeasureRanks& ranks, int part, Link link) {
  std::vector<std::int32_t> elements;
  for (std::size_t e = 0; e < model.elements.size(); ++e)
    if (model.elements[e].part == part) elements.push_back(static_cast<std::int32_t>(e));
  body_detail::Groups groups(model.elements.size());
  const std::vector<body_detail::Tie> ties = link == Link::face
                                                 ? body_detail::join_through_faces(model, elements, groups)
                                                 : body_detail::join_through_nodes(model, elements, groups);
  const std::vector<std::int64_t> name = body_detail::name_groups(model, ranks, elements, ties, groups);
  // Masses in whole units: their sums do not depend on the order, and fit into a double.
  double all = 0.0;
  for (const double m : model.initial_mass) all += m;
  const double per_mass = all > 0.0 ? std::ldexp(1.0, 52 - std::ilogb(all) - 1) : 1.0;
  std::map<std::int64_t, std::int64_t> mass;  // of this rank's share of each group, by name
  const auto name_of = [&](std::int32_t e) { return name[static_cast<std::size_t>(groups.root(e))]; };
  for (const std::int32_t e : elements) mass[name_of(e)] += std::llround(model.element(e).mass * per_mass);
  std::vector<body_detail::Key> keys;
  std::vector<std::int64_t> mine;
  for (const auto& [group, m] : mass) {
    keys.push_back({group, -1, -1, -1});
    mine.push_back(m);
  }
  const std::vector<std::int64_t> total = ranks.sums_by_key(keys, mine);
  const auto heaviest = total.empty() ? total.end() : std::max_element(total.begin(), total.end());
  const double greatest = ranks.greatest({heaviest == total.end() ? -1.0 : static_cast<double>(*heaviest)}).front();
  double first = std::numeric_limits<double>::infinity();
  for (std::size_t k = 0; k < total.size(); ++k)
    if (static_cast<double>(total[k]) == greatest) first = std::min(first, static_cast<double>(keys[k][0]));
  first = ranks.least({first}).front();
  Body body;
  body.is_empty = !std::isfinite(first);
  std::copy_if(elements.begin(), elements.end(), std::back_inserter(body.elements),
               [&](std::int32_t e) { return static_cast<double>(name_of(e)) == first; });
  return body;
}

inline std::vector<std::int32_t> nodes_of(const MeasureModel& model, MeasureRanks& ranks, const Body& body) {
  std::vector<char> marked(model.nodes.size(), 0);
  for (const std::int32_t e : body.elements)
    for (const std::int32_t n : MeasureModel::nodes_of(model.element(e))) marked[static_cast<std::size_t>(n)] = 1;
  // The owner of a node may have no element of the body.
  std::vector<body_detail::Key> keys;
  std::vector<std::int32_t> copied;
  std::vector<std::int64_t> mine;
  for (std::size_t n = 0; n < model.nodes.size(); ++n) {
    if (!model.nodes[n].copied) continue;
    copied.push_back(static_cast<std::int32_t>(n));
    keys.push_back({model.nodes[n].id, -1, -1, -1});
    mine.push_back(marked[n]);
  }
  const std::vector<std::int64_t> found = ranks.sums_by_key(keys, mine);
  for (std::size_t i = 0; i < copied.size(); ++i) marked[static_cast<std::size_t>(copied[i])] = found[i] > 0 ? 1 : 0;
  std::vector<std::int32_t> nodes;
  for (std::size_t n = 0; n < model.nodes.size(); ++n)
    if (marked[n] != 0 && model.nodes[n].owned) nodes.push_back(static_cast<std::int32_t>(n));
  return nodes;
}

inline std::vector<std::int32_t> live_nodes(const MeasureModel& model, int part) {
  std::vector<std::int32_t> nodes;
  for (std::size_t n = 0; n < model.nodes.size(); ++n)
    if (model.nodes[n].owned && !model.nodes[n].free && model.belongs_to(model.nodes[n], part))
      nodes.push_back(static_cast<std::int32_t>(n));
  return nodes;
}

inline LongAxis long_axis(const MeasureModel& model, MeasureRanks& ranks, const Body& body, Vec3 symmetry_normal) {
  std::vector<body_detail::WeightedPoint> points;
  for (const std::int32_t e : body.elements)
    points.push_back({centroid(model, model.element(e)), model.element(e).mass});
  return body_detail::long_axis_of(ranks, points, symmetry_normal);
}

inline LongAxis undeformed_long_axis(MeasureRanks& ranks, int part, Vec3 symmetry_normal) {
  std::vector<body_detail::WeightedPoint> points;
  for (const Vec3 x : ranks.undeformed_nodes(part)) points.push_back({x, 1.0});
  return body_detail::long_axis_of(ranks, points, symmetry_normal);
}

inline Vec3 carried_direction(const MeasureModel& model, MeasureRanks& ranks, const std::vector<std::int32_t>& nodes,
                              Vec3 undeformed) {
  const auto height = [&](std::size_t i) { return dot(model.node(nodes[i]).reference, undeformed); };
  const auto place = [&](std::size_t i) { return model.node(nodes[i]).position; };
  const std::array<double, 5> sum = sum_terms<5>(ranks, nodes.size(), [&](std::size_t i) {
    return std::array{1.0, height(i), place(i).x, place(i).y, place(i).z};
  });
  const double mean = sum[1] / sum[0];
  const Vec3 centre = Vec3{sum[2], sum[3], sum[4]} * (1.0 / sum[0]);
  // Covariance of the undeformed height and the present position.
  const auto [x, y, z] = sum_terms<3>(ranks, nodes.size(), [&](std::size_t i) {
    const Vec3 term = (height(i) - mean) * (place(i) - centre);
    return std::array{term.x, term.y, term.z};
  });
  return unit({x, y, z});
}

namespace body_detail {

/// Collective.
template <class Points>
Extent extent_of_points(MeasureRanks& ranks, const Points& points, Vec3 direction) {
  double low = std::numeric_limits<double>::infinity(), below = low;  // below: of the opposite direction
  for (const Vec3 x : points) {
    low = std::min(low, dot(x, direction));
    below = std::min(below, -dot(x, direction));
  }
  const std::vector<double> least = ranks.least({low, below});
  return {least[0], -least[1]};
}

}  // namespace body_detail

inline Extent extent_of(const MeasureModel& model, MeasureRanks& ranks, const std::vector<std::int32_t>& nodes,
                        Vec3 direction) {
  std::vector<Vec3> places;
  for (const std::int32_t n : nodes) places.push_back(model.node(n).position);
  return body_detail::extent_of_points(ranks, places, direction);
}

inline Extent undeformed_extent(MeasureRanks& ranks, int part, Vec3 direction) {
  return body_detail::extent_of_points(ranks, ranks.undeformed_nodes(part), direction);
}

inline double extent_along(const MeasureModel& model, MeasureRanks& ranks, const std::vector<std::int32_t>& nodes,
                           Vec3 direction) {
  const Extent found = extent_of(model, ranks, nodes, direction);
  return found.is_empty() ? not_measurable : found.high - found.low;
}

inline BodySurface surface_of(const MeasureModel& model, MeasureRanks& ranks, const Body& body) {
  const std::vector<body_detail::FaceEntry> faces = body_detail::sorted_faces(model, body.elements);
  std::vector<body_detail::FaceEntry> outside;
  std::vector<body_detail::Key> keys;  // of faces that may be inside, because other ranks have them too
  for (std::size_t i = 0; i < faces.size(); ++i) {
    const body_detail::Key& key = faces[i].key;
    if ((i > 0 && key == faces[i - 1].key) || (i + 1 < faces.size() && key == faces[i + 1].key)) continue;
    outside.push_back(faces[i]);
    if (faces[i].copied) keys.push_back(key);
  }
  const std::vector<std::int64_t> times = ranks.sums_by_key(keys, std::vector<std::int64_t>(keys.size(), 1));
  std::vector<body_detail::NamedFacet> facets;
  auto next = times.begin();
  for (const body_detail::FaceEntry& face : outside) {
    if (face.copied && *next++ > 1) continue;
    const MeasureModel::Element& element = model.element(face.element);
    const body_detail::Facet nodes = body_detail::face_of(*element.shape, element.nodes, face.face);
    body_detail::NamedFacet facet;
    for (std::size_t k = 0; k < 4; ++k) {
      const MeasureModel::Node& node = model.node(nodes[k]);
      facet.nodes[k] = node.id;
      facet.reference[k] = node.reference;
      facet.position[k] = node.position;
    }
    facets.push_back(facet);
  }
  return body_detail::join_on_root(ranks, facets);
}

inline BodySurface undeformed_face(MeasureRanks& ranks, int part, Vec3 direction, double height, double tolerance) {
  const Shape& shape = ranks.shape(part);
  std::vector<body_detail::NamedFacet> facets;
  ranks.visit_undeformed(part, [&](const MeasureRanks::UndeformedElement& e) {
    for (int f = 0; f < shape.n_faces; ++f) {
      const std::array<Vec3, 4> places = body_detail::face_of(shape, e.places, f);
      if (!std::all_of(places.begin(), places.end(),
                       [&](Vec3 x) { return std::fabs(dot(x, direction) - height) <= tolerance; }))
        continue;
      const body_detail::Key nodes = body_detail::face_of(shape, e.nodes, f);
      if (!body_detail::is_line(face_key(nodes))) facets.push_back({nodes, places, places});
    }
  });
  return body_detail::join_on_root(ranks, facets);
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
