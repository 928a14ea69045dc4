// A keyword deck as it is written: blocks, cards, files, and typed values with the places where they stand.
//
// Nothing here knows what a keyword means. doc/developers/deck_reader.md tells how the layers follow one another.
#pragma once

#include <cstdint>
#include <map>
#include <memory>
#include <string>
#include <string_view>
#include <vector>

#include "core/diagnostics.hpp"
#include "decks/card_text.hpp"
#include "decks/keyword_table.hpp"
#include "decks/parameters.hpp"
#include "decks/transform.hpp"

namespace kerf::decks {

/// A place in one of the files of a deck. Lines and columns count from 1; a line of 0 is none.
struct Place {
  std::int32_t source = 0, line = 0, column = 0;
};

/// One reading of a file. A file that is included twice has two.
struct Source {
  std::shared_ptr<const std::string> name;  // what messages call it
  std::shared_ptr<const std::string> bytes;
  std::string folder, canonical;  // where it lies
  std::int32_t parent = -1;  // the reading that includes it
  Transform transform;
  CardFormat format = CardFormat::standard;
};

/// The cards of the table that stand above one another in a block: those at the top, then the group that repeats.
struct CardLayout {
  std::vector<const CardSpec*> top, group;
};

/// A keyword and the cards below it.
struct Block {
  std::string written;  // "SET_NODE_LIST_TITLE", in upper case
  std::string rest;  // what follows the keyword on its line, without format signs
  KeywordName name;
  CardFormat format = CardFormat::standard;
  std::int32_t source = 0, line = 0, order = 0;
  std::size_t first_card = 0, n_cards = 0;
  CardLayout layout;
  std::size_t n_repeats = 0;
  bool has_option(std::string_view option) const;
  const std::string& base() const { return name.base; }
};

/// A value, whether it is written or a default, and where it stands.
template <class Value>
struct Field {
  Value value{};
  bool given = false;
  Place place;
};

/// What is wrong with the text of a field; nothing where `kind` is `none`.
struct FieldMistake {
  enum class Kind : std::uint8_t {
    none,
    of_value,  // the message begins with the text
    two_values,  // in one field: the fields behind it cannot be trusted either
    of_parameter  // or of an expression: the message does not need the name of the field
  };
  Kind kind = Kind::none;
  std::string message;
  explicit operator bool() const { return kind != Kind::none; }
  /// The message with the name of the field and its columns.
  std::string message_about(std::string_view field, const FieldText& text) const;
};

struct DeckOptions {
  int case_number = 0;  // 0: no case, blocks of *CASE are left out
  bool unknown_is_left_out = false;  // warn of keywords of other physics, in place of errors
};

class Deck {
 public:
  const std::vector<Block>& blocks() const { return blocks_; }
  const std::vector<Source>& sources() const { return sources_; }
  const Parameters& parameters() const { return parameters_; }
  const std::string& title() const { return title_; }
  /// How often each keyword that counts is written, by names in upper case: without *END, *CASE and what stands in
  /// cases that were not asked for.
  const std::map<std::string, int>& keyword_counts() const { return counts_; }
  const Transform& transform_of(const Block& block) const { return sources_[at(block.source)].transform; }

  const Card* cards_of(const Block& block) const { return cards_.data() + block.first_card; }
  Place place_of(const Block& block, std::int32_t column = 1) const { return {block.source, block.line, column}; }
  Origin origin(const Place& place) const;
  /// "file:line:column".
  std::string text_of(const Place& place) const { return origin(place).text(); }

  /// The card of a block that the table numbers `number`, or null where the block ends before; `repeat` counts the
  /// groups of cards that repeat, from 0.
  const Card* card(const Block& block, int number, std::size_t repeat = 0) const;
  /// How many groups of repeating cards there are, incomplete ones too. Blank cards at the end of a block count for
  /// none.
  std::size_t n_repeats(const Block& block) const { return block.n_repeats; }

  /// The value of a field of the table. Text that is no value is the default: check_fields has complained of it.
  /// Pre: the table has the field.
  Field<double> real(const Block& block, int card, std::string_view field, std::size_t repeat = 0) const;
  Field<std::int64_t> integer(const Block& block, int card, std::string_view field, std::size_t repeat = 0) const;
  Field<std::string> text(const Block& block, int card, std::string_view field, std::size_t repeat = 0) const;
  /// The first number on the first card below the title, of a keyword whose cards need not be known; 0 where there is
  /// none.
  Field<std::int64_t> first_field(const Block& block) const;
  std::int64_t first_integer(const Block& block) const { return first_field(block).value; }
  /// The heading of a block with _TITLE or _ID, as UTF-8; empty where there is none.
  std::string heading(const Block& block, std::size_t repeat = 0) const;

  /// Reads the text of a field. `place` becomes that of a mistake.
  FieldMistake read(const Block& block, const FieldText& text, double& value, Place& place) const;
  FieldMistake read(const Block& block, const FieldText& text, std::int64_t& value, Place& place) const;
  Asker asker(const Block& block) const;

 private:
  friend class DeckReader;
  /// Lays the cards of the table over those of a block. To be called again where the cards of the block change.
  void arrange(Block& block) const;
  CardLayout layout_of(const Block& block) const;
  static std::size_t at(std::int32_t index) { return static_cast<std::size_t>(index); }
  /// What a field that begins with `&` or `<` stands for.
  FieldMistake read_reference(const Block& block, const FieldText& text, DeckNumber& value, Place& place) const;
  template <class Value>
  Field<Value> number(const Block& block, int card, std::string_view field, std::size_t repeat) const;
  FieldText field_text(const Block& block, int card, std::string_view field, std::size_t repeat,
                       const FieldSpec** spec) const;

  std::vector<Source> sources_;
  std::vector<Card> cards_;
  std::vector<Block> blocks_;
  Parameters parameters_;
  std::map<std::string, int> counts_;
  std::string title_;
};

/// Adds errors of a deck to the diagnostics, at most twenty of each kind, and says how many more there are.
class DeckErrors {
 public:
  DeckErrors(const Deck& deck, Diagnostics& diagnostics) : deck_(deck), diagnostics_(diagnostics) {}
  ~DeckErrors();
  DeckErrors(const DeckErrors&) = delete;
  DeckErrors& operator=(const DeckErrors&) = delete;
  /// `kind` tells errors of one kind from others; it must outlive this object.
  void error(const Place& place, std::string_view kind, const std::string& message);
  void warning(const Place& place, std::string_view kind, const std::string& message);

 private:
  struct Count {
    int n = 0;
    Place last;
  };
  const Deck& deck_;
  Diagnostics& diagnostics_;
  std::map<std::string_view, Count> errors_, warnings_;
};

/// Reads a deck and everything that it includes. Mistakes of the form go to `diagnostics`. Local.
Deck read_deck(const std::string& path, const DeckOptions& options, Diagnostics& diagnostics);

/// Checks the values of all cards of the table: numbers, tabs, parameters, missing cards. Local.
void check_fields(const Deck& deck, Diagnostics& diagnostics);

}  // namespace kerf::decks
