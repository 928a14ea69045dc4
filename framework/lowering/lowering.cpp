// Values of cards with their units, and the document as it grows.
#include "lowering/lowering.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <utility>

#include "core/assert.hpp"

namespace kerf::lowering {

using decks::Block;
using decks::Field;
using decks::IdKind;

Node scalar(std::string text, Origin origin) {
  Node node;
  node.kind = Node::Kind::scalar;
  node.text = std::move(text);
  node.origin = std::move(origin);
  return node;
}

Node map_node(Origin origin) {
  Node node;
  node.kind = Node::Kind::map;
  node.origin = std::move(origin);
  return node;
}

Node list_node(Origin origin) {
  Node node;
  node.kind = Node::Kind::list;
  node.origin = std::move(origin);
  return node;
}

Node& add(Node& map, std::string key, Node value) {
  KERF_ASSERT(!map.find(key), "a key of the document is written once");
  const Origin origin = value.origin;
  map.entries.push_back({std::move(key), origin, std::move(value)});
  return map.entries.back().value;
}

std::string number_text(double value) { return fmt::format("{}", value); }

namespace {

std::string with_unit(const std::string& numbers, const std::string& unit) {
  return unit.empty() ? numbers : numbers + " " + unit;
}

}  // namespace

// ---- rows ------------------------------------------------------------------------------------------------------

int Row::card_of(std::string_view field) const {
  for (const decks::CardSpec& card : block_->name.spec->cards)
    if (card.field(field)) return card.number;
  return 0;
}

Field<double> Row::real(std::string_view field, Dimension d) const {
  Field<double> found = lowering_->deck.real(*block_, card_of(field), field, repeat_);
  const decks::Transform& t = lowering_->deck.transform_of(*block_);
  found.value *= product_of(d, t.mass, t.length, t.time);  // a default is a number of the include, too
  return found;
}

Field<std::int64_t> Row::integer(std::string_view field) const {
  return lowering_->deck.integer(*block_, card_of(field), field, repeat_);
}

Field<std::int64_t> Row::id(std::string_view field, IdKind kind) const {
  Field<std::int64_t> found = integer(field);
  found.value = lowering_->deck.transform_of(*block_).id(found.value, kind);
  return found;
}

Origin Row::origin(std::string_view field) const {
  return lowering_->deck.origin(lowering_->deck.text(*block_, card_of(field), field, repeat_).place);
}

Origin Row::origin() const { return lowering_->deck.origin(lowering_->deck.place_of(*block_)); }

Node Row::quantity(std::string_view field, Dimension dimension, double factor) const {
  return scalar(lowering_->text(value(field, dimension) * factor, dimension), origin(field));
}

Node Row::vector(const std::array<std::string_view, 3>& fields, Dimension dimension) const {
  return scalar(lowering_->texts(
                    {value(fields[0], dimension), value(fields[1], dimension), value(fields[2], dimension)}, dimension),
                origin(fields[0]));
}

// ---- the whole -------------------------------------------------------------------------------------------------

Lowering::Lowering(const decks::Deck& deck_of, decks::DeckMesh& mesh_of, const UnitSystem& units_of,
                   const LoweringOptions& options_of, DeckReport& report_of, Diagnostics& diagnostics)
    : deck(deck_of),
      mesh(mesh_of),
      units(units_of),
      options(options_of),
      report(report_of),
      root(map_node(deck_of.origin({0, 1, 1}))),
      diagnostics_(diagnostics) {}

void Lowering::refuse(const Origin& where, const std::string& what) {
  if (!options.without_unsupported) return diagnostics_.error(where, what);
  ++report.n_left_out;
  diagnostics_.warning(where, what + "; left out, as --without-unsupported asks");
}

void Lowering::differ(const Origin& where, const std::string& what) {
  if (options.strict) return diagnostics_.error(where, what + "; --strict takes nothing of this kind");
  ++report.n_differing;
  diagnostics_.warning(where, what);
}

std::vector<const Block*> Lowering::blocks(std::string_view base) const {
  std::vector<const Block*> found;
  for (const Block& block : deck.blocks())
    if (block.base() == base) found.push_back(&block);
  return found;
}

const Block* Lowering::last(std::string_view base) {
  const std::vector<const Block*> all = blocks(base);
  if (all.empty()) return nullptr;
  if (!told_last_.insert(std::string(base)).second) return all.back();
  for (std::size_t k = 0; k + 1 < all.size(); ++k)
    warning(deck.origin(deck.place_of(*all[k])),
            fmt::format("*{} is written again at {}, which counts", base, deck.text_of(deck.place_of(*all.back()))));
  return all.back();
}

double Lowering::end_time() {
  const Block* termination = last("CONTROL_TERMINATION");
  return termination ? row(*termination).value("endtim", time) : 0.0;
}

std::vector<Row> Lowering::rows(std::string_view base) const {
  std::vector<Row> found;
  for (const Block* block : blocks(base))
    for (std::size_t r = 0; r < deck.n_repeats(*block); ++r) found.push_back(row(*block, r));
  return found;
}

const Block* Lowering::defined(std::string_view prefix, std::string_view field, std::int64_t id, IdKind kind) const {
  for (const Block& block : deck.blocks()) {
    if (block.base().rfind(prefix, 0) != 0 || !block.name.spec || !block.name.spec->card(1)) continue;
    if (block.base().rfind("MAT_ADD_", 0) == 0) continue;  // it names a material, and is none
    if (block.name.spec->card(1)->field(field) && row(block).id(field, kind).value == id) return &block;
  }
  return nullptr;
}

bool Lowering::is_turned(const Block& block) const {
  const decks::Transform& transform = deck.transform_of(block);
  return transform.motion.matrix != decks::Affine::scaled(transform.length, transform.length, transform.length).matrix;
}

bool Lowering::keeps_directions(const Row& row, const char* what) {
  if (!is_turned(row.block())) return true;
  refuse(row.origin(), fmt::format("*{}: {} in an include that is turned, mirrored or stretched is not taken; write it "
                                   "into the main deck",
                                   row.block().written, what));
  return false;
}

bool Lowering::stands_still(const Row& row, const char* what) {
  if (!is_turned(row.block()) && deck.transform_of(row.block()).motion.shift == std::array<double, 3>{}) return true;
  refuse(row.origin(), fmt::format("*{}: {} in an include that is moved or turned is not taken; write it into the main "
                                   "deck",
                                   row.block().written, what));
  return false;
}

void Lowering::append(const char* list, Node item) {
  Entry* found = root.find(list);
  (found ? found->value : add(root, list, list_node(root.origin))).items.push_back(std::move(item));
}

std::string Lowering::text(double value, Dimension dimension) const {
  return with_unit(number_text(value), units.text_of(dimension));
}

std::string Lowering::texts(const std::vector<double>& values, Dimension dimension) const {
  std::string numbers;
  for (const double value : values) numbers += (numbers.empty() ? "" : " ") + number_text(value);
  return with_unit(numbers, units.text_of(dimension));
}

std::string Lowering::list_text(const std::vector<double>& values, Dimension dimension) const {
  std::string numbers;
  for (const double value : values) numbers += (numbers.empty() ? "[" : ", ") + number_text(value);
  return with_unit(numbers + "]", units.text_of(dimension));
}

}  // namespace kerf::lowering
