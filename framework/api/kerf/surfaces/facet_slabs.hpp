// Bounds of facets that decide about most nodes before anything is said about closest points, several at a time.
#pragma once

#include <kerf/contact.hpp>
#include <kerf/lanes.hpp>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <span>
#include <vector>

#include <kerf/surfaces/side_by_side.hpp>

namespace kerf::surfaces {

using LaneVectors = SideBySide<Lanes>;

/// Of every facet of a view, the flat cylinder that holds its four triangles, and how far it acts: as deep as `depth`
/// times the least of the longest edge of the undeformed facet, its longest edge now and the thickness V/A. It sees
/// somewhat farther, so that no node can come to lie too deep unseen.
class FacetSlabs {
 public:
  FacetSlabs(const ContactView& view, double depth) {
    const auto n = static_cast<std::size_t>(view.n_facets);
    for (auto* rows : {&centres_, &normals_, &sizes_}) rows->resize(n);
    for (std::size_t f = 0; f < n; f += register_lanes) measure(view, depth, f, std::min(f + register_lanes, n));
  }
  /// How far a facet sees, given its longest edge when it was undeformed [m].
  static double reach_of(double depth, double edge) { return sight * depth * edge; }
  static constexpr double sight = 1.25;  // over the greatest penetration that is held

  Vec3 centre(int facet) const { return vector(centres_[facet]); }
  Vec3 normal(int facet) const { return vector(normals_[facet]); }
  double size(int facet) const { return sizes_[facet].entry[0]; }  // longest edge [m]
  double reach(int facet) const { return sizes_[facet].entry[1]; }  // [m]
  double deepest(int facet) const { return sizes_[facet].entry[2]; }  // penetration that is held [m]
  double least_deepest() const { return least_deepest_; }  // of all facets [m]

  /// Where a node lies, seen from some facets: as many as there are lanes.
  struct Seen {
    LaneVectors normal;
    Lanes height, across;  // over the plane; square of the distance from the axis [m2]
    Lanes radius, warp, size, reach, deepest;

    Seen(const FacetSlabs& slabs, const std::int32_t* facet, Vec3 s) {
      LaneVectors d;
      Lanes unused;
      gather_rows(slabs.centres_.data()->entry, facet, d.x, d.y, d.z, radius);
      gather_rows(slabs.normals_.data()->entry, facet, normal.x, normal.y, normal.z, warp);
      gather_rows(slabs.sizes_.data()->entry, facet, size, reach, deepest, unused);
      d = {s.x - d.x, s.y - d.y, s.z - d.z};
      height = dot(d, normal);
      across = dot(d, d) - height * height;
    }
    /// Cosine between the facets' normals and a unit vector.
    Lanes along(Vec3 v) const { return normal.x * v.x + normal.y * v.y + normal.z * v.z; }
    /// Square of a distance that no point of the facet is closer than [m2].
    Lanes least_square() const {
      const Lanes zero{}, over = max_of(abs_of(height) - warp, zero);
      const Lanes beside = max_of(sqrt_of(max_of(across, zero)) - radius, zero);
      return (over * over + beside * beside) * (1.0 - 1e-6);  // far more than round-off
    }
    /// Whether the facet is taken to be able to push the node. A way to the closest point that is not straight leads
    /// sideways by the depth at most. Below a facet that is folded is below its mean plane, here.
    unsigned may_push() const {
      const Lanes seen = 1.01 * sight * deepest, most = radius + seen;
      return mask_of((height <= 1e-6 * size + warp) & (height >= -seen - warp) & (across <= most * most));
    }
    /// Whether the node may be within reach of the facet, given the square of a distance that it is not closer than.
    unsigned within_reach(Lanes least_square) const { return mask_of(least_square <= reach * reach); }
  };
  /// Calls `visit(facets, lanes in use)` for as many facets at a time as there are lanes, until it says true. Whether
  /// it did.
  template <class Visit>
  static bool until(std::span<const std::int32_t> facets, const Visit& visit) {
    std::int32_t rest[register_lanes];
    // One call, and hence one piece of code for all: what a facet gets must not depend on its place in the list.
    for (std::size_t k = 0; k < facets.size(); k += register_lanes) {
      const std::int32_t* some = facets.data() + k;
      unsigned in_use = all_lanes;
      if (k + register_lanes > facets.size()) {
        for (std::size_t l = 0; l < register_lanes; ++l) rest[l] = facets[std::min(k + l, facets.size() - 1)];
        some = rest;
        in_use = (1u << (facets.size() - k)) - 1u;
      }
      if (visit(some, in_use)) return true;
    }
    return false;
  }

