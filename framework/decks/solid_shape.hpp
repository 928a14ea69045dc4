// Which shape the nodes of a solid make.
#pragma once

#include <array>
#include <cstdint>

#include "decks/deck_mesh.hpp"

namespace kerf::decks {

/// A shape, and the nodes in the order of kerf/file_mesh.hpp. `ok` is false where the nodes make no shape of Kerf.
struct RecognisedSolid {
  bool ok = false;
  SolidShape shape = SolidShape::hex8;
  std::array<std::int32_t, 8> nodes = {};
};

/// Finds wedges, pyramids and tetrahedra in bricks whose corners coincide, however the brick is turned.
RecognisedSolid recognised(const std::array<std::int32_t, 8>& nodes);

/// How many of the nodes differ.
int n_distinct(const std::array<std::int32_t, 8>& nodes);

/// The same solid seen in a mirror: its volume changes its sign.
std::array<std::int32_t, 8> mirrored(const RecognisedSolid& solid);

}  // namespace kerf::decks
