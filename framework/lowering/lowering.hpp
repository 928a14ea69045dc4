// What the steps of lowering a deck have in common: the deck, its units, and the document that is being written.
//
// Lowering turns a keyword deck into the document that an input in YAML becomes, with a mesh beside it. Every value
// keeps the place in the deck where it stands, so that all that follows speaks of the deck.
#pragma once

#include <cstdint>
#include <map>
#include <set>
#include <string>
#include <string_view>
#include <vector>

#include "decks/deck.hpp"
#include "decks/deck_mesh.hpp"
#include "input/document.hpp"
#include "lowering/deck_report.hpp"
#include "lowering/unit_system.hpp"

namespace kerf::lowering {

struct LoweringOptions {
  std::string units;  // of --units; empty where absent
  int case_number = 0;
  bool without_unsupported = false;  // leave out what Kerf does not do
  bool strict = false;  // refuse what Kerf does in another way
  std::string mesh_name = {};  // what the document calls the file of the mesh; empty for the name of the deck
  bool mesh_is_enough = false;  // a deck without an end time and materials is a mesh, and becomes one
};

Node scalar(std::string text, Origin origin);
Node map_node(Origin origin);
Node list_node(Origin origin);
/// Adds a key to a map; returns its value, which is valid until the next one is added.
Node& add(Node& map, std::string key, Node value);
/// A title as one word of letters, digits and underscores; empty where that leaves nothing.
std::string word_of(const std::string& title);
/// `name`, or a name made of it that is not taken yet; it is taken from then on.
std::string free_name(const std::string& name, std::set<std::string>& taken);
/// The shortest text that reads back as `value`.
std::string number_text(double value);

class Lowering;

/// The cards of a keyword, or those of one repeated group of cards, with values in the units of the deck.
class Row {
 public:
  Row(const Lowering& lowering, const decks::Block& block, std::size_t repeat = 0)
      : lowering_(&lowering), block_(&block), repeat_(repeat) {}

  const decks::Block& block() const { return *block_; }
  std::size_t repeat() const { return repeat_; }
  /// A field with the factors of units of its include. Names of fields are looked for on all cards.
  decks::Field<double> real(std::string_view field, Dimension dimension = number) const;
  decks::Field<std::int64_t> integer(std::string_view field) const;
  /// An id as the whole deck calls it.
  decks::Field<std::int64_t> id(std::string_view field, decks::IdKind kind) const;
  double value(std::string_view field, Dimension dimension = number) const { return real(field, dimension).value; }
  bool given(std::string_view field) const { return real(field).given; }
  Origin origin(std::string_view field) const;
  Origin origin() const;
  /// "7.83 g/cm3", with the place of the field.
  Node quantity(std::string_view field, Dimension dimension = number, double factor = 1.0) const;
  /// Three fields as "0 0 -227 mm/ms".
  Node vector(const std::array<std::string_view, 3>& fields, Dimension dimension) const;

 private:
  int card_of(std::string_view field) const;
  const Lowering* lowering_;
  const decks::Block* block_;
  std::size_t repeat_ = 0;
};

class Lowering {
 public:
  Lowering(const decks::Deck& deck, decks::DeckMesh& mesh, const UnitSystem& units, const LoweringOptions& options,
           DeckReport& report, Diagnostics& diagnostics);

  const decks::Deck& deck;
  decks::DeckMesh& mesh;
  const UnitSystem& units;
  const LoweringOptions& options;
  DeckReport& report;
  Node root;

  /// What cannot be run: an error, or a warning where the user wants it left out.
  void refuse(const Origin& where, const std::string& what);
  /// What is done in another way than the deck says: a warning, or an error where the user is strict.
  void differ(const Origin& where, const std::string& what);
  void error(const Origin& where, const std::string& what) { diagnostics_.error(where, what); }
  void warning(const Origin& where, const std::string& what) { diagnostics_.warning(where, what); }
  /// Whether there is an error, or something is left out as the user wants.
  bool has_complained() const { return diagnostics_.has_errors() || report.n_left_out > 0; }