 private:
  struct alignas(32) Row {
    double entry[4] = {};
  };
  static Vec3 vector(const Row& row) { return {row.entry[0], row.entry[1], row.entry[2]}; }
  static Lanes greater_root(const Lanes& a, const Lanes& b, const Lanes& c, const Lanes& d) {
    return sqrt_of(max_of(max_of(a, b), max_of(c, d)));
  }
  /// Some consecutive facets; lanes that are left over repeat the last one.
  void measure(const ContactView& view, double depth, std::size_t begin, std::size_t end) {
    std::int32_t node[4][register_lanes];
    alignas(64) double volume[register_lanes], edge[register_lanes], reach[register_lanes];
    for (std::size_t l = 0; l < register_lanes; ++l) {
      const std::size_t f = std::min(begin + l, end - 1);
      for (std::size_t k = 0; k < 4; ++k) node[k][l] = view.facet_nodes[4 * f + k];
      volume[l] = view.facet_volume[f];
      edge[l] = view.facet_edge[f];
      reach[l] = reach_of(depth, edge[l]);
    }
    LaneVectors x[4];
    for (int k = 0; k < 4; ++k) gather_vector(view.position, node[k], x[k].x, x[k].y, x[k].z);
    const Lanes zero{}, one = lanes(1.0), quarter = lanes(0.25), first_size = load_lanes(edge);
    const LaneVectors centre = (x[0] + x[1] + x[2] + x[3]) * quarter, twice = cross(x[2] - x[0], x[3] - x[1]);
    const Lanes length = sqrt_of(dot(twice, twice)), area = 0.5 * length;
    const LaneVectors normal = twice * (length > 0.0 ? one / length : zero);
    Lanes edges[4], spokes[4], warp = zero;
    for (int k = 0; k < 4; ++k) {
      const LaneVectors along = x[(k + 1) % 4] - x[k], d = x[k] - centre;
      edges[k] = dot(along, along);
      spokes[k] = dot(d, d);
      warp = max_of(abs_of(dot(d, normal)), warp);
    }
    const Lanes size = greater_root(edges[0], edges[1], edges[2], edges[3]);
    const Lanes radius = greater_root(spokes[0], spokes[1], spokes[2], spokes[3]);
    const Lanes thickness = area > 0.0 ? load_lanes(volume) / area : zero;
    const Lanes deepest = depth * min_of(min_of(thickness, size), first_size);
    store(centres_, begin, end, centre.x, centre.y, centre.z, radius);
    store(normals_, begin, end, normal.x, normal.y, normal.z, warp);
    store(sizes_, begin, end, size, load_lanes(reach), deepest, zero);
    for (std::size_t f = begin; f < end; ++f) least_deepest_ = min_of(least_deepest_, sizes_[f].entry[2]);
  }
  static void store(std::vector<Row>& rows, std::size_t begin, std::size_t end, const Lanes& a, const Lanes& b,
                    const Lanes& c, const Lanes& d) {
    for (std::size_t f = begin; f < end; ++f) {
      const auto l = static_cast<int>(f - begin);
      rows[f] = {{a[l], b[l], c[l], d[l]}};
    }
  }

  std::vector<Row> centres_;  // and the radius, across the normal [m]
  std::vector<Row> normals_;  // and the warp, along it [m]
  std::vector<Row> sizes_;  // longest edge, reach, greatest penetration [m]
  double least_deepest_ = 1e300;  // [m]
};

/// Of every facet of a view, how it moves along its normal, for the speeds at which nodes close in on it.
class FacetDrifts {
 public:
  void measure(const ContactView& view, const FacetSlabs& slabs) {
    const auto n = static_cast<std::size_t>(view.n_facets);
    rows_.resize(n);
    for (std::size_t f = 0; f < n; ++f) {
      const std::int32_t* c = view.facet_nodes + 4 * f;
      const Vec3 mean = (view.v(c[0]) + view.v(c[1]) + view.v(c[2]) + view.v(c[3])) * 0.25;
      const Vec3 normal = slabs.normal(static_cast<int>(f));
      rows_[f] = {{normal.x, normal.y, normal.z, dot(mean, normal)}};
    }
  }
  /// Speeds at which a node with a velocity closes in on some facets [m/s]: as many as there are lanes.
  Lanes closing(const std::int32_t* facet, Vec3 v) const {
    LaneVectors normal;
    Lanes along;
    gather_rows(rows_.data()->entry, facet, normal.x, normal.y, normal.z, along);
    return along - (normal.x * v.x + normal.y * v.y + normal.z * v.z);
  }

 private:
  struct alignas(32) Row {
    double entry[4] = {};
  };
  std::vector<Row> rows_;  // unit normal, and the mean speed of the corners along it [m/s]
};

}  // namespace kerf::surfaces
