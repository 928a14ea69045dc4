// Names the blocks and sets of a mesh in a document.
#include "lowering/lower_mesh.hpp"

#include <fmt/format.h>

#include <optional>
#include <set>

#include "core/units.hpp"
#include "lowering/lowering.hpp"

namespace kerf::lowering {
namespace {

/// A word that no other part or set has.
std::string free_word(const std::string& text, const char* otherwise, std::set<std::string>& taken) {
  std::string word = word_of(text);
  if (word.empty() || (word[0] >= '0' && word[0] <= '9')) word = fmt::format("{}_{}", otherwise, word);
  return free_name(word, taken);
}

}  // namespace

std::string length_of(const std::string& units, Diagnostics& diagnostics) {
  if (units.empty()) {
    diagnostics.error("--units", "the file does not say its unit of length; expected one, for example --units mm");
    return {};
  }
  if (units.find_first_of(",-") == std::string::npos && to_si("1 " + units, "m").ok()) return units;
  std::optional<UnitSystem> system;
  const std::string fault = parse_unit_system(units, system);
  if (!fault.empty()) diagnostics.error("--units " + units, fault + ", or a length such as mm");
  return system ? system->length_name() : std::string();
}

Node document_of_mesh(const FileMesh& mesh, const std::string& mesh_name, const std::string& unit) {
  const Origin nowhere;
  Node root = map_node(nowhere), parts = map_node(nowhere), sets = map_node(nowhere);
  std::set<std::string> taken, faces;
  for (const MeshBlock& block : mesh.blocks) {
    const std::string name = free_word(block.name, "part", taken);
    Node part = map_node(nowhere), of_file = map_node(nowhere);
    add(of_file, "type", scalar("file", nowhere));
    add(of_file, "file", scalar(mesh_name, nowhere));
    add(of_file, "unit", scalar(unit, nowhere));
    add(of_file, "block", scalar(mesh.call(block), nowhere));
    add(part, "material", scalar(name, nowhere));
    add(part, "mesh", std::move(of_file));
    add(parts, name, std::move(part));
  }
  const auto add_set = [&](const std::string& face) {
    if (!faces.insert(face).second) return;
    Node set = map_node(nowhere);
    add(set, "face", scalar(face, nowhere));
    add(sets, free_word(face, "set", taken), std::move(set));
  };
  const MeshSets named(mesh);
  for (const MeshNodeSet& set : mesh.node_sets) add_set(named.call(node_set_word, set.name));
  for (const MeshFaceSet& set : mesh.face_sets) add_set(named.call(face_set_word, set.name));
  add(root, "parts", std::move(parts));
  if (!sets.entries.empty()) add(root, "sets", std::move(sets));
  return root;
}

}  // namespace kerf::lowering
