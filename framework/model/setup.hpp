// Builds the model of time zero from the input: meshes, placement, sets, masses, quanta.
#pragma once

#include "input/placement.hpp"
#include "model/model.hpp"

namespace kerf {

/// Creates the parts (laws and empty stores) and their global numbering. Local.
void create_parts(Model& model, MPI_Comm comm, const ModelInput& input);

/// Generates this rank's contiguous share of the elements and assembles it. Collective.
void generate_mesh(Model& model);

/// The loads of the input that act on facets, in its order: component k of PartStore::loaded_faces is about number k.
std::vector<const FacetLoad*> facet_loads(const ModelInput& input);

}  // namespace kerf
