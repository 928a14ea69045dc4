// See exposure.hpp.
#include "model/exposure.hpp"

#include <cmath>

#include "kerf/collapsed_cell.hpp"
#include "model/constraints.hpp"
#include "model/node_group.hpp"

namespace kerf {

namespace {

/// Whether a condition leaves a node no choice of its velocity along `normal`: it makes the same of two opposite ones,
/// from the first step to the last.
bool rules(const Boundary& boundary, const BoundaryNode& node, Vec3 normal) {
  if (boundary.ask(node.position) != Boundary::Ask::always) return false;
  constexpr double late = 1e9;  // after any run; the end of this run may be moved when it is resumed [s]
  for (const double time : {0.0, late}) {
    const BoundaryStep step{time, 1e-30};
    const double one = dot(boundary.constrain(node, step, normal), normal);
    const double other = dot(boundary.constrain(node, step, normal * -1.0), normal);
    if (!(std::fabs(one - other) < 1e-6)) return false;
  }
  return true;
}

/// A collapsed cell has fewer faces. It counts as many of the shape's faces as leave it as free: with all of its own
/// faces but two or less exposed, none; with all of them, all. What lies between is rounded up, to the safe side.
void count_in_faces_of_shape(const PartStore& store, std::vector<std::uint8_t>& exposed) {
  const int all = store.shape().n_faces;
  for (int s = 0; s < store.n_slots(); ++s) {
    std::uint8_t& n = exposed[static_cast<std::size_t>(s)];
    if (n <= 2) continue;
    ElementNodeIds nodes{};
    for (int k = 0; k < store.n_nodes(); ++k) nodes[static_cast<std::size_t>(k)] = store.node(s, k);
    const int own = DistinctCell(store.shape(), nodes).shape->n_faces;
    n = static_cast<std::uint8_t>(2 + ((n - 2) * (all - 2) + own - 3) / (own - 2));
  }
}

}  // namespace

std::vector<std::vector<std::uint8_t>> count_exposed_faces(Model& model) {
  std::vector<std::vector<std::uint8_t>> exposed;
  for (const PartModel& part : model.parts)
    exposed.emplace_back(static_cast<std::size_t>(part.store->n_blocks()) * lane_width, std::uint8_t{0});
  std::vector<NodeGroup> groups;
  for (const auto& b : model.input->boundaries) groups.emplace_back(model, b->nodes());
  const auto held = [&](std::int32_t i, Vec3 normal) {
    for (std::size_t k = 0; k < groups.size(); ++k)
      if (groups[k].holds(model.nodes, i) &&
          rules(*model.input->boundaries[k], boundary_node(model.nodes, i, Vec3{}), normal))
        return true;
    return false;
  };
  for (const ExteriorFacet& f : model.surface.exterior(model.surface_mesh())) {
    const Vec3 across = cross(model.nodes.x(f.nodes[2]) - model.nodes.x(f.nodes[0]),
                              model.nodes.x(f.nodes[3]) - model.nodes.x(f.nodes[1]));
    const Vec3 normal = across * (1.0 / norm(across));
    bool free = false;
    for (const std::int32_t corner : f.nodes) free = free || !held(corner, normal);
    if (free) ++exposed[static_cast<std::size_t>(f.part)][static_cast<std::size_t>(f.slot)];
  }
  for (std::size_t p = 0; p < model.parts.size(); ++p) count_in_faces_of_shape(*model.parts[p].store, exposed[p]);
  return exposed;
}

}  // namespace kerf
