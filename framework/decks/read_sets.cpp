// Reads sets of nodes, parts, solids and segments.
#include <fmt/format.h>

#include <algorithm>
#include <map>

#include "decks/mesh_builder.hpp"

namespace kerf::decks {
namespace {

constexpr const char* range_fields[4][2] = {
    {"b1beg", "b1end"}, {"b2beg", "b2end"}, {"b3beg", "b3end"}, {"b4beg", "b4end"}};

template <class Value>
void sort_once(std::vector<Value>& values) {
  std::sort(values.begin(), values.end());
  values.erase(std::unique(values.begin(), values.end()), values.end());
}

/// The kinds of sets that the reader knows. Each has ids of its own.
const char* kind_of_set(const std::string& base) {
  for (const auto& [stem, kind] : {std::pair{"SET_NODE", "node"}, std::pair{"SET_PART", "part"},
                                   std::pair{"SET_SEGMENT", "segment"}, std::pair{"SET_SOLID", "solid"}})
    if (base.rfind(stem, 0) == 0) return kind;
  return nullptr;
}

}  // namespace

bool is_read_set(const std::string& base) {
  for (const char* name :
       {"SET_NODE_LIST", "SET_NODE_LIST_GENERATE", "SET_NODE_GENERAL", "SET_NODE_ADD", "SET_PART_LIST",
        "SET_PART_LIST_GENERATE", "SET_PART_ADD", "SET_SOLID", "SET_SOLID_GENERATE", "SET_SEGMENT"})
    if (base == name) return true;
  return false;
}

// Sets in forms that are not read count too: what names such an id must not get another set.
void MeshBuilder::check_set_ids() {
  std::map<std::pair<std::string_view, std::int64_t>, Place> first;
  for (const Block& block : deck_.blocks()) {
    const char* kind = kind_of_set(block.base());
    if (!kind) continue;
    const std::int64_t id = deck_.transform_of(block).id(deck_.first_integer(block), IdKind::set);
    if (id <= 0) continue;
    const auto [known, is_new] = first.emplace(std::pair{std::string_view(kind), id}, deck_.place_of(block));
    if (!is_new && !block.has_option("COLLECT"))
      errors_.error(deck_.place_of(block), "sets",
                    fmt::format("{} set {} is defined twice; first at {}; only sets with _COLLECT are put together",
                                kind, id, deck_.text_of(known->second)));
  }
}

void MeshBuilder::read_sets() {
  check_set_ids();
  for (const Block& block : deck_.blocks())
    if (is_read_set(block.base()) && block.base() != "SET_NODE_ADD") read_set(block);
  for (const Block& block : deck_.blocks())  // their members may stand below
    if (block.base() == "SET_NODE_ADD") read_set(block);
}

void MeshBuilder::read_set(const Block& block) {
  const Field<std::int64_t> written = deck_.integer(block, 1, "sid");
  if (written.value <= 0)
    return errors_.error(written.place, "sets",
                         fmt::format("a set has the id {}; expected one above zero", written.value));
  const std::int64_t id = deck_.transform_of(block).id(written.value, IdKind::set);
  const std::string title = deck_.heading(block);
  if (block.base() == "SET_NODE_ADD") {
    read_added_sets(block, id, title);
  } else if (block.base().rfind("SET_NODE", 0) == 0) {
    read_node_set(block, id, title);
  } else if (block.base() == "SET_SEGMENT") {
    read_segments(block, id, title);
  } else {
    read_id_set(block, id, title);
  }
}

std::int32_t MeshBuilder::node_named(const Block& block, std::int64_t written, const Place& place) {
  const std::int64_t id = deck_.transform_of(block).id(written, IdKind::node);
  const std::int32_t node = node_index_->find(id);
  if (node < 0)
    errors_.error(place, "nodes of sets", fmt::format("*{} names node {}, which is not defined", block.written, id));
  return node;
}

void MeshBuilder::read_node_set(const Block& block, std::int64_t id, const std::string& title) {
  std::vector<std::int32_t> nodes;
  if (block.base() == "SET_NODE_GENERAL") {
    general_members(block, nodes);
    return keep_node_set(block, id, title, std::move(nodes));
  }
  if (block.base() == "SET_NODE_LIST_GENERATE") {
    add_nodes(ranges_of(block, IdKind::node), nodes);
    return keep_node_set(block, id, title, std::move(nodes));
  }
  for (std::size_t r = 0; r < deck_.n_repeats(block); ++r) {
    for (int k = 0; k < 8; ++k) {
      const Field<std::int64_t> node = deck_.integer(block, 2, fmt::format("nid{}", k + 1), r);
      if (node.value == 0) continue;
      if (const std::int32_t index = node_named(block, node.value, node.place); index >= 0) nodes.push_back(index);
    }
  }
  keep_node_set(block, id, title, std::move(nodes));
}

std::vector<IdRange> MeshBuilder::ranges_of(const Block& block, IdKind kind) {
  const Transform& transform = deck_.transform_of(block);
  std::vector<IdRange> all, apart;
  for (std::size_t r = 0; r < deck_.n_repeats(block); ++r)
    for (const auto& [begin, end] : range_fields) {
      const Field<std::int64_t> first = deck_.integer(block, 2, begin, r), last = deck_.integer(block, 2, end, r);
      if (first.value == 0 && last.value == 0) continue;
      if (last.value < first.value)
        errors_.error(last.place, "ranges of sets",
                      fmt::format("*{}: a range goes from {} to {}; expected an end that is not below the beginning",
                                  block.written, first.value, last.value));
      else
        all.push_back({transform.id(first.value, kind), transform.id(last.value, kind)});
    }
  std::sort(all.begin(), all.end(), [](const IdRange& a, const IdRange& b) { return a.first < b.first; });
  for (const IdRange& range : all)
    if (apart.empty() || range.first > apart.back().last)
      apart.push_back(range);
    else
      apart.back().last = std::max(apart.back().last, range.last);
  return apart;
}

// Numbers of a range that are no nodes are skipped.
void MeshBuilder::add_nodes(const std::vector<IdRange>& ranges, std::vector<std::int32_t>& nodes) {
  if (nodes_by_label_.empty()) {
    for (std::size_t n = 0; n < out_.mesh.node_labels.size(); ++n)
      nodes_by_label_.emplace_back(out_.mesh.node_labels[n], static_cast<std::int32_t>(n));
    std::sort(nodes_by_label_.begin(), nodes_by_label_.end());
  }
  for (const IdRange& range : ranges) {
    auto node = std::lower_bound(nodes_by_label_.begin(), nodes_by_label_.end(), std::pair{range.first, 0});
    for (; node != nodes_by_label_.end() && node->first <= range.last; ++node) nodes.push_back(node->second);
  }
}

void MeshBuilder::add_labels(const std::vector<IdRange>& ranges, bool of_parts, std::vector<std::int64_t>& labels) {
  std::vector<std::int64_t> parts;
  if (of_parts) {
    for (const DeckPart& part : out_.parts) parts.push_back(part.id);
    std::sort(parts.begin(), parts.end());
  } else if (cells_by_label_.empty()) {
    cells_by_label_ = out_.mesh.cell_labels;
    std::sort(cells_by_label_.begin(), cells_by_label_.end());
  }
  const std::vector<std::int64_t>& known = of_parts ? parts : cells_by_label_;
  for (const IdRange& range : ranges)
    labels.insert(labels.end(), std::lower_bound(known.begin(), known.end(), range.first),
                  std::upper_bound(known.begin(), known.end(), range.last));
}

void MeshBuilder::add_nodes_of_part(std::int64_t part, std::vector<std::int32_t>& nodes) const {
  const auto known = part_of_id_.find(part);
  if (known == part_of_id_.end()) return;
  for (std::size_t c = 0; c < out_.cell_part.size(); ++c)
    if (out_.cell_part[c] == known->second)
      nodes.insert(nodes.end(), out_.mesh.cells[c].begin(), out_.mesh.cells[c].end());
  for (const TenNodes& ten : out_.ten_nodes)
    if (out_.cell_part[static_cast<std::size_t>(ten.cell)] == known->second)
      nodes.insert(nodes.end(), ten.nodes.begin(), ten.nodes.end());
}

// Lines of *SET_NODE_GENERAL: an option and up to seven ids; options that begin with D take members out again.
void MeshBuilder::general_members(const Block& block, std::vector<std::int32_t>& nodes) {
  const Transform& transform = deck_.transform_of(block);
  for (std::size_t r = 0; r < deck_.n_repeats(block); ++r) {
    const Field<std::string> option = deck_.text(block, 2, "option", r);
    const std::string name = upper_case(option.value);
    std::vector<std::int32_t> named;
    if (name == "ALL") {
      for (std::size_t n = 0; n < out_.mesh.points.size(); ++n) named.push_back(static_cast<std::int32_t>(n));
    } else if (name != "NODE" && name != "PART" && name != "DNODE" && name != "DPART") {
      errors_.error(option.place, "options of sets",
                    fmt::format("option {} of *{} is not read; expected ALL, NODE, PART, DNODE or DPART",
                                name.substr(0, 40), block.written));
      continue;
    }
    for (int k = 1; k < 8 && name != "ALL"; ++k) {
      const Field<std::int64_t> id = deck_.integer(block, 2, fmt::format("e{}", k), r);
      if (id.value == 0) continue;
      if (name == "PART" || name == "DPART") {
        const std::int64_t part = transform.id(id.value, IdKind::part);
        if (part_of_id_.count(part) == 0)
          errors_.error(id.place, "parts of sets",
                        fmt::format("*{} names part {}, which is not defined", block.written, part));
        add_nodes_of_part(part, named);
      } else if (const std::int32_t node = node_named(block, id.value, id.place); node >= 0) {
        named.push_back(node);
      }
    }
    sort_once(named);
    if (name[0] != 'D') {
      nodes.insert(nodes.end(), named.begin(), named.end());
      continue;
    }
    nodes.erase(std::remove_if(nodes.begin(), nodes.end(),
                               [&](std::int32_t n) { return std::binary_search(named.begin(), named.end(), n); }),
                nodes.end());
  }
}

void MeshBuilder::read_added_sets(const Block& block, std::int64_t id, const std::string& title) {
  std::vector<std::int32_t> nodes;
  const Transform& transform = deck_.transform_of(block);
  for (std::size_t r = 0; r < deck_.n_repeats(block); ++r)
    for (int k = 1; k <= 8; ++k) {
      const Field<std::int64_t> field = deck_.integer(block, 2, fmt::format("nsid{}", k), r);
      const std::int64_t other = transform.id(field.value, IdKind::set);
      if (other == 0) continue;
      const auto known = node_set_of_id_.find(other);
      if (known == node_set_of_id_.end()) {
        errors_.error(field.place, "sets", fmt::format("node set {} is not defined", other));
        continue;
      }
      const std::vector<std::int32_t>& members = out_.mesh.node_sets[known->second].nodes;
      nodes.insert(nodes.end(), members.begin(), members.end());
    }
  keep_node_set(block, id, title, std::move(nodes));
}

void MeshBuilder::keep_node_set(const Block& block, std::int64_t id, const std::string& title,
                                std::vector<std::int32_t> nodes) {
  std::vector<MeshNodeSet>& sets = out_.mesh.node_sets;
  const auto [known, is_new] = node_set_of_id_.emplace(id, sets.size());
  if (is_new) {
    sort_once(nodes);
    sets.push_back({title.empty() ? std::to_string(id) : title, id, std::move(nodes)});
    return;
  }
  if (!block.has_option("COLLECT")) return;  // check_set_ids has complained
  MeshNodeSet& set = sets[known->second];
  set.nodes.insert(set.nodes.end(), nodes.begin(), nodes.end());
  sort_once(set.nodes);
}

// Four nodes each; a triangle has the third one again, or none, in the fourth place.
void MeshBuilder::read_segments(const Block& block, std::int64_t id, const std::string& title) {
  MeshFaceSet set{title.empty() ? std::to_string(id) : title, id, {}};
  for (std::size_t r = 0; r < deck_.n_repeats(block); ++r) {
    std::array<std::int32_t, 4> face = {};
    bool ok = true;
    for (std::size_t k = 0; k < 4; ++k) {
      const Field<std::int64_t> node = deck_.integer(block, 2, fmt::format("n{}", k + 1), r);
      if (k == 3 && node.value == 0) {
        face[3] = face[2];
        continue;
      }
      face[k] = node.value > 0 ? node_named(block, node.value, node.place) : -1;
      if (node.value <= 0)
        errors_.error(node.place, "segments", fmt::format("a segment of *{} has no node N{}", block.written, k + 1));
      ok = ok && face[k] >= 0;
    }
    // In a mirror, the outside of a face is seen from the other side.
    if (deck_.transform_of(block).motion.determinant() < 0.0)
      face = face[3] == face[2] ? std::array{face[0], face[2], face[1], face[1]}
                                : std::array{face[0], face[3], face[2], face[1]};
    if (ok) set.faces.push_back(face);
  }
  const auto [known, is_new] = face_set_of_id_.emplace(id, out_.mesh.face_sets.size());
  if (is_new) return out_.mesh.face_sets.push_back(std::move(set));
  if (!block.has_option("COLLECT")) return;  // check_set_ids has complained
  std::vector<std::array<std::int32_t, 4>>& faces = out_.mesh.face_sets[known->second].faces;
  faces.insert(faces.end(), set.faces.begin(), set.faces.end());
}

void MeshBuilder::read_id_set(const Block& block, std::int64_t id, const std::string& title) {
  const Transform& transform = deck_.transform_of(block);
  const bool parts = block.base().rfind("SET_PART", 0) == 0, adds = block.base() == "SET_PART_ADD";
  std::vector<DeckIdSet>& sets = parts ? out_.part_sets : out_.solid_sets;
  DeckIdSet set{id, title, {}, deck_.place_of(block)};
  std::unordered_map<std::int64_t, std::size_t>& set_of_id = parts ? part_set_of_id_ : solid_set_of_id_;
  const IdKind kind = parts ? IdKind::part : IdKind::element;
  const bool generates = block.base().find("GENERATE") != std::string::npos;
  if (generates) add_labels(ranges_of(block, kind), parts, set.ids);
  for (std::size_t r = 0; r < deck_.n_repeats(block) && !generates; ++r) {
    const char* stem = adds ? "psid" : parts ? "pid" : "k";
    for (int k = 1; k <= 8; ++k) {
      const Field<std::int64_t> member = deck_.integer(block, 2, fmt::format("{}{}", stem, k), r);
      if (member.value == 0) continue;
      const std::int64_t label = transform.id(member.value, adds ? IdKind::set : kind);
      if (adds) {
        const auto other = set_of_id.find(label);
        if (other == set_of_id.end()) {
          errors_.error(member.place, "sets", fmt::format("part set {} is not defined above", label));
          continue;
        }
        const std::vector<std::int64_t>& members = sets[other->second].ids;
        set.ids.insert(set.ids.end(), members.begin(), members.end());
      } else if (parts && declares_parts_ && part_of_id_.count(label) == 0) {
        errors_.error(member.place, "parts of sets",
                      fmt::format("*{} names part {}, which is not defined", block.written, label));
      } else {
        set.ids.push_back(label);
      }
    }
  }
  sort_once(set.ids);
  const auto [known, is_new] = set_of_id.emplace(id, sets.size());
  if (is_new) return sets.push_back(std::move(set));
  if (!block.has_option("COLLECT")) return;  // check_set_ids has complained
  DeckIdSet& first = sets[known->second];
  first.ids.insert(first.ids.end(), set.ids.begin(), set.ids.end());
  sort_once(first.ids);
}

}  // namespace kerf::decks
