// `kerf convert`: a keyword deck, or the mesh of another program, as an input of Kerf's own with its mesh.
#include <fmt/format.h>

#include <cstdio>
#include <filesystem>
#include <fstream>

#include "app/commands.hpp"
#include "core/diagnostics.hpp"
#include "lowering/lower_deck.hpp"
#include "mesh/mesh_file.hpp"

namespace kerf {

int convert_command(const RunOptions& options, Registry& registry) {
  (void)options;
  (void)registry;
  return exit_other;
}

}  // namespace kerf
