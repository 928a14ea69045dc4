// Builds the mesh of a deck step by step: nodes, parts, solids, sets.
#pragma once

#include <cstdint>
#include <string>
#include <unordered_map>
#include <utility>
#include <vector>

#include "decks/bulk_card.hpp"
#include "decks/deck_mesh.hpp"
#include "decks/solid_shape.hpp"
#include "mesh/label_map.hpp"

namespace kerf::decks {

/// Ids from the first to the last, both included.
struct IdRange {
  std::int64_t first = 0, last = 0;
};

/// Fills a DeckMesh. For one use.
class MeshBuilder {
 public:
  MeshBuilder(const Deck& deck, DeckErrors& errors) : deck_(deck), errors_(errors) {}
  DeckMesh build();

 private:
  // deck_mesh.cpp
  void read_nodes(const Block& block);
  void keep_node_codes(const Block& block, BulkCard& fields, const Card& card, std::int32_t node);
  void check_nodes();
  void read_parts(const Block& block, std::int32_t number);
  void finish_blocks();
  // read_solids.cpp
  void read_solids(const Block& block);
  bool read_ids(BulkCard& nodes, std::size_t first, const Transform& transform, std::int64_t label,
                std::array<std::int64_t, 10>& ids, std::array<Place, 10>& places);
  void add_solid(const Block& block, std::int64_t label, std::int64_t part, const Place& place, const Place& part_place,
                 const std::array<std::int64_t, 10>& ids, const std::array<Place, 10>& places);
  std::int32_t part_index(std::int64_t id, std::int64_t label, const Place& place);
  void check_volume(std::size_t cell, const std::array<std::int64_t, 10>& ids);
  void check_solids();
  // read_sets.cpp
  void check_set_ids();
  void read_sets();
  void read_set(const Block& block);
  void read_node_set(const Block& block, std::int64_t id, const std::string& title);
  void read_added_sets(const Block& block, std::int64_t id, const std::string& title);
  void general_members(const Block& block, std::vector<std::int32_t>& nodes);
  void read_segments(const Block& block, std::int64_t id, const std::string& title);
  void read_id_set(const Block& block, std::int64_t id, const std::string& title);
  std::int32_t node_named(const Block& block, std::int64_t written, const Place& place);
  /// The ranges of a set that generates its members, as the whole deck calls their ids; ascending, none meets another.
  std::vector<IdRange> ranges_of(const Block& block, IdKind kind);
  /// Indices of the nodes, or labels of the cells or parts, in these ranges.
  void add_nodes(const std::vector<IdRange>& ranges, std::vector<std::int32_t>& nodes);
  void add_labels(const std::vector<IdRange>& ranges, bool of_parts, std::vector<std::int64_t>& labels);
  void add_nodes_of_part(std::int64_t part, std::vector<std::int32_t>& nodes) const;
  void keep_node_set(const Block& block, std::int64_t id, const std::string& title, std::vector<std::int32_t> nodes);

  const Deck& deck_;
  DeckErrors& errors_;
  DeckMesh out_;
  std::vector<Place> node_places_;  // per node
  std::unordered_map<std::int64_t, std::int32_t> part_of_id_;
  bool declares_parts_ = false;
  const LabelMap* node_index_ = nullptr;
  std::unordered_map<std::int64_t, std::size_t> node_set_of_id_, face_set_of_id_, part_set_of_id_, solid_set_of_id_;
  std::vector<std::pair<std::int64_t, std::int32_t>> nodes_by_label_;  // filled by the first set that has ranges
  std::vector<std::int64_t> cells_by_label_;  // likewise
};

}  // namespace kerf::decks
