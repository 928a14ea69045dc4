// What the reader knows of keywords: their cards and fields, their options, and which of them change nothing.
#pragma once

#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

#include "decks/card_text.hpp"

namespace kerf::decks {

enum class FieldType : std::uint8_t { real, integer, text };

/// When a card is there: always; again and again until the next keyword; with the option _TITLE; with _ID (or _TITLE
/// of contacts); with _MPP; or at will after all others.
enum class CardWhen : std::uint8_t { always, more, title, id, mpp, optional };

/// What the value of a field is the id of. In the table: the kind; `required` where 0 and blank are errors; and, where
/// a value below zero means something, `-` with the kind that its number is the id of, or `-` alone.
struct FieldReference {
  std::string kind;  // "curve", "node_set"; empty where the field is no id
  bool required = false;
  bool may_be_negative = false;
  std::string negative_kind;  // empty where a negative value is no id
};

/// One field of a card. Columns count from 1, in the standard format.
struct FieldSpec {
  std::string name;  // lower case
  FieldType type = FieldType::real;
  std::int32_t column = 1, width = 10, place = 0;  // `place` counts the fields of the card from 0
  double number = 0.0;  // the default
  std::string text;  // the default as written; empty where there is none
  FieldReference reference;
};

struct CardSpec {
  int number = 0;  // as the table counts
  CardWhen when = CardWhen::always;
  std::vector<FieldSpec> fields;

  const FieldSpec* field(std::string_view name) const;
  /// The field of a raw card. Values that stand beyond the end of a card are blank.
  FieldText text_of(const FieldSpec& field, std::string_view card, CardFormat format) const;
  /// Whether a raw card has commas between its fields.
  bool has_commas(std::string_view card) const;
};

struct KeywordSpec {
  std::string name;  // without the asterisk
  std::vector<CardSpec> cards;

  const CardSpec* card(int number) const;
  bool has(CardWhen when) const;
  bool repeats() const { return has(CardWhen::more); }
};

/// What the reader does with a keyword.
enum class KeywordUse : std::uint8_t {
  tabled,  // its cards are in the table
  read,  // read by code of its own: *NODE, *ELEMENT_SOLID, *INCLUDE and their kin
  noted,  // changes no result: output, files, comments
  foreign,  // a keyword of LS-DYNA whose cards the reader does not know
  unknown
};

/// A keyword as written, taken apart.
struct KeywordName {
  std::string base;  // as the table calls it, without options: "SET_NODE_LIST" for *SET_NODE_TITLE
  std::vector<std::string> options;  // "TITLE", "ID", "MPP", "COLLECT"
  KeywordUse use = KeywordUse::unknown;
  const KeywordSpec* spec = nullptr;
};

/// Takes `name` apart. Pre: upper case, without the asterisk and without what follows a blank.
KeywordName keyword_named(const std::string& name);

const KeywordSpec* keyword_spec(std::string_view base);

/// Names of all keywords of the table.
std::vector<std::string> tabled_keywords();

/// The keyword that `name` may have been meant for, or empty; and, for a keyword of another kind of physics, which.
std::string nearest_keyword(const std::string& name);
std::string physics_of_group(const std::string& name);

}  // namespace kerf::decks
