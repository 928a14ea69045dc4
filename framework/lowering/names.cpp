// What the document calls the parts and sets of a deck.
#include <fmt/format.h>

#include <algorithm>

#include "lowering/lowering.hpp"

namespace kerf::lowering {
namespace {

bool is_number(const std::string& word) {
  return std::all_of(word.begin(), word.end(), [](char c) { return c >= '0' && c <= '9'; });
}

}  // namespace

std::string word_of(const std::string& title) {
  std::string word;
  for (const char c : title) {
    const bool plain = (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || (c >= '0' && c <= '9');
    if (plain) {
      word += c;
    } else if (!word.empty() && word.back() != '_') {
      word += '_';
    }
  }
  while (!word.empty() && word.back() == '_') word.pop_back();
  return word;
}

void Lowering::name_parts() {
  std::map<std::string, int> uses;
  for (const decks::DeckPart& part : mesh.parts) ++uses[word_of(part.title)];
  for (const decks::DeckPart& part : mesh.parts) {
    const std::string word = word_of(part.title);
    const bool alone = !word.empty() && !is_number(word) && uses[word] == 1;
    if (has_cells(part.id))
      part_names[part.id] = free_name(
          alone ? word : fmt::format("{}_{}", word.empty() || is_number(word) ? "part" : word, part.id), names_);
  }
}

std::string free_name(const std::string& name, std::set<std::string>& taken) {
  std::string free = name;
  for (int k = 2; is_number(free) || !taken.insert(free).second; ++k) free = fmt::format("{}_{}", name, k);
  return free;
}

std::string Lowering::part_name(std::int64_t id) const {
  const auto found = part_names.find(id);
  return found == part_names.end() ? std::string() : found->second;
}

std::vector<std::string> Lowering::parts_of_set(std::int64_t set, const Origin& where) {
  const auto found = std::find_if(mesh.part_sets.begin(), mesh.part_sets.end(),
                                  [&](const decks::DeckIdSet& s) { return s.id == set; });
  if (found == mesh.part_sets.end()) {
    error(where, fmt::format("part set {} is not defined", set));
    return {};
  }
  std::vector<std::string> names;
  std::string without;
  for (const std::int64_t id : found->ids) {
    const std::string name = part_name(id);
    if (name.empty())
      without += fmt::format("{}{}", without.empty() ? "" : ", ", id);
    else
      names.push_back(name);
  }
  if (names.empty())
    refuse(where, fmt::format("part set {} has no part with solids that can be run; expected one", set));
  else if (!without.empty())
    warning(where, fmt::format("part set {} also names {}, without solids that can be run", set, without));
  return names;
}

bool Lowering::has_cells(std::int64_t part) const {
  return std::any_of(mesh.mesh.blocks.begin(), mesh.mesh.blocks.end(),
                     [&](const MeshBlock& block) { return block.label == part && !block.cells.empty(); });
}

const std::vector<std::int32_t>& Lowering::nodes_of_part(std::int64_t id) {
  const auto [known, is_new] = nodes_of_parts_.try_emplace(id);
  std::vector<std::int32_t>& nodes = known->second;
  if (!is_new) return nodes;
  for (const MeshBlock& block : mesh.mesh.blocks) {
    if (block.label != id) continue;
    for (const std::int32_t cell : block.cells)
      for (const std::int32_t node : mesh.mesh.cells[static_cast<std::size_t>(cell)]) nodes.push_back(node);
  }
  std::sort(nodes.begin(), nodes.end());
  nodes.erase(std::unique(nodes.begin(), nodes.end()), nodes.end());
  return nodes;
}

const std::vector<std::int32_t>* Lowering::nodes_of_set(std::int64_t id) const {
  for (const MeshNodeSet& set : mesh.mesh.node_sets)
    if (set.label == id) return &set.nodes;
  return nullptr;
}

std::string Lowering::node_set(std::int64_t id, const Origin& where) {
  if (const auto known = node_set_names_.find(id); known != node_set_names_.end()) return known->second;
  const std::vector<std::int32_t>* members = nodes_of_set(id);
  if (!members) {
    error(where, fmt::format("node set {} is not defined", id));
    return {};
  }
  return node_set_names_[id] = nodes(fmt::format("node_set_{}", id), *members, where);
}

std::string Lowering::nodes(const std::string& name, std::vector<std::int32_t> members, const Origin& where) {
  const std::string free = free_name(name, names_);
  std::sort(members.begin(), members.end());
  members.erase(std::unique(members.begin(), members.end()), members.end());
  sets.push_back({free, 0, std::move(members)});
  Entry* all = root.find("sets");
  Node& map = all ? all->value : add(root, "sets", map_node(where));
  Node set = map_node(where);
  add(set, "face", scalar(free, where));
  add(map, free, std::move(set));
  return free;
}

}  // namespace kerf::lowering