  /// All blocks of a keyword, in the order of the deck.
  std::vector<const decks::Block*> blocks(std::string_view base) const;
  /// The last block of a keyword that counts once, or null; the ones before it are warned of.
  const decks::Block* last(std::string_view base);
  /// In the unit of the deck; 0 where the deck does not say it.
  double end_time();
  /// All rows of a keyword whose cards repeat.
  std::vector<Row> rows(std::string_view base) const;
  Row row(const decks::Block& block, std::size_t repeat = 0) const { return {*this, block, repeat}; }
  /// The block of a keyword whose id is `id`, in any of the blocks whose names begin with `prefix`; null where absent.
  const decks::Block* defined(std::string_view prefix, std::string_view field, std::int64_t id,
                              decks::IdKind kind) const;

  /// Whether an include turns, mirrors or stretches what stands in it.
  bool is_turned(const decks::Block& block) const;
  /// Whether an include leaves directions alone; else `what` of the row is refused.
  bool keeps_directions(const Row& row, const char* what);
  /// Whether an include leaves places and directions alone; else `what` of the row is refused.
  bool stands_still(const Row& row, const char* what);

  /// "9.81 mm/ms2".
  std::string text(double value, Dimension dimension) const;
  std::string texts(const std::vector<double>& values, Dimension dimension) const;
  /// "[0, 1.5] ms".
  std::string list_text(const std::vector<double>& values, Dimension dimension) const;
  /// Adds an item to a list of the document, which is made where it is not there.
  void append(const char* list, Node item);

  // names.cpp: how the document calls parts and sets
  /// Empty for a part that is not in the document.
  std::string part_name(std::int64_t id) const;
  std::vector<std::string> parts_of_set(std::int64_t set, const Origin& where);
  /// A set of the document that holds the nodes of a node set of the deck; empty, and an error, where there is none.
  std::string node_set(std::int64_t id, const Origin& where);
  /// A set of the document of certain nodes; `name` is what it is called where that is free.
  std::string nodes(const std::string& name, std::vector<std::int32_t> nodes, const Origin& where);
  /// Names the parts that have solids.
  void name_parts();
  /// Nodes of the solids of a part, ascending.
  const std::vector<std::int32_t>& nodes_of_part(std::int64_t id);
  bool has_cells(std::int64_t part) const;
  /// Nodes of a node set of the deck; null where there is none.
  const std::vector<std::int32_t>* nodes_of_set(std::int64_t id) const;

  // curves.cpp
  struct Points {
    std::vector<double> x, y;
    Origin origin;
  };
  /// The points of a curve, scaled and shifted; without points, and an error, where there is none.
  Points curve_points(std::int64_t id, const Origin& where);
  /// A curve of the document over time, and its name; empty where there is none.
  std::string curve(std::int64_t id, const Origin& where);

  std::map<std::int64_t, std::string> part_names;  // by id; parts that are left out are absent
  std::vector<MeshNodeSet> sets;  // that the document names; they become the ones of the mesh

 private:
  Diagnostics& diagnostics_;
  std::map<std::int64_t, std::string> node_set_names_;
  std::map<std::int64_t, std::vector<std::int32_t>> nodes_of_parts_;  // found when they are first asked for
  std::set<std::string> names_;  // of parts and sets
  std::set<std::string> told_last_;  // keywords whose earlier blocks have been warned of
  std::set<std::int64_t> curves_;
};

// The steps, in their order. Each writes one part of the document.
void lower_control(Lowering& lowering);  // title, time, output, element defaults
void lower_parts(Lowering& lowering);  // parts, sections, hourglass control
void lower_materials(Lowering& lowering);
void lower_boundaries(Lowering& lowering);
void lower_initial(Lowering& lowering);  // velocities
void lower_loads(Lowering& lowering);
void lower_contacts(Lowering& lowering);

}  // namespace kerf::lowering
