// Goes through the nodes of all parts that are taken from one mesh. Every rank knows these meshes whole.
#include "model/common_nodes.hpp"

#include <algorithm>

#include "model/model.hpp"

namespace kerf {

namespace {

/// The parts of each whole mesh that has several.
std::vector<std::vector<std::int32_t>> parts_of_whole_meshes(const Model& model) {
  std::vector<const void*> meshes;
  std::vector<std::vector<std::int32_t>> parts;
  for (std::size_t p = 0; p < model.parts.size(); ++p) {
    const void* whole = model.parts[p].input->mesh->whole_mesh();
    if (!whole) continue;
    const auto at = static_cast<std::size_t>(std::find(meshes.begin(), meshes.end(), whole) - meshes.begin());
    if (at == meshes.size()) {
      meshes.push_back(whole);
      parts.emplace_back();
    }
    parts[at].push_back(static_cast<std::int32_t>(p));
  }
  std::erase_if(parts, [](const auto& list) { return list.size() < 2; });
  return parts;
}

/// Calls visit(part, id, number in the whole mesh) for all nodes of some parts, part by part.
template <class Visit>
void each_node(const Model& model, const std::vector<std::int32_t>& parts, const Visit& visit) {
  for (const std::int32_t p : parts) {
    const PartModel& part = model.parts[static_cast<std::size_t>(p)];
    for (std::int64_t i = 0; i < part.n_nodes; ++i)
      visit(p, part.first_node + i, static_cast<std::size_t>(part.input->mesh->node_of_whole(i)));
  }
}

}  // namespace

std::vector<CommonNodes> common_nodes(const Model& model) {
  std::vector<CommonNodes> all;
  for (const auto& parts : parts_of_whole_meshes(model)) {
    CommonNodes& common = all.emplace_back();
    common.parts = parts;
    each_node(model, parts, [&](std::int32_t, std::int64_t id, std::size_t node) {
      if (node >= common.first.size()) {
        common.first.resize(node + 1, -1);
        common.is_shared.resize(node + 1, 0);
      }
      if (common.first[node] < 0)
        common.first[node] = id;
      else
        common.is_shared[node] = 1;
    });
  }
  return all;
}

std::vector<std::pair<std::int32_t, std::int32_t>> parts_with_common_nodes(const Model& model) {
  std::vector<std::pair<std::int32_t, std::int32_t>> pairs;
  for (const auto& parts : parts_of_whole_meshes(model)) {
    std::vector<std::int32_t> first;  // per node of the whole mesh: the first part that has it, or -1
    each_node(model, parts, [&](std::int32_t part, std::int64_t, std::size_t node) {
      if (node >= first.size()) first.resize(node + 1, -1);
      if (first[node] < 0)
        first[node] = part;
      else if (pairs.empty() || pairs.back() != std::pair(first[node], part))
        pairs.emplace_back(first[node], part);
    });
  }
  std::sort(pairs.begin(), pairs.end());
  pairs.erase(std::unique(pairs.begin(), pairs.end()), pairs.end());
  return pairs;
}

}  // namespace kerf
