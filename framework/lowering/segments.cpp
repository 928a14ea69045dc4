// Finds the exterior facets of the mesh of a deck, and sets of nodes that hold some of them and no others.
#include "lowering/segments.hpp"

#include <fmt/format.h>

#include <algorithm>

#include "kerf/mesh.hpp"

namespace kerf::lowering {
namespace {

std::array<std::int32_t, 4> sorted(std::array<std::int32_t, 4> nodes) {
  std::sort(nodes.begin(), nodes.end());
  return nodes;
}

/// The nodes of a facet with each node once in front and the last one again behind: one key for a triangle, whichever
/// of its corners is repeated. False where it is a line or a point.
bool make_key(const std::array<std::int32_t, 4>& nodes, std::array<std::int32_t, 4>& key) {
  key = sorted(nodes);
  const auto end = std::unique(key.begin(), key.end());
  if (end - key.begin() < 3) return false;
  std::fill(end, key.end(), *(end - 1));
  return true;
}

/// Whether the corners of two facets of the same nodes go round the same way.
bool same_way(const std::array<std::int32_t, 4>& a, const std::array<std::int32_t, 4>& b) {
  for (std::size_t k = 0; k < 4; ++k) {
    const std::int32_t here = a[k], next = a[(k + 1) % 4];
    if (here == next) continue;
    for (std::size_t j = 0; j < 4; ++j)
      if (b[j] == here && b[(j + 1) % 4] == next) return true;
  }
  return false;
}

}  // namespace

SegmentSets::SegmentSets(Lowering& low)
    : low_(low), facets_of_node_(low.mesh.mesh.points.size()), index_(low.mesh.mesh.node_labels) {
  find_exterior();
}

void SegmentSets::find_exterior() {
  std::vector<Facet> all;
  for (const auto& cell : low_.mesh.mesh.cells)
    for (int f = 0; f < hexahedron.n_faces; ++f) {
      Facet facet{};
      for (std::size_t k = 0; k < 4; ++k) facet.nodes[k] = cell[static_cast<std::size_t>(hexahedron.face[f][k])];
      if (make_key(facet.nodes, facet.key)) all.push_back(facet);
    }
  std::sort(all.begin(), all.end(), [](const Facet& a, const Facet& b) { return a.key < b.key; });
  for (std::size_t k = 0; k < all.size(); ++k) {
    const bool shared = (k > 0 && all[k - 1].key == all[k].key) || (k + 1 < all.size() && all[k + 1].key == all[k].key);
    if (!shared) exterior_.push_back(all[k]);
  }
  for (std::size_t k = 0; k < exterior_.size(); ++k)
    for (std::size_t c = 0; c < 4; ++c)
      if (c == 0 || exterior_[k].key[c] != exterior_[k].key[c - 1])
        facets_of_node_[static_cast<std::size_t>(exterior_[k].key[c])].push_back(static_cast<std::int32_t>(k));
}

Segment SegmentSets::of_nodes(std::array<std::int32_t, 4> nodes, const Origin& where) {
  Facet facet{};
  facet.nodes = nodes;
  const bool face = make_key(nodes, facet.key);
  const auto at = std::lower_bound(exterior_.begin(), exterior_.end(), facet,
                                   [](const Facet& a, const Facet& b) { return a.key < b.key; });
  if (!face || at == exterior_.end() || at->key != facet.key) {
    low_.refuse(where, "a segment is no exterior face of a solid; expected one");
    return {};
  }
  return {static_cast<std::int32_t>(at - exterior_.begin()), same_way(nodes, at->nodes)};
}

Segment SegmentSets::segment(const std::array<std::int64_t, 4>& ids, const Origin& where) {
  std::array<std::int32_t, 4> nodes{};
  for (std::size_t k = 0; k < 4; ++k) {
    const std::int64_t id = k == 3 && ids[3] == 0 ? ids[2] : ids[k];
    nodes[k] = index_.find(id);
    if (nodes[k] < 0) {
      low_.error(where, fmt::format("a segment names node {}, which is not defined", id));
      return {};
    }
  }
  return of_nodes(nodes, where);
}

std::vector<Segment> SegmentSets::segments_of(std::int64_t set, const Origin& where) {
  std::vector<Segment> segments;
  bool found = false;
  for (const MeshFaceSet& faces : low_.mesh.mesh.face_sets) {
    if (faces.label != set) continue;
    found = true;
    for (const auto& face : faces.faces) segments.push_back(of_nodes(face, where));
  }
  if (!found)
    low_.error(where, fmt::format("segment set {} is not defined", set));
  else if (segments.empty())
    low_.error(where, fmt::format("segment set {} is empty; expected segments", set));
  return segments;
}

std::vector<std::pair<std::string, double>> SegmentSets::of(const std::vector<Segment>& segments, const Origin& where) {
  std::vector<std::int32_t> outward, inward;
  for (const Segment& segment : segments)
    if (segment.facet >= 0) (segment.outward ? outward : inward).push_back(segment.facet);
  std::vector<std::pair<std::string, double>> found;
  for (auto& [facets, sign] : {std::pair{&outward, 1.0}, std::pair{&inward, -1.0}}) {
    std::sort(facets->begin(), facets->end());
    if (std::adjacent_find(facets->begin(), facets->end()) != facets->end())
      low_.refuse(where, "a segment is loaded twice by one load; write a load of its own for the second time");
    divide(*facets, sign, where, found);
  }
  return found;
}

std::vector<std::string> SegmentSets::facets_of(const std::vector<Segment>& segments, const Origin& where) {
  std::vector<std::int32_t> facets;
  for (const Segment& segment : segments)
    if (segment.facet >= 0) facets.push_back(segment.facet);
  std::sort(facets.begin(), facets.end());
  facets.erase(std::unique(facets.begin(), facets.end()), facets.end());
  std::vector<std::pair<std::string, double>> found;
  divide(std::move(facets), 1.0, where, found);
  std::vector<std::string> names;
  for (auto& [name, sign] : found) names.push_back(std::move(name));
  return names;
}

/// Cuts the facets across their longest extent until each set of nodes holds no others.
void SegmentSets::divide(std::vector<std::int32_t> facets, double sign, const Origin& where,
                         std::vector<std::pair<std::string, double>>& found) {
  if (facets.empty()) return;
  if (facets.size() == 1 || holds_no_other(facets)) {
    std::vector<std::int32_t> nodes;
    for (const std::int32_t facet : facets)
      for (const std::int32_t node : exterior_[static_cast<std::size_t>(facet)].key) nodes.push_back(node);
    found.emplace_back(low_.nodes("segments", std::move(nodes), where), sign);
    return;
  }
  std::array<double, 3> least = middle(facets.front()), most = least;
  for (const std::int32_t facet : facets)
    for (std::size_t d = 0; d < 3; ++d) {
      least[d] = std::min(least[d], middle(facet)[d]);
      most[d] = std::max(most[d], middle(facet)[d]);
    }
  std::size_t axis = 0;
  for (std::size_t d = 1; d < 3; ++d)
    if (most[d] - least[d] > most[axis] - least[axis]) axis = d;
  std::stable_sort(facets.begin(), facets.end(),
                   [&](std::int32_t a, std::int32_t b) { return middle(a)[axis] < middle(b)[axis]; });
  const auto half = facets.begin() + static_cast<std::ptrdiff_t>(facets.size() / 2);
  divide({facets.begin(), half}, sign, where, found);
  divide({half, facets.end()}, sign, where, found);
}

bool SegmentSets::holds_no_other(const std::vector<std::int32_t>& facets) const {
  std::vector<std::int32_t> nodes, own = facets;
  std::sort(own.begin(), own.end());
  for (const std::int32_t facet : facets)
    for (const std::int32_t node : exterior_[static_cast<std::size_t>(facet)].key) nodes.push_back(node);
  std::sort(nodes.begin(), nodes.end());
  const auto is_in = [&](std::int32_t node) { return std::binary_search(nodes.begin(), nodes.end(), node); };
  for (const std::int32_t node : nodes)
    for (const std::int32_t facet : facets_of_node_[static_cast<std::size_t>(node)]) {
      const auto& key = exterior_[static_cast<std::size_t>(facet)].key;
      if (std::all_of(key.begin(), key.end(), is_in) && !std::binary_search(own.begin(), own.end(), facet))
        return false;
    }
  return true;
}

std::array<double, 3> SegmentSets::middle(std::int32_t facet) const {
  std::array<double, 3> sum{};
  for (const std::int32_t node : exterior_[static_cast<std::size_t>(facet)].nodes)
    for (std::size_t d = 0; d < 3; ++d) sum[d] += low_.mesh.mesh.points[static_cast<std::size_t>(node)][d];
  return sum;
}

}  // namespace kerf::lowering
