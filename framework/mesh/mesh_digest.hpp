// A fingerprint of what a mesh is, whatever form it was read from.
#pragma once

#include <cstdint>
#include <string>

#include "kerf/file_mesh.hpp"

namespace kerf {

/// Of points, cells, their numbers, blocks and sets, to the bit and in the order of the file; not of the format, of
/// places for messages, and of what the reader left out. Local.
std::uint64_t digest_of(const FileMesh& mesh);

/// The same as sixteen hexadecimal digits.
std::string digest_text(const FileMesh& mesh);

}  // namespace kerf
