// A lowered deck as bytes: rank 0 reads the deck, and all other ranks get what it has made of it.
#pragma once

#include <string>

#include "lowering/lower_deck.hpp"

namespace kerf::lowering {

/// The document and the mesh, without the report.
std::string packed(const LoweredDeck& deck);
/// Pre: `bytes` were packed by the same program.
LoweredDeck unpacked(const std::string& bytes);

}  // namespace kerf::lowering
