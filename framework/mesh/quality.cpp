// Measures of hexahedra and of whole meshes.
#include "mesh/quality.hpp"

#include <limits>

#include "kerf/shape.hpp"

namespace kerf {

namespace {

// The three neighbours of each corner, ordered so that the triple product is positive for a brick.
constexpr std::array<std::array<int, 3>, 8> neighbours{
    {{1, 3, 4}, {2, 0, 5}, {3, 1, 6}, {0, 2, 7}, {7, 5, 0}, {4, 6, 1}, {5, 7, 2}, {6, 4, 3}}};

double triple(Vec3 a, Vec3 b, Vec3 c) { return dot(a, cross(b, c)); }

}  // namespace

// Grandy, "Efficient computation of volume of hexahedral cells", UCRL-ID-128886 (1997), the tetrakis form.
double hex_volume(const HexCorners& x) {
  const auto d = [&x](int i, int j) { return x[static_cast<std::size_t>(i)] - x[static_cast<std::size_t>(j)]; };
  return (triple(d(3, 1) + d(7, 2), d(6, 3), d(2, 0)) + triple(d(4, 3) + d(5, 7), d(6, 4), d(7, 0)) +
          triple(d(1, 4) + d(2, 5), d(6, 1), d(5, 0))) /
         12.0;
}

double min_scaled_jacobian(const HexCorners& x) {
  double least = std::numeric_limits<double>::infinity();
  for (std::size_t i = 0; i < 8; ++i) {
    const auto& n = neighbours[i];
    const Vec3 a = x[static_cast<std::size_t>(n[0])] - x[i], b = x[static_cast<std::size_t>(n[1])] - x[i],
               c = x[static_cast<std::size_t>(n[2])] - x[i];
    const double lengths = norm(a) * norm(b) * norm(c);
    least = min_of(least, lengths > 0.0 ? triple(a, b, c) / lengths : 0.0);
  }
  return least;
}

double shortest_edge(const HexCorners& x) {
  double least = std::numeric_limits<double>::infinity();
  for (const auto& e : hexahedron.edge)
    least = min_of(least, norm(x[static_cast<std::size_t>(e[0])] - x[static_cast<std::size_t>(e[1])]));
  return least;
}

double longest_edge(const HexCorners& x) {
  double most = 0.0;
  for (const auto& e : hexahedron.edge)
    most = max_of(most, norm(x[static_cast<std::size_t>(e[0])] - x[static_cast<std::size_t>(e[1])]));
  return most;
}

HexCorners corners_of(const MeshGenerator& mesh, std::int64_t element) {
  const auto nodes = mesh.element(element);
  HexCorners x;
  for (std::size_t i = 0; i < 8; ++i) x[i] = mesh.node(nodes[i]);
  return x;
}

MeshReport assess(const MeshGenerator& mesh) {
  MeshReport report;
  report.n_elements = mesh.n_elements();
  report.n_nodes = mesh.n_nodes();
  for (std::int64_t e = 0; e < report.n_elements; ++e) {
    const HexCorners x = corners_of(mesh, e);
    const double volume = hex_volume(x), jacobian = min_scaled_jacobian(x), edge = shortest_edge(x);
    report.total_volume += volume;
    report.largest_edge = max_of(report.largest_edge, longest_edge(x));
    if (!(volume > 0.0) || !(jacobian > 0.0)) ++report.n_unusable;
    if (e == 0 || edge < report.smallest_edge) {
      report.smallest_edge = edge;
      report.smallest_edge_element = e;
    }
    if (e == 0 || jacobian < report.min_scaled_jacobian) {
      report.min_scaled_jacobian = jacobian;
      report.worst_jacobian_element = e;
    }
    if (e == 0 || volume < report.min_volume) {
      report.min_volume = volume;
      report.smallest_volume_element = e;
    }
  }
  return report;
}

}  // namespace kerf
