// Asks the mesh of the part and its placement.
#include "model/reference_position.hpp"

#include "core/assert.hpp"

namespace kerf {

Vec3 reference_position(const Model& model, std::int64_t node) {
  for (const PartModel& part : model.parts)
    if (node >= part.first_node && node < part.first_node + part.n_nodes)
      return part.placement->apply(part.input->mesh->node(node - part.first_node));
  KERF_ASSERT(false, "every node belongs to a part");
  return {};
}

}  // namespace kerf
