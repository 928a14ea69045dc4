// Measures of cells and of whole meshes.
#include "mesh/quality.hpp"

#include <limits>

#include "kerf/collapsed_cell.hpp"

namespace kerf {

namespace {

double length_of(const Shape& shape, const CellCorners& x, int edge) {
  const auto& ends = shape.edge[edge];
  return norm(x[static_cast<std::size_t>(ends[0])] - x[static_cast<std::size_t>(ends[1])]);
}

}  // namespace

double min_scaled_jacobian(const Shape& shape, const CellCorners& x) {
  double least = std::numeric_limits<double>::infinity();
  for (int i = 0; i < shape.n_nodes; ++i) {
    if (shape.neighbour[i][0] < 0) continue;
    const auto to = [&](int k) {
      return x[static_cast<std::size_t>(shape.neighbour[i][k])] - x[static_cast<std::size_t>(i)];
    };
    const Vec3 a = to(0), b = to(1), c = to(2);
    const double lengths = norm(a) * norm(b) * norm(c);
    least = min_of(least, lengths > 0.0 ? dot(a, cross(b, c)) / lengths : 0.0);
  }
  return least;
}

double shortest_edge(const Shape& shape, const CellCorners& x) {
  double least = std::numeric_limits<double>::infinity();
  for (int e = 0; e < shape.n_edges; ++e) least = min_of(least, length_of(shape, x, e));
  return least;
}

double longest_edge(const Shape& shape, const CellCorners& x) {
  double most = 0.0;
  for (int e = 0; e < shape.n_edges; ++e) most = max_of(most, length_of(shape, x, e));
  return most;
}

PlacedCell placed_cell(const MeshGenerator& mesh, std::int64_t element) {
  const ElementNodeIds nodes = mesh.element(element);
  CellCorners x;
  for (std::size_t k = 0; k < static_cast<std::size_t>(mesh.shape().n_nodes); ++k) x[k] = mesh.node(nodes[k]);
  const DistinctCell cell(mesh.shape(), nodes);
  return {cell.shape, cell.of(x)};
}

MeshReport assess(const MeshGenerator& mesh) {
  MeshReport report;
  report.n_elements = mesh.n_elements();
  report.n_nodes = mesh.n_nodes();
  if (report.n_elements > 0)
    report.smallest_edge = report.min_scaled_jacobian = std::numeric_limits<double>::infinity();
  for (std::int64_t e = 0; e < report.n_elements; ++e) {
    const auto [cell, x] = placed_cell(mesh, e);
    const Shape& shape = *cell;
    const double volume = volume_by_faces(shape, x), jacobian = min_scaled_jacobian(shape, x);
    report.total_volume += volume;
    report.largest_edge = max_of(report.largest_edge, longest_edge(shape, x));
    report.smallest_edge = min_of(report.smallest_edge, shortest_edge(shape, x));
    report.min_scaled_jacobian = min_of(report.min_scaled_jacobian, jacobian);
    if (!(volume > 0.0) || !(jacobian > 0.0)) ++report.n_unusable;
  }
  return report;
}

}  // namespace kerf
