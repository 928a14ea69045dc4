// What an input calls the blocks and sets of a mesh. A name that means several things is not understood.
#include <algorithm>
#include <charconv>
#include <functional>
#include <map>
#include <optional>

#include "kerf/file_mesh.hpp"

namespace kerf {
namespace {

constexpr std::string_view block_word = "block:";

std::optional<std::int64_t> number_called(std::string_view called) {
  if (!called.starts_with(block_word)) return {};
  called.remove_prefix(block_word.size());
  std::int64_t number = 0;
  const auto [end, error] = std::from_chars(called.data(), called.data() + called.size(), number);
  if (error != std::errc() || end != called.data() + called.size()) return {};
  return number;
}

std::string qualified(const char* kind, const std::string& name) { return std::string(kind) + ":" + name; }

bool ascends(const std::vector<std::int32_t>& nodes) {
  return std::adjacent_find(nodes.begin(), nodes.end(), std::greater_equal<>()) == nodes.end();
}

std::vector<std::int32_t> ascending(std::vector<std::int32_t> nodes) {
  std::sort(nodes.begin(), nodes.end());
  nodes.erase(std::unique(nodes.begin(), nodes.end()), nodes.end());
  nodes.shrink_to_fit();
  return nodes;
}

using Nodes = std::span<const std::int32_t>;

bool same(Nodes a, Nodes b) { return std::equal(a.begin(), a.end(), b.begin(), b.end()); }

}  // namespace

const MeshBlock* FileMesh::block(std::string_view called) const {
  const std::optional<std::int64_t> number = number_called(called);
  const MeshBlock* found = nullptr;
  for (const MeshBlock& b : blocks) {
    if (b.name != called && b.label != number) continue;
    if (found) return nullptr;
    found = &b;
  }
  return found;
}

std::string FileMesh::call(const MeshBlock& block) const {
  const auto has_name = [&](const MeshBlock& b) { return b.name == block.name; };
  const bool alone = std::count_if(blocks.begin(), blocks.end(), has_name) == 1;
  return alone ? block.name : std::string(block_word) + std::to_string(block.label);
}

MeshSets::MeshSets(const FileMesh& mesh) {
  std::map<std::string, std::vector<const MeshNodeSet*>> node_sets;
  std::map<std::string, std::vector<const MeshFaceSet*>> face_sets;
  for (const MeshNodeSet& set : mesh.node_sets) node_sets[set.name].push_back(&set);
  for (const MeshFaceSet& set : mesh.face_sets) face_sets[set.name].push_back(&set);
  made_.reserve(node_sets.size() + face_sets.size());  // what is in it does not move
  std::map<std::string, Nodes> plain, all;
  for (const auto& [name, sets] : node_sets) {
    Nodes nodes = sets.front()->nodes;
    if (sets.size() > 1 || !ascends(sets.front()->nodes)) {
      std::vector<std::int32_t> several;
      for (const MeshNodeSet* set : sets) several.insert(several.end(), set->nodes.begin(), set->nodes.end());
      nodes = made_.emplace_back(ascending(std::move(several)));
    }
    all[qualified(node_set_word, name)] = plain[name] = nodes;
  }
  for (const auto& [name, sets] : face_sets) {
    std::vector<std::int32_t> corners;
    for (const MeshFaceSet* set : sets)
      for (const auto& face : set->faces) corners.insert(corners.end(), face.begin(), face.end());
    corners = ascending(std::move(corners));
    const auto of_nodes = plain.find(name);
    const bool alike = of_nodes != plain.end() && same(of_nodes->second, corners);
    const Nodes nodes = alike ? of_nodes->second : Nodes(made_.emplace_back(std::move(corners)));
    all[qualified(face_set_word, name)] = nodes;
    if (of_nodes == plain.end())
      plain[name] = nodes;
    else if (!alike)
      plain.erase(of_nodes);
  }
  all.insert(plain.begin(), plain.end());  // a qualified name goes before the plain name of another set
  for (auto& [name, nodes] : all) called_.push_back({name, nodes});
}

std::vector<std::string> MeshSets::names() const {
  std::vector<std::string> names;
  for (const Called& set : called_) names.push_back(set.name);
  return names;
}

int MeshSets::find(std::string_view called) const {
  const auto less = [](const Called& set, std::string_view name) { return set.name < name; };
  const auto found = std::lower_bound(called_.begin(), called_.end(), called, less);
  return found == called_.end() || found->name != called ? -1 : static_cast<int>(found - called_.begin());
}

std::string MeshSets::call(const char* kind, const std::string& name) const {
  const std::string whole = qualified(kind, name);
  const int alone = find(name), set = find(whole);
  return alone >= 0 && same(nodes(alone), nodes(set)) ? name : whole;
}

}  // namespace kerf
